"""The command `meshlab-spectral batch`."""

from __future__ import annotations

import json
import time
from collections import Counter
from pathlib import Path
from typing import Annotated, Any

import typer

from meshlab_spectral.batch.files import check_workers
from meshlab_spectral.batch.outputs import DEFAULT_PATTERN
from meshlab_spectral.batch.plan import Batch, plan_batch
from meshlab_spectral.batch.report import DEFAULT_NAME
from meshlab_spectral.cli.filter_options import with_given_filter_options
from meshlab_spectral.cli.many_files import (
    INTERRUPTED,
    Debug,
    Inputs,
    MemoryLimit,
    Scheduler,
    Timeout,
    Workers,
    planning_shown,
    run_shown,
    summary_of,
)
from meshlab_spectral.cli.messages import EXIT_FAILED, errors_reported, warn_of_points_only
from meshlab_spectral.errors import OptionError
from meshlab_spectral.files.recipe import load_recipe, save_recipe
from meshlab_spectral.filters.denoise import DenoiseOptions
from meshlab_spectral.filters.option_types import Options
from meshlab_spectral.filters.options import FilterOptions

# "\b" keeps a paragraph's lines as they are.
BATCH_HELP = """Filter or denoise many meshes in parallel, with a report.

\b
Smooth a folder of scans:
  meshlab-spectral batch scans --output smooth --feature-size 2%
Denoise it, as denoise does for one scan:
  meshlab-spectral batch scans --output clean --denoise
Continue after an interruption, or with more scans:
  meshlab-spectral batch scans --output smooth --feature-size 2% --resume
Save the options for next time:
  meshlab-spectral batch scans --output smooth --feature-size 2% --save-recipe smooth.toml
  meshlab-spectral batch more/*.obj --output more_smooth --recipe smooth.toml --format ply

Each file gets a line in the report, DIR/batch_report.jsonl, as soon as it is done: outcome,
options, the filter's report and warnings, SHA-256 of input and output, seconds, memory, versions.
A file that fails does not stop the others.
"""


@with_given_filter_options
def batch_command(
    context: typer.Context,
    given: dict[str, Any],
    inputs: Inputs,
    output: Annotated[
        str, typer.Option(metavar="DIR", help="Output folder, created if needed; or a URL.")
    ],
    name: Annotated[
        str,
        typer.Option(
            metavar="PATTERN",
            help="Names of the outputs, without extension, made from those of the inputs: {stem}, "
            "{ending}, {folder}; such as {stem}_smooth or {folder}/{stem}.",
        ),
    ] = DEFAULT_PATTERN,
    ending: Annotated[
        str | None,
        typer.Option(
            "--format",
            metavar="ENDING",
            help="Format of the outputs, such as ply. By default that of the input, or ply if "
            "MeshLab cannot write that with faces.",
            show_default=False,
        ),
    ] = None,
    recursive: Annotated[
        bool,
        typer.Option(
            "--recursive",
            "-r",
            help="Search subfolders, too, and recreate them in the output folder.",
        ),
    ] = False,
    overwrite: Annotated[
        bool,
        typer.Option("--overwrite", help="Replace existing outputs; inputs are never replaced."),
    ] = False,
    resume: Annotated[
        bool,
        typer.Option(
            "--resume",
            help="Skip what the report proves done with the same input, options and versions; "
            "replace outputs changed since.",
        ),
    ] = False,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Only list the outputs that would be written.")
    ] = False,
    denoise: Annotated[
        bool,
        typer.Option(
            "--denoise",
            help="Denoise instead, with the defaults of denoise; its options go into a recipe.",
        ),
    ] = False,
    recipe: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Read the filter's options from a TOML file; options given here override it.",
        ),
    ] = None,
    save_recipe_as: Annotated[
        Path | None,
        typer.Option(
            "--save-recipe", metavar="FILE", help="Write the filter's options to a TOML file."
        ),
    ] = None,
    script: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Apply a MeshLab filter script (.mlx) instead of the options. Sizes in it are "
            "lengths, not percentages.",
        ),
    ] = None,
    report: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help=f"The report, one JSON object per line; appended to if it exists. By default "
            f"DIR/{DEFAULT_NAME}.",
            show_default=False,
        ),
    ] = None,
    workers: Workers = None,
    memory_limit: MemoryLimit = None,
    timeout: Timeout = None,
    scheduler: Scheduler = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print the summary as one JSON object.")
    ] = False,
    debug: Debug = False,
) -> None:
    """Filter many meshes: see `meshlab-spectral batch --help`."""
    if script is not None and save_recipe_as is not None:
        raise typer.BadParameter(
            "a recipe holds options of the filter, which a script replaces: leave out one of them",
            param_hint="--save-recipe",
        )
    if denoise and (given or recipe is not None or script is not None):
        raise typer.BadParameter(
            "takes no options, recipe or script beside it; for other options of denoise use "
            "--recipe alone, with the table [denoise]",
            param_hint="--denoise",
        )
    with errors_reported(debug, INTERRUPTED):
        check_workers(scheduler, workers, memory_limit)
        options = DenoiseOptions() if denoise else _options(given, recipe, script)
        begin = time.monotonic()
        with planning_shown(resume):
            batch = plan_batch(
                inputs,
                output,
                options,
                script=script,
                recursive=recursive,
                name=name,
                ending=ending,
                overwrite=overwrite,
                resume=resume,
                report=report,
                timeout=timeout,
            )
        warn_of_points_only(ending or "")
        if save_recipe_as is not None and options is not None:
            save_recipe(save_recipe_as, options)
        if dry_run:
            _tell_plan(batch)
            return
        counts = run_shown(batch, workers, memory_limit, scheduler)
        _tell_summary(batch, counts, time.monotonic() - begin, as_json)
    if counts["failed"]:
        raise typer.Exit(EXIT_FAILED)


def _options(given: dict[str, Any], recipe: Path | None, script: Path | None) -> Options | None:
    if script is not None and not given and recipe is None:
        return None
    if recipe is None:
        return FilterOptions.from_dict(given)
    table, options = load_recipe(recipe)
    if table is not FilterOptions and given:
        raise OptionError(
            f"{', '.join(given)}: not for the recipe {recipe}, which is for another filter; write "
            f"its options into the table [{table.TABLE}] there"
        )
    return table.from_dict({**options, **given})


def _tell_plan(batch: Batch) -> None:
    for result in batch.done:
        typer.echo(f"{result.input} -> {result.output} (already done)")
    for job in batch.jobs:
        typer.echo(f"{job.source} -> {job.target}")


def _tell_summary(batch: Batch, counts: Counter[str], seconds: float, as_json: bool) -> None:
    summary: dict[str, Any] = {
        "filtered": counts["filtered"],
        "failed": counts["failed"],
        "unchanged": counts["unchanged"],
        "already_done": counts["already done"],
        "with_warnings": counts["with warnings"],
        "seconds": round(seconds, 1),
        "report": str(batch.report),
    }
    if as_json:
        typer.echo(json.dumps(summary))
        return
    typer.echo(f"{summary_of(counts, 'filtered')} in {seconds:.1f} s; report: {batch.report}")
