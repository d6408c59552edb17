"""A file filtered into its own format keeps everything; in another format losses are reported."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import pyvista
from format_samples import RGB, SAMPLES, Array, Sample
from format_table import PAGE, SMOOTH, compared, outcomes, table
from helpers import filter_file
from meshlab_spectral.formats.names import ending_of
from meshlab_spectral.formats.table import FORMATS
from plyfile import PlyData

BY_NAME = {sample.name: sample for sample in SAMPLES}
CONVERSIONS = [
    (name, ending)
    for name in ("in.ply", "in.obj", "in.glb", "in.3mf")
    for ending in (".ply", ".obj", ".stl")
    if not name.endswith(ending)
]
PLY_NAMES = {"colours": "red green blue", "normals": "nx ny nz", "texture": "texture_u texture_v"}


@pytest.mark.parametrize("sample", SAMPLES, ids=[sample.name for sample in SAMPLES])
def test_nothing_is_lost_in_a_file_that_stays_in_its_format(sample: Sample, tmp_path: Path) -> None:
    assert "LOST" not in outcomes(sample, tmp_path).values()


def test_every_format_has_a_sample() -> None:
    have = {FORMATS[ending].module for ending in map(ending_of, BY_NAME) if ending in FORMATS}
    assert have | {"usd"} == {one.module for one in FORMATS.values() if one.is_patched}


def test_a_loss_appears_in_the_table(tmp_path: Path) -> None:
    BY_NAME["in.ply"].write(tmp_path / "in.ply")
    before = BY_NAME["in.ply"].read(tmp_path / "in.ply")
    after = {kind: before[kind] for kind in ("coordinates", "normals")}
    report = {"max_displacement": 1.0, "warnings": ["the colours are lost"]}
    found = compared(before, after, report)
    assert found == {**dict.fromkeys(before, "LOST"), "colours": "told"}


def test_the_page_of_formats_has_the_table() -> None:
    assert table() in PAGE.read_text()


@pytest.mark.parametrize(("name", "ending"), CONVERSIONS)
def test_another_format_gets_the_shape_and_losses_are_reported(
    name: str, ending: str, tmp_path: Path
) -> None:
    (tmp_path / "new").mkdir()
    source, target = tmp_path / name, tmp_path / "new" / f"out{ending}"
    BY_NAME[name].write(source)
    warnings = filter_file(source, target, SMOOTH)["warnings"]
    (warning,) = (warning for warning in warnings if f"{target.name} loses" in warning)
    before, after = BY_NAME[name].read(source), contents(target)
    points = before["coordinates"]
    bounds = np.column_stack([points.min(axis=0), points.max(axis=0)]).ravel()
    tolerance = 0.02 * np.ptp(points, axis=0).min()
    np.testing.assert_allclose(pyvista.read(target).bounds, bounds, atol=tolerance)
    if name == "in.obj" and ending != ".stl":
        scale = 255 if ending == ".obj" else 1
        np.testing.assert_allclose(scale * after["colours"].astype(float), RGB, atol=1)
    words = {"colours": "colours", "normals": "normals", "texture": "texture coordinates"}
    if name == "in.3mf":
        words["texture"] = "textures"
    gone = [kind for kind in words if kind in before and kind not in after]
    assert [kind for kind in gone if words[kind] not in warning] == []


def contents(path: Path) -> dict[str, Array]:
    """What a file holds at its vertices, unless it is the same at all of them."""
    found: dict[str, Array] = {}
    if path.suffix == ".ply":
        vertex = PlyData.read(path)["vertex"].data
        for kind, names in PLY_NAMES.items():
            columns = [vertex[name] for name in names.split() if name in vertex.dtype.names]
            found[kind] = np.array(columns).T
    elif path.suffix == ".obj":
        lines = [line.split() for line in path.read_text().splitlines() if line]
        rows = {key: np.array([w[1:] for w in lines if w[0] == key]) for key in ("v", "vn", "vt")}
        found = {"colours": rows["v"][:, 3:], "normals": rows["vn"], "texture": rows["vt"]}
    return {kind: values for kind, values in found.items() if len(np.unique(values, axis=0)) > 1}
