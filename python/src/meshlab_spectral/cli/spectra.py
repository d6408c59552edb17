"""The command `meshlab-spectral spectra`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from meshlab_spectral.batch.jobs import FileResult
from meshlab_spectral.batch.settings import Settings
from meshlab_spectral.batch.spectra import plan_spectra, write_table
from meshlab_spectral.cli.filter_options import with_options
from meshlab_spectral.cli.many_files import (
    INTERRUPTED,
    Inputs,
    planning_shown,
    run_shown,
)
from meshlab_spectral.cli.messages import EXIT_FAILED, errors_reported, print_result
from meshlab_spectral.files.whole_files import remove_leftovers, resolved, writing_whole
from meshlab_spectral.filters.options import Boundary, LaplacianKind
from meshlab_spectral.filters.spectrum import DEFAULT_BASIS_SIZE

# "\b" keeps a paragraph's lines as they are.
SPECTRA_HELP = """Measure the geometry spectra of many meshes, in one table.

The table has a row for each octave of each mesh, as comma-separated values: the feature size and
the amplitude of details of about this size, in percent of the diagonal and in the units of the
mesh, and their share of the energy. The octaves are at the same percentages for all meshes.
`spectrum` plots a single mesh.

\b
  meshlab-spectral spectra scans --output spectra.csv
Continue after an interruption, or with more scans:
  meshlab-spectral spectra scans --output spectra.csv --resume

Each mesh gets a line in the report, spectra_report.jsonl, as soon as it is measured.
"""


@with_options(
    Settings,
    names=("recursive", "resume", "report", "workers", "memory_limit", "timeout", "scheduler"),
)
def spectra_command(
    settings: Settings,
    inputs: Inputs,
    output: Annotated[
        Path,
        typer.Option(
            "--output", "-o", metavar="TABLE", help="Table to write; replaces an existing file."
        ),
    ] = Path("spectra.csv"),
    basis_size: Annotated[
        int, typer.Option(min=0, help="Number of lowest harmonics to measure individually, too.")
    ] = DEFAULT_BASIS_SIZE,
    laplacian: Annotated[
        LaplacianKind, typer.Option(help="As for the filter.")
    ] = "intrinsic delaunay",
    boundary: Annotated[
        Boundary,
        typer.Option(help="Whether boundaries of open surfaces are part of the shape (free)."),
    ] = "free",
) -> None:
    """Measure spectra of many meshes: see `meshlab-spectral spectra --help`."""
    with errors_reported(INTERRUPTED):
        with planning_shown(settings.resume):
            batch = plan_spectra(inputs, output, basis_size, laplacian, boundary, settings)
        remove_leftovers(resolved(output).parent, output.name)
        results: list[FileResult] = []
        with writing_whole(output) as scratch:
            tally = run_shown(batch, results.append)
            write_table(scratch, results)
        print_result(f"{tally.summary('measured')}; table: {output}, report: {batch.report}")
    if tally.counts["failed"]:
        raise typer.Exit(EXIT_FAILED)
