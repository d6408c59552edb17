"""A file that stays in its format is patched: what does not move keeps its bytes."""

from __future__ import annotations

import re
import shutil
import tempfile
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import numpy as np
from format_samples import SAMPLES, Sample
from format_table import outcomes
from helpers import filter_file
from meshlab_spectral import DenoiseOptions, FilterOptions
from meshlab_spectral.files.meshes import load_arrays
from meshlab_spectral.filters.option_types import Options

from promises.record import Found, Promise, exactly, promise, shared

IDENTITY = FilterOptions.from_dict({"pass_gain": 1, "stop_gain": 1})
SMOOTH = FilterOptions.from_dict({"feature_size": "15%"})
DENOISED = DenoiseOptions()
FIELD = (
    "extra_properties.ply",
    "uv_seam_split.ply",
    "obj_materials/model.obj",
    "embedded_texture.glb",
    "two_meshes.glb",
    "node_transform.glb",
    "inch.3mf",
    "item_transform.3mf",
    "stl_loose1e-08.stl",
    "gii_ext.surf.gii",
    "lh.white",
)
CUT = ("uv_seam_split.ply", "triangle_soup.ply")
# What an OBJ file keeps to the byte: all but coordinates, normals, of which some may become
# several, and the numbers of normals in faces.
COORDINATES, NORMAL, FACE = (re.compile(rb"[ \t]*" + word + rb"\s") for word in (b"v", b"vn", b"f"))
NUMBER_OF_NORMAL = re.compile(rb"(?<=/)\d+(?=\s|$)")


def promises() -> Iterator[Promise]:
    yield from identical_files()
    yield from contents()
    yield from text()
    yield from seams()


def identical_files() -> Iterator[Promise]:
    """ "Coordinates change, normals follow, and nothing else does" (python/docs/formats.md).

    So nothing changes where all gains are 1.
    """
    yield promise(
        "bytes differ after gains of 1, files: a sample of each format",
        exactly(0),
        partial(of_all, "samples", [partial(sample_differs, one) for one in SAMPLES]),
    )
    for name in FIELD:
        yield promise(
            f"bytes differ after gains of 1: {name}",
            exactly(0),
            partial(field_differs, name),
        )


def contents() -> Iterator[Promise]:
    """The table of python/docs/formats.md: what a filtered file keeps."""
    yield promise("kinds of content lost in a sample of each format", exactly(0), lost)


def text() -> Iterator[Promise]:
    """ "Text formats differ in these numbers alone" (python/docs/formats.md)."""
    yield promise(
        "lines that differ but in coordinates and normals: obj_materials/model.obj",
        exactly(0),
        partial(other_lines, "obj_materials/model.obj"),
    )


def seams() -> Iterator[Promise]:
    """Copies of a vertex at a seam move exactly alike (python/docs/inputs.md)."""
    for name in CUT:
        for what, options in (("filter", SMOOTH), ("denoise", DENOISED)):
            yield promise(
                f"points that come apart at seams, {what}: {name}",
                exactly(0),
                partial(came_apart, name, options),
            )


def filtered(name: str, folder: Path, options: Options) -> tuple[Path, Path]:
    """Filter a copy of a file of ../shared/field, with the files next to it."""
    source = shared(f"field/{name}")
    (folder / "in").mkdir()
    (folder / "out").mkdir()
    beside = source.parent.iterdir() if "/" in name else source.parent.glob("*.dat")
    for file in {source, *beside}:
        shutil.copyfile(file, folder / "in" / file.name)
    before, after = (folder / side / source.name for side in ("in", "out"))
    filter_file(before, after, options)
    return before, after


def of_all(what: str, questions: list[Callable[[], Found]]) -> Found:
    """Return the sum of several counts."""
    found = [question() for question in questions]
    return Found(sum(one.value for one in found), " ".join(one.where for one in found).strip())


def sample_differs(sample: Sample) -> Found:
    with tempfile.TemporaryDirectory() as name:
        before, after = (Path(name, side, sample.name) for side in ("in", "out"))
        before.parent.mkdir()
        after.parent.mkdir()
        sample.write(before)
        filter_file(before, after, IDENTITY)
        differs = before.read_bytes() != after.read_bytes()
    return Found(differs, sample.name if differs else "")


def field_differs(name: str) -> int:
    with tempfile.TemporaryDirectory() as folder:
        before, after = filtered(name, Path(folder), IDENTITY)
        return int(before.read_bytes() != after.read_bytes())


def lost() -> Found:
    gone = []
    for sample in SAMPLES:
        with tempfile.TemporaryDirectory() as folder:
            found = outcomes(sample, Path(folder) / "sample")
        gone += [f"{sample.name}: {kind}" for kind, what in found.items() if what == "LOST"]
    return Found(len(gone), ", ".join(gone))


def other_lines(name: str) -> int:
    with tempfile.TemporaryDirectory() as folder:
        before, after = filtered(name, Path(folder), SMOOTH)
        kept = [list(kept_lines(path)) for path in (before, after)]
    return sum(old != new for old, new in zip(*kept, strict=True))


def kept_lines(path: Path) -> Iterator[bytes]:
    """Yield the lines of an OBJ file of v/vt/vn corners, as far as they keep their bytes."""
    for line in path.read_bytes().splitlines(keepends=True):
        if COORDINATES.match(line):
            yield b"v"
        elif FACE.match(line):
            yield NUMBER_OF_NORMAL.sub(b"", line)
        elif not NORMAL.match(line):
            yield line


def came_apart(name: str, options: Options) -> int:
    with tempfile.TemporaryDirectory() as folder:
        before, after = (load_arrays(path)[0] for path in filtered(name, Path(folder), options))
    _, copy_of = np.unique(before, axis=0, return_inverse=True)
    moved = np.unique(np.column_stack([copy_of.ravel(), after]), axis=0)
    return len(moved) - (int(copy_of.max()) + 1)
