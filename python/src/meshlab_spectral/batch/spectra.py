"""The geometry spectra of many mesh files, measured in worker processes, as one table."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from meshlab_spectral.batch.inputs import Input
from meshlab_spectral.batch.jobs import FileResult, Job
from meshlab_spectral.spectrum import GeometrySpectrum, spectrum_parameters

COLUMNS = (
    "mesh",
    "diagonal",
    "area",
    "feature_size_percent",
    "feature_size",
    "amplitude_percent",
    "amplitude",
    "energy_share",
    "noise_feature_size",
    "noise_height",
)


def spectrum_jobs(
    inputs: Sequence[Input],
    basis_size: int,
    laplacian: str,
    boundary: str,
    seconds: float | None = None,
) -> list[Job]:
    """Make a job of every input: its report is the spectrum.

    Raises
    ------
    OptionError
        When a parameter has a value that it cannot take; see `spectrum.geometry_spectrum`.
    """
    parameters = spectrum_parameters(basis_size, laplacian, boundary)
    work = {"task": "spectrum", "parameters": parameters}
    return [Job(file.place, None, file.place, work, parameters, seconds) for file in inputs]


def write_table(path: Path, results: Iterable[FileResult]) -> None:
    """Write measured spectra as comma-separated values: a row for every octave of every mesh.

    The octaves are those of `GeometrySpectrum`, the same percentages of the diagonal for all
    meshes, so that rows of different meshes can be compared. Other lengths are in the units of the
    mesh; noise_feature_size and noise_height are those of the whole mesh, 0 where none is seen.
    """
    with path.open("w", newline="", encoding="utf-8", errors="surrogateescape") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(COLUMNS)
        for result in sorted(results, key=lambda result: result.input):
            if result.report is not None:
                table.writerows(_rows(result.input, GeometrySpectrum.from_report(result.report)))


def _rows(mesh: str, spectrum: GeometrySpectrum) -> list[list[Any]]:
    percent = 100 / spectrum.diagonal
    shares = np.diff(spectrum.cumulative_energy, prepend=0.0)
    rows = zip(spectrum.octave_feature_sizes, spectrum.octave_amplitudes, shares, strict=True)
    return [
        [
            mesh,
            *(f"{number:.6g}" for number in (spectrum.diagonal, spectrum.area)),
            *(f"{number:.6g}" for number in (size * percent, size)),
            *(f"{number:.6g}" for number in (amplitude * percent, amplitude, share)),
            *(f"{x:.6g}" for x in (spectrum.noise_feature_size, spectrum.noise_height)),
        ]
        for size, amplitude, share in rows
    ]
