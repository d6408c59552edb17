"""The geometry spectra of many mesh files: planning the batch, and writing the table."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from meshlab_spectral.batch.inputs import find_inputs
from meshlab_spectral.batch.jobs import FileResult, Job
from meshlab_spectral.batch.outputs import refuse_inputs
from meshlab_spectral.batch.plan import Batch
from meshlab_spectral.batch.report import check_report, read_report
from meshlab_spectral.batch.resume import done_records, proved_done
from meshlab_spectral.batch.settings import Settings
from meshlab_spectral.errors import InputError
from meshlab_spectral.files.request import Request
from meshlab_spectral.filters.options import SpectrumOptions
from meshlab_spectral.filters.spectrum import GeometrySpectrum
from meshlab_spectral.plugin.versions import versions

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


def plan_spectra(
    inputs: Sequence[str | Path],
    table: Path,
    options: SpectrumOptions,
    settings: Settings,
) -> Batch:
    """Plan the measurement of many spectra; the report on each mesh is its spectrum.

    `inputs` are those of `files.filter_files`, `table` is the file for `write_table`; the default
    report is TABLE_report.jsonl, next to it. Raises InputError when inputs are missing, or the
    table or the report would replace another file, and as `check_workers` and `read_report` do.
    """
    settings.check_workers()
    table = table.absolute()
    report = (settings.report or table.parent / f"{table.stem}_report.jsonl").absolute()
    if report == table:
        raise InputError(f"the report {report} is also the table: choose another with --report")
    check_report(report)
    locations = [
        file.location for file in find_inputs(map(str, inputs), settings.recursive, [table, report])
    ]
    refuse_inputs([str(table)], locations)
    if table.is_file() and table.stat().st_size and not _is_table(table):
        raise InputError(f"{table} exists and is not a table of spectra: choose another name")
    request, described = Request(Path(), options, verbose=False), options.as_dict()
    jobs = [Job(one, None, one, request, described, settings.timeout) for one in locations]
    proved = (
        proved_done(jobs, done_records(read_report(report)), versions()) if settings.resume else {}
    )
    done = {job: result for job, result in proved.items() if _is_whole(result)}
    return Batch([job for job in jobs if job not in done], list(done.values()), report, settings)


def _is_table(path: Path) -> bool:
    with path.open("rb") as file:
        return file.read(len(COLUMNS[0])) == COLUMNS[0].encode()


def write_table(path: Path, results: Iterable[FileResult]) -> None:
    """Write spectra as comma-separated values: a row for each octave of each mesh.

    The octaves are those of `GeometrySpectrum`, at the same percentages of the diagonal for all
    meshes (but for those that a warning says have far vertices without faces), so that rows of
    different meshes are comparable. Other lengths are in the units of the mesh; noise_feature_size
    and noise_height are the same for all rows of a mesh, 0 without noise.
    """
    with path.open("w", newline="", encoding="utf-8", errors="surrogateescape") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(COLUMNS)
        for result in sorted(results, key=lambda result: result.input):
            if result.report is not None:
                table.writerows(_rows(result.input, GeometrySpectrum.from_report(result.report)))


def _is_whole(result: FileResult) -> bool:
    """Whether a recorded spectrum can be written to the table; else it is measured again."""
    try:
        _rows(result.input, GeometrySpectrum.from_report(result.report or {}))
    except (ArithmeticError, LookupError, TypeError, ValueError):
        return False
    return True


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
