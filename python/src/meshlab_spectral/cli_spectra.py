"""The command `meshlab-spectral spectra`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from meshlab_spectral.batch.files import workers_for
from meshlab_spectral.batch.inputs import find_inputs
from meshlab_spectral.batch.jobs import FileResult
from meshlab_spectral.batch.progress import batch_progress
from meshlab_spectral.batch.spectra import spectrum_jobs, write_table
from meshlab_spectral.command_line import EXIT_FAILED, MESSAGES, errors_reported
from meshlab_spectral.options import Boundary, LaplacianKind
from meshlab_spectral.spectrum import DEFAULT_BASIS_SIZE
from meshlab_spectral.whole_files import remove_leftovers, writing_whole

# "\b" keeps a paragraph's lines as they are.
SPECTRA_HELP = """Measure how much of many meshes is in details of which size: one table of all.

The table has a row for every octave of every mesh, as comma-separated values: the feature size and
the amplitude of the details of about this size, in percent of the diagonal and in the units of the
mesh, and their share of the energy. The octaves are the same percentages for all meshes. `spectrum`
plots one of them.

\b
  meshlab-spectral spectra scans --output spectra.csv
"""


def spectra_command(
    inputs: Annotated[
        list[str],
        typer.Argument(
            metavar="INPUT",
            help="Mesh files, folders, patterns in quotes such as 'scans/*.ply', URLs.",
        ),
    ],
    output: Annotated[
        Path, typer.Option(metavar="FILE", help="The table to write. Replaces a file.")
    ] = Path("spectra.csv"),
    recursive: Annotated[
        bool, typer.Option("--recursive", "-r", help="Search folders in folders, too.")
    ] = False,
    basis_size: Annotated[
        int, typer.Option(min=1, help="How many of the lowest harmonics are measured one by one.")
    ] = DEFAULT_BASIS_SIZE,
    laplacian: Annotated[
        LaplacianKind, typer.Option(help="As for the filter.")
    ] = "intrinsic delaunay",
    boundary: Annotated[
        Boundary, typer.Option(help="Whether the rims of open surfaces are part of their shape.")
    ] = "free",
    workers: Annotated[
        int | None, typer.Option(min=1, help="Files at once. By default one for each processor.")
    ] = None,
    timeout: Annotated[
        float | None, typer.Option(min=1, help="Seconds that a file may take. By default any.")
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="Use a Dask cluster that is running, as for batch."),
    ] = None,
    debug: Annotated[bool, typer.Option("--debug", hidden=True)] = False,
) -> None:
    """Measure spectra of many meshes: `meshlab-spectral spectra --help` tells more."""
    remove_leftovers(output.resolve().parent, output.name)
    with errors_reported(debug), writing_whole(output) as scratch:
        found = find_inputs(inputs, recursive)
        jobs = spectrum_jobs(found, basis_size, laplacian, boundary, timeout)
        results: list[FileResult] = []
        with (
            batch_progress(MESSAGES, len(jobs)) as on_result,
            workers_for(scheduler, workers) as run,
        ):
            for result in run(jobs):
                results.append(result)
                on_result(result)
        write_table(scratch, results)
    failed = sum(result.outcome == "failed" for result in results)
    typer.echo(f"{len(results) - failed} measured, {failed} failed; table: {output}")
    if failed:
        raise typer.Exit(EXIT_FAILED)
