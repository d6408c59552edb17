"""Neither the default feature size nor the one that `info` suggests earns a warning."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyvista
from commands import command
from meshlab_spectral import filter_mesh, filter_scalars, geometry_spectrum
from numpy.typing import NDArray

Mesh = tuple[NDArray[Any], NDArray[Any]]


def arrays(mesh: pyvista.PolyData) -> Mesh:
    mesh = mesh.triangulate()
    return np.array(mesh.points, dtype=float), np.array(mesh.regular_faces)


def with_another(mesh: Mesh, scale: Any, place: float) -> Mesh:
    V, F = mesh
    return np.vstack([V, V * scale + place]), np.vstack([F, F + len(V)])


def written(path: Path, mesh: Mesh) -> Path:
    pyvista.PolyData.from_regular_faces(*mesh).save(path)
    return path


_BALL = arrays(pyvista.Icosphere(nsub=2))
MESHES = {
    "one triangle": arrays(pyvista.Triangle()),
    "cube of 12 triangles": arrays(pyvista.Cube().clean()),
    "cube with seams": arrays(pyvista.Cube()),
    "tetrahedron": arrays(pyvista.Tetrahedron()),
    "coarse sphere": arrays(pyvista.Icosphere(nsub=1)),
    "sphere": arrays(pyvista.Icosphere(nsub=4)),
    "needles": arrays(pyvista.Cylinder(resolution=100, height=20, radius=0.1).clean()),
    "strip": arrays(pyvista.Plane(i_size=100, j_size=0.1, i_resolution=300, j_resolution=1)),
    "thin plate": arrays(pyvista.Box(bounds=(0, 1, 0, 1, 0, 0.01), level=10).clean()),
    "text": arrays(pyvista.Text3D("ab")),
    "fins": arrays(pyvista.ParametricDini().clean()),
    "ball and crumb": with_another(_BALL, 0.01, 2.0),
    "ball and flake": with_another(_BALL, [1e-3, 0.1, 0.1], 3.0),
}


@pytest.mark.parametrize("name", MESHES)
def test_the_default_size_earns_no_warning(name: str) -> None:
    V, F = MESHES[name]
    spectrum = geometry_spectrum(V, F)
    size = spectrum.default_feature_size
    for text in (
        "auto",
        size,
        f"{size:.4g}",
        f"{size / spectrum.mean_edge:.3g}e",
        f"{100 * size / spectrum.diagonal:.3g}%",
    ):
        for filter_type in ("low-pass", "high-pass", "band-pass"):
            # 1: sharpening; a high-pass that takes the shape away earns its warning.
            kept = {} if filter_type == "low-pass" else {"stop_gain": 1.0}
            options: dict[str, Any] = {"feature_size": text, "filter_type": filter_type, **kept}
            assert filter_mesh(V, F, **options)[1]["warnings"] == [], text
            assert filter_scalars(V, F, V[:, 0], **options)[1]["warnings"] == [], text


def test_other_sizes_still_do() -> None:
    V, F = MESHES["coarse sphere"]
    (warning,) = filter_mesh(V, F, feature_size=0.01)[1]["warnings"]
    assert "below its mean edge length" in warning


@pytest.mark.parametrize("name", ["cube of 12 triangles", "ball and flake"])
def test_what_info_prints_is_a_default_size(name: str, tmp_path: Path) -> None:
    V, F = MESHES[name]
    told = command("info", written(tmp_path / "mesh.ply", (V, F))).stdout
    row = next(line for line in told.splitlines() if "Suggested feature" in line)
    found = re.search(r"(\S+) \((\S+e), (\S+) %\)", row)
    assert found is not None
    length, edges, percent = found.groups()
    for text in (length, edges, f"{percent}%"):
        assert filter_mesh(V, F, feature_size=text)[1]["warnings"] == [], row


def test_noise_that_was_not_searched_for_is_not_none(tmp_path: Path) -> None:
    few = command("info", written(tmp_path / "few.ply", MESHES["cube of 12 triangles"])).stdout
    assert "not searched for" in few
    assert "none" not in few
    needles = command("info", written(tmp_path / "needles.ply", MESHES["needles"])).stdout
    assert "not searched for" in needles
    smooth = command("info", written(tmp_path / "smooth.ply", MESHES["sphere"])).stdout
    assert "not searched for" not in smooth
