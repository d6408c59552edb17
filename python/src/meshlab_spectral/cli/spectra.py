"""The command `meshlab-spectral spectra`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from meshlab_spectral.batch.jobs import FileResult
from meshlab_spectral.batch.settings import Settings
from meshlab_spectral.batch.spectra import plan_spectra, write_table
from meshlab_spectral.cli.colour_files import refuse_existing
from meshlab_spectral.cli.filter_options import with_options
from meshlab_spectral.cli.many_files import INTERRUPTED, Inputs, planning_shown, run_shown
from meshlab_spectral.cli.messages import EXIT_FAILED, errors_reported, print_result
from meshlab_spectral.files.whole_files import remove_leftovers, resolved, writing_whole
from meshlab_spectral.filters.options import SpectrumOptions


@with_options(SpectrumOptions, Settings, leave_out=("name", "ending", "joined", "script"))
def spectra_command(
    explicit: dict[str, Any],
    settings: Settings,
    inputs: Inputs,
    output: Annotated[
        Path,
        typer.Option("--output", "-o", metavar="TABLE", help="Table to write."),
    ] = Path("spectra.csv"),
) -> None:
    """Measure the geometry spectra of many meshes, in one table.

    The table has a row for each octave of each mesh, as comma-separated values: the feature size
    and the amplitude of details of about this size, in percent of the diagonal and in the units of
    the mesh, and their share of the energy. The octaves are at the same percentages for all meshes.
    `spectrum` plots a single mesh.

      meshlab-spectral spectra scans --output spectra.csv
    Continue after an interruption, or with more scans:
      meshlab-spectral spectra scans --output spectra.csv --resume

    Each mesh gets a line in the report, spectra_report.jsonl, as soon as it is measured.
    """
    with errors_reported(INTERRUPTED):
        with planning_shown(settings.resume):
            batch = plan_spectra(inputs, output, SpectrumOptions.from_dict(explicit), settings)
        refuse_existing(output, settings.overwrite or settings.resume)
        remove_leftovers(resolved(output).parent, output.name)
        results: list[FileResult] = []
        with writing_whole(output) as scratch:
            tally = run_shown(batch, results.append)
            write_table(scratch, results)
        print_result(f"{tally.summary('measured')}; table: {output}, report: {batch.report}")
    if tally.counts["failed"]:
        raise typer.Exit(EXIT_FAILED)
