"""What consoles and notebooks show of results is short, whatever the size of the mesh."""

from __future__ import annotations

import json
import pickle
from typing import Any

import numpy as np
import pytest
import pyvista
from meshlab_spectral import (
    compare,
    denoise_mesh,
    filter_colors,
    filter_mesh,
    filter_scalars,
    geometry_spectrum,
    manifold_harmonics,
    measure_artefacts,
    surface_texture,
)

_SPHERE = pyvista.Icosphere(nsub=3)
MESH = np.array(_SPHERE.points, dtype=float), np.array(_SPHERE.regular_faces)
RESULTS = {
    "filter": lambda: filter_mesh(MESH)[1],
    "truncated": lambda: filter_mesh(MESH, spectrum="truncated", basis_size=300)[1],
    "denoise": lambda: denoise_mesh(MESH)[1],
    "scalars": lambda: filter_scalars(MESH, MESH[0])[1],
    "colors": lambda: filter_colors(MESH, np.abs(MESH[0]))[1],
    "spectrum": lambda: geometry_spectrum(MESH, 300),
    "harmonics": lambda: manifold_harmonics(MESH, 300),
    "artefacts": lambda: measure_artefacts(MESH, 0.3),
    "texture": lambda: surface_texture(MESH, waviness=0.5),
    "same faces": lambda: compare(MESH, (1.1 * MESH[0], MESH[1])),
    "other faces": lambda: compare(MESH, (1.1 * MESH[0], MESH[1][::-1])),
    "deviation": lambda: compare(MESH, (1.1 * MESH[0], MESH[1])).deviations["normal"],
}


@pytest.mark.parametrize("name", RESULTS)
def test_a_result_prints_in_few_lines(name: str) -> None:
    result = RESULTS[name]()
    assert len(repr(result)) < 1300
    assert "\n" not in repr(result)
    if hasattr(result, "_repr_html_"):
        html = result._repr_html_()
        assert html.startswith("<table><tr>")
        assert html.endswith("</table>")
        assert len(html) < 3000


def test_a_report_is_a_dict_with_all_its_numbers() -> None:
    report = RESULTS["truncated"]()
    assert len(report["eigenvalues"]) >= 300
    assert f"'eigenvalues': <{len(report['eigenvalues'])} numbers, 0 to " in repr(report)
    same: dict[str, Any] = json.loads(json.dumps(report))
    assert same == report == pickle.loads(pickle.dumps(report))


def test_harmonics_print_how_many_and_how_long() -> None:
    text = repr(manifold_harmonics(MESH, 4))  # the sphere: 2 pi / sqrt(2) for l = 1
    assert text.startswith("Harmonics(4 of a mesh of 642 vertices, wavelengths 4.4")


def test_a_table_of_a_spectrum_has_a_row_for_each_octave() -> None:
    spectrum = geometry_spectrum(MESH)
    assert spectrum._repr_html_().count("<tr>") == 1 + len(spectrum.octave_feature_sizes)
