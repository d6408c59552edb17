"""Pictures of what is measured on meshes: geometry spectra, and manifold harmonics."""

from __future__ import annotations

import functools
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from demo import bunny_file
from figure_numbers import Drawing, MeshFile, Numbers, diagonal
from meshlab_spectral.figures.harmonics import draw_basis_file, spread_modes
from meshlab_spectral.figures.signed_mesh import texture_sheet
from meshlab_spectral.figures.spectrum import draw_spectrum
from meshlab_spectral.files.meshes import load_arrays
from meshlab_spectral.filters.harmonics import manifold_harmonics
from meshlab_spectral.filters.option_types import Length
from meshlab_spectral.filters.options import BasisOptions, Boundary, FilterOptions
from meshlab_spectral.filters.spectrum import geometry_spectrum
from meshlab_spectral.filters.texture import surface_texture
from numpy.typing import NDArray
from subject import subject_of

HARMONICS_IN_SPECTRUM = 200
# Of those on a sheet, only the lowest are recorded: they take a fraction of the time.
HARMONICS_RECORDED = 20
# Smaller octaves, relative to the largest, are not drawn.
SMALLEST_OCTAVE = 1e-5


def spectrum_noisy_bunny(mesh: MeshFile) -> Drawing:
    """Show the spectrum of pymeshlab's bunny, moved at random by up to 0.2 % along each axis."""
    V, F = load_arrays(bunny_file())
    noise = 0.002 * diagonal(V) * np.random.default_rng(1).uniform(-1, 1, V.shape)
    return _spectrum("noisy_bunny.ply", V + noise, F, 4)


def spectrum_rangescan(mesh: MeshFile) -> Drawing:
    """Show the spectrum of a raw range scan without what its rim determines."""
    source = mesh("rangescan_lato000.ply")
    return _spectrum(source.name, *load_arrays(source), 2, "fixed")


def _spectrum(
    title: str,
    V: NDArray[np.float64],
    F: NDArray[np.integer],
    percent: float,
    boundary: Boundary = "free",
) -> Drawing:
    """Show a spectrum, and a low-pass at a percentage of the diagonal."""
    options = FilterOptions(feature_size=Length(percent, "%"), boundary=boundary)
    # The single harmonics take most of the time; octaves and noise hardly depend on them.
    spectrum = geometry_spectrum(V, F, 0, boundary=boundary)
    in_percent = 100 / spectrum.diagonal
    numbers: Numbers = {
        f"amplitude at {in_percent * size:.3g} %, %": in_percent * amplitude
        for size, amplitude in zip(
            spectrum.octave_feature_sizes, spectrum.octave_amplitudes, strict=True
        )
        if amplitude > SMALLEST_OCTAVE * spectrum.octave_amplitudes.max()
    }
    numbers["noise height, %"] = in_percent * spectrum.noise_height
    numbers["noise feature size, %"] = in_percent * spectrum.noise_feature_size

    def draw(path: Path) -> None:
        whole = geometry_spectrum(V, F, HARMONICS_IN_SPECTRUM, boundary=boundary)
        draw_spectrum(whole, options, title, path)

    return Drawing(numbers, draw)


def roughness(mesh: MeshFile) -> Drawing:
    """Show the heights of a stone's surface, as `meshlab-spectral texture` does."""
    source = mesh("rangescan_lato000.ply")
    V, F = load_arrays(source)
    texture = surface_texture(V, F)
    numbers: Numbers = {
        f"{name}, %": 100 / diagonal(V) * getattr(texture, name) for name in ("Sa", "Sq", "Sz")
    }
    numbers["left out, %"] = 100 * texture.vertices_left_out / len(V)

    return Drawing(numbers, texture_sheet(V, F, texture, source.name).save)


def harmonics(name: str, mesh: MeshFile) -> Drawing:
    """Show a dozen harmonics of a mesh, as `meshlab-spectral basis` does."""
    subject = subject_of(mesh(name))
    lowest = manifold_harmonics(subject.V, subject.F, HARMONICS_RECORDED)
    constants = int(np.count_nonzero(lowest.eigenvalues == 0))
    numbers = {
        f"harmonic {mode}: wavelength, %": 200 * np.pi / lowest.frequencies[mode] / subject.diagonal
        for mode in spread_modes(constants, BasisOptions.basis_size)
        if mode < HARMONICS_RECORDED
    }

    def draw(path: Path) -> None:
        basis = manifold_harmonics(subject.V, subject.F, BasisOptions.basis_size)
        with tempfile.TemporaryDirectory() as folder:
            archive = Path(folder, "basis.npz")
            np.savez(archive, **vars(basis), vertices=subject.V, faces=subject.F)
            draw_basis_file(archive, path)

    return Drawing(numbers, draw)


PICTURES: dict[str, Callable[[MeshFile], Drawing]] = {
    "spectrum_noisy_bunny": spectrum_noisy_bunny,
    "spectrum_rangescan": spectrum_rangescan,
    "surface_texture": roughness,
    "harmonics_dragon_40k": functools.partial(harmonics, "dragon_40k.ply"),
    "harmonics_angel_50k": functools.partial(harmonics, "angel_50k.ply"),
}
