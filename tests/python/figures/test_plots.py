"""Plots for notebooks: what they show of a spectrum and of harmonics, and what they refuse."""

from __future__ import annotations

import io
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib.image
import numpy as np
import pytest
import pyvista
from meshlab_spectral import (
    ArgumentError,
    FilterOptions,
    GeometrySpectrum,
    Harmonics,
    MissingPackageError,
    OptionError,
    geometry_spectrum,
    manifold_harmonics,
    plot_comparison,
    plot_harmonics,
    plot_spectrum,
    plot_texture,
)
from meshlab_spectral.figures.pictures import to_full_colours
from meshlab_spectral.figures.spectrum import draw_spectrum
from numpy.typing import NDArray
from shared_types import Decimated

Mesh = tuple[NDArray[Any], NDArray[Any]]


@pytest.fixture(scope="module")
def mesh(decimated: Decimated) -> Mesh:
    return decimated("cow.obj", 1000)


@pytest.fixture(scope="module")
def spectrum(mesh: Mesh) -> GeometrySpectrum:
    return geometry_spectrum(*mesh, 20)


@pytest.fixture(scope="module")
def basis(mesh: Mesh) -> Harmonics:
    return manifold_harmonics(*mesh, 12)


def test_the_plot_of_a_spectrum_has_its_harmonics_and_bands(spectrum: GeometrySpectrum) -> None:
    figure = plot_spectrum(spectrum, title="cow")
    amplitudes, noise = figure.axes
    assert amplitudes.get_title() == "cow"
    (harmonics,) = amplitudes.lines
    waves = spectrum.frequencies > 0
    np.testing.assert_array_equal(harmonics.get_xdata(), 2 * np.pi / spectrum.frequencies[waves])
    np.testing.assert_array_equal(harmonics.get_ydata(), spectrum.amplitudes[waves])
    np.testing.assert_array_equal(noise.lines[0].get_xdata(), spectrum.band_feature_sizes)
    np.testing.assert_array_equal(noise.lines[0].get_ydata(), spectrum.noise_heights)
    entries = [text.get_text() for text in amplitudes.get_legend().get_texts()]
    assert len(entries) == 2
    assert "low-pass" not in " ".join(entries)


def test_with_options_the_plot_has_the_gain_of_the_filter(spectrum: GeometrySpectrum) -> None:
    figure = plot_spectrum(spectrum, FilterOptions(feature_size="5%"))
    _, _, gains = figure.axes
    curve = gains.lines[0]
    at_cutoff = np.interp(
        0.05 * spectrum.diagonal, curve.get_xdata()[::-1], curve.get_ydata()[::-1]
    )
    assert at_cutoff == pytest.approx(np.sqrt(0.5), abs=0.01)
    entries = [text.get_text() for text in gains.get_legend().get_texts()]
    assert entries[-1] == "low-pass 5 %"


def test_the_plot_is_the_picture_of_the_command(spectrum: GeometrySpectrum, tmp_path: Path) -> None:
    plot_spectrum(spectrum, FilterOptions(), "cow").savefig(tmp_path / "plot.png")
    draw_spectrum(spectrum, FilterOptions(), "cow", tmp_path / "command.png")
    plot, command = (matplotlib.image.imread(tmp_path / f"{n}.png") for n in ("plot", "command"))
    np.testing.assert_array_equal(plot, command)


def test_a_notebook_shows_the_plot_as_the_value_of_a_cell(spectrum: GeometrySpectrum) -> None:
    figure = plot_spectrum(spectrum)
    picture = matplotlib.image.imread(io.BytesIO(figure._repr_png_()))
    width, height = figure.get_size_inches() * figure.dpi
    assert picture.shape[:2] == (round(height), round(width))


@pytest.mark.parametrize("share", [0.3, 0.05, 1e-3])
def test_harmonics_of_one_of_several_components_have_full_colours(share: float) -> None:
    sphere = pyvista.Icosphere(nsub=2)
    V, F = np.array(sphere.points, dtype=float), np.array(sphere.regular_faces)
    both = np.vstack([V, share * V + 3])
    faces = np.vstack([F, F + len(V)])
    basis = manifold_harmonics(both, faces, 12)
    for f in basis.harmonics.T:
        colours = to_full_colours(f, basis.masses)
        assert np.isfinite(colours).all()
        assert np.abs(colours).max() == 1
    colours = to_full_colours(np.zeros(len(both)), basis.masses)
    np.testing.assert_array_equal(colours, 0)
    with np.errstate(all="raise"):
        plot_harmonics((both, faces), basis, [0, 1, 2, 11]).close()


