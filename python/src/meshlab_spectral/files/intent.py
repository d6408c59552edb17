"""What filtering a file would do, in the units of the file, for `--dry-run`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from meshlab_spectral.errors import OptionError
from meshlab_spectral.files.extensions import is_same_format
from meshlab_spectral.files.filtering import require_one_choice, wanted_attribute
from meshlab_spectral.files.meshes import load_parts, whole_of
from meshlab_spectral.files.meshlab_files import check_writable
from meshlab_spectral.files.region_vertices import chosen_parts
from meshlab_spectral.files.request import Request
from meshlab_spectral.files.touching import pieces
from meshlab_spectral.filters.arrays import lengths_of
from meshlab_spectral.filters.progress import StageCallback
from meshlab_spectral.plugin.loading import load


def intent_of(request: Request, target: Path, on_stage: StageCallback) -> dict[str, Any]:
    """Read a mesh file, and describe what `filter_to_scratch` would do with it to write `target`.

    Errors are those of `filter_to_scratch`. Returns "surfaces", for each one that would be filtered
    its "mesh", the name, "vertices", "faces", "filtered_vertices" if there is a region or a
    selection, "diagonal", "mean_edge" and "sizes", see `Options.sizes`; "is_patched", whether the
    output keeps all that is not moved.
    """
    source, options, region = request.source, request.options, request.region
    require_one_choice(options, region)
    on_stage("reading", None)
    is_patched = not wanted_attribute(options, target) and is_same_format(source, target)
    if not is_patched:
        load()
        check_writable(target)
    parts = load_parts(source, request.mesh)
    wholes = [whole_of(group) for group in pieces(parts)]
    surfaces = []
    for part in filter(None, chosen_parts(wholes, options, region)):
        V, F = part.vertices, part.faces
        if len(F) == 0:
            raise OptionError(f"{source} has no faces: reconstruct a surface first")
        lengths = lengths_of(V, F)
        described = {
            "mesh": part.name,
            "vertices": len(V),
            "faces": len(F),
            "diagonal": lengths.diagonal,
            "mean_edge": lengths.mean_edge,
            "sizes": options.sizes(*lengths),
        }
        is_part = region or getattr(options, "selected", False)
        if is_part and part.selected is not None:
            described["filtered_vertices"] = int(np.count_nonzero(part.selected))
        surfaces.append(described)
    return {"surfaces": surfaces, "is_patched": is_patched}
