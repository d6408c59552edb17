"""Prints the table of python/docs/formats.md: what of a file is kept when it is filtered.

In the environment of the project: `python tests/python/format_table.py`, with --write into the
page.
"""

from __future__ import annotations

import os
import re
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from format_samples import SAMPLES, Sample, Seen
from helpers import filter_file
from meshlab_spectral import FilterOptions

PAGE = Path(__file__).resolve().parents[2] / "python" / "docs" / "formats.md"
SMOOTH = FilterOptions.from_dict({"feature_size": "15%"})
KINDS = {
    "coordinates": "coordinates",
    "normals": "normals",
    "faces": "faces",
    "lines": "polygons, lines, edges",
    "colours": "colours",
    "texture": "texture coordinates",
    "materials": "materials and textures, with their files",
    "names": "names and groups",
    "values": "labels and other values",
    "comments": "comments and metadata",
    "types": "types of numbers",
    "placement": "units and placement",
}


def table() -> str:
    """Filter every sample; return a Markdown table, kinds of content by formats."""
    columns: dict[str, list[dict[str, str]]] = {}
    with tempfile.TemporaryDirectory() as folder:
        for number, sample in enumerate(SAMPLES):
            found = outcomes(sample, Path(folder) / str(number))
            columns.setdefault(sample.format, []).append(found)
    rows = [["content", *columns], ["---"] * (1 + len(columns))]
    for kind, title in KINDS.items():
        rows.append([title, *(_common(kind, found) for found in columns.values())])
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def outcomes(sample: Sample, folder: Path) -> dict[str, str]:
    """Filter a sample; return the outcome for each kind of content in it."""
    source, target = (folder / side / sample.name for side in ("in", "out"))
    source.parent.mkdir(parents=True)
    target.parent.mkdir()
    sample.write(source)
    report = filter_file(source, target, SMOOTH)
    return compared(sample.read(source), sample.read(target), report)


def compared(before: Seen, after: Seen, report: dict[str, Any]) -> dict[str, str]:
    """Return the outcome for each kind of content in `before`.

    "kept", "follow" the shape, "told" in a warning, or "LOST".
    """
    warned = {kind for kind in before if any(kind in warning for warning in report["warnings"])}
    rest = before.keys() - {"coordinates", "normals"}
    result = {kind: "kept" for kind in rest if before[kind] and before[kind] == after.get(kind)}
    for kind, follows in {"coordinates": _are_filtered, "normals": _are_normals}.items():
        if kind in before and follows(before, after, report):
            result[kind] = "follow"
    return dict.fromkeys(before, "LOST") | dict.fromkeys(warned, "told") | result


def _are_filtered(before: Seen, after: Seen, report: dict[str, Any]) -> bool:
    """Whether points have moved as far as the report says, and where they coincided still do."""
    P, Q = before["coordinates"], after["coordinates"]
    farthest = np.linalg.norm(Q - P, axis=1).max()
    close = np.isclose(farthest, report["max_displacement"], rtol=1e-3)
    return bool(close and len(np.unique(P, axis=0)) == len(np.unique(Q, axis=0)))


def _are_normals(before: Seen, after: Seen, report: dict[str, Any]) -> bool:
    """Whether normals have changed, have unit length, and are equal where they were."""
    N, M = before["normals"], after["normals"]
    are_unit = np.allclose(np.linalg.norm(M, axis=1), 1, atol=1e-6)
    cosines = np.einsum("ij,ij->i", N, M)
    pairs = np.unique(np.hstack([N, M]), axis=0)
    stay_equal = len(pairs) == len(np.unique(N, axis=0))
    return bool(are_unit and stay_equal and (N != M).any() and (cosines > 0.9).all())


def _common(kind: str, found: list[dict[str, str]]) -> str:
    """The outcome in all flavours of a format that have this kind of content."""
    return " / ".join(sorted({one[kind] for one in found if kind in one})) or "-"


if __name__ == "__main__":
    with os.fdopen(os.dup(1), "w") as output:
        os.dup2(2, 1)  # MeshLab's log
        rows = table()
        if "--write" in sys.argv:
            page = PAGE.read_text()
            PAGE.write_text(re.sub(r"(?m)^\| content \|.*(\n\|.*)*", lambda _: rows, page))
        else:
            print(rows, file=output)