def test_harmonics_are_shown_in_rows_red_where_positive(mesh: Mesh, basis: Harmonics) -> None:
    modes = [0, 1, 5, 7, 11]
    plotter = plot_harmonics(*mesh, basis, modes)
    try:
        assert plotter.shape == (2, 4)
        for renderer, mode in zip(plotter.renderers, modes, strict=False):
            surface = next(iter(renderer.actors.values())).mapper.dataset
            np.testing.assert_allclose(surface.points, mesh[0], rtol=1e-6)
            phi, shown = basis.harmonics[:, mode], surface["signed"]
            inside = np.abs(shown) < 1
            np.testing.assert_array_equal(np.sign(shown), np.sign(phi))
            if mode > 0:
                assert np.corrcoef(shown[inside], phi[inside])[0, 1] == pytest.approx(1)
        picture = np.asarray(plotter.screenshot(return_img=True)).astype(int)
    finally:
        plotter.close()
    height, width = picture.shape[0] // 2, picture.shape[1] // 4
    redder, bluer = (
        [(picture[:height, width * i : width * (i + 1)] @ channels > 40).mean() for i in range(2)]
        for channels in ([1, 0, -1], [-1, 0, 1])
    )
    assert redder[0] > 0.1
    assert bluer[0] == 0, "the constant is positive"
    assert min(redder[1], bluer[1]) > 0.01
    assert (picture[height:, width:] == 255).all(), "nothing in the cells left over"


def test_one_camera_moves_all_harmonics(mesh: Mesh, basis: Harmonics) -> None:
    plotter = plot_harmonics(*mesh, basis)
    try:
        cameras = {id(renderer.camera) for renderer in plotter.renderers}
        assert len(plotter.renderers) > 4
        assert len(cameras) == 1
    finally:
        plotter.close()


def test_missing_harmonics_and_mismatched_meshes_are_refused(mesh: Mesh, basis: Harmonics) -> None:
    V, F = mesh
    with pytest.raises(OptionError, match="mode 12: a basis of 12 harmonics has modes 0 to 11"):
        plot_harmonics(V, F, basis, [1, 12])
    with pytest.raises(OptionError, match="no modes"):
        plot_harmonics(V, F, basis, [])
    with pytest.raises(ValueError, match=f"of a mesh of {len(V)} vertices, not of {len(V) + 1}"):
        plot_harmonics(np.vstack([V, V[:1]]), F, basis, [1])
    with pytest.raises(ValueError, match="pass n x 3 coordinates"):
        plot_harmonics(V.T, F, basis, [1])


def test_without_its_extra_a_plot_names_it(
    mesh: Mesh, spectrum: GeometrySpectrum, basis: Harmonics, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("meshlab_spectral.extras.find_spec", lambda name: None)
    with pytest.raises(MissingPackageError, match=r"matplotlib: .*meshlab-spectral\[plots\]"):
        plot_spectrum(spectrum)
    with pytest.raises(MissingPackageError, match=r"pyvista: .*meshlab-spectral\[render\]"):
        plot_harmonics(*mesh, basis, [1])


def test_nothing_is_imported_for_plots_until_one_is_made() -> None:
    code = (
        "import sys, meshlab_spectral as m; m.plot_spectrum, m.plot_harmonics; "
        "sys.exit(any(name in sys.modules for name in ('matplotlib', 'pyvista', 'vtk')))"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=60)


def test_what_is_no_result_to_plot_is_refused_with_its_source(mesh: Mesh) -> None:
    calls: dict[str, Callable[[], Any]] = {
        "compare": lambda: plot_comparison(mesh),  # type: ignore[arg-type]
        "geometry_spectrum": lambda: plot_spectrum(None),  # type: ignore[arg-type]
        "manifold_harmonics": lambda: plot_harmonics(*mesh, mesh[0]),  # type: ignore[arg-type]
        "surface_texture": lambda: plot_texture(*mesh, mesh[0]),  # type: ignore[arg-type]
    }
    for source, call in calls.items():
        with pytest.raises(ArgumentError, match=f"pass the result of {source}$"):
            call()
