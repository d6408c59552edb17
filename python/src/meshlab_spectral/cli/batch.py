"""The command `meshlab-spectral batch`."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Annotated, Any

import typer

from meshlab_spectral.batch.files import Workers
from meshlab_spectral.batch.outputs import DEFAULT_PATTERN
from meshlab_spectral.batch.plan import Batch, plan_batch
from meshlab_spectral.batch.report import grouped_warnings
from meshlab_spectral.cli.filter_options import (
    AsJson,
    Recipe,
    SaveRecipe,
    chosen_options,
    with_options,
)
from meshlab_spectral.cli.many_files import (
    INTERRUPTED,
    Inputs,
    MemoryLimit,
    Recursive,
    ReportFile,
    Resume,
    Scheduler,
    Tally,
    Timeout,
    WorkerCount,
    planning_shown,
    run_shown,
)
from meshlab_spectral.cli.messages import (
    EXIT_FAILED,
    errors_reported,
    print_result,
    warn_of_points_only,
)
from meshlab_spectral.files.recipe import load_recipe, saving_recipe
from meshlab_spectral.filters.denoise import DenoiseOptions
from meshlab_spectral.filters.option_types import Options
from meshlab_spectral.filters.options import FilterOptions

# "\b" keeps a paragraph's lines as they are.
BATCH_HELP = """Filter or denoise many meshes in parallel, with a report.

\b
Smooth a folder of scans:
  meshlab-spectral batch scans --output smooth --feature-size 2%
Denoise it, as denoise does for one scan, with the same options:
  meshlab-spectral batch scans --output clean --denoise
Continue after an interruption, or with more scans:
  meshlab-spectral batch scans --output smooth --feature-size 2% --resume
Save the options for next time:
  meshlab-spectral batch scans --output smooth --feature-size 2% \\
    --save-recipe smooth.toml
  meshlab-spectral batch more/*.obj --output more_smooth --recipe smooth.toml

Each file gets a line in the report, DIR/batch_report.jsonl, as soon as it is done: outcome,
options, the filter's report and warnings, SHA-256 of input and output, seconds, memory, versions.
A file that fails does not stop the others.
"""


@with_options(FilterOptions, DenoiseOptions)
def batch_command(
    given: dict[str, Any],
    inputs: Inputs,
    output: Annotated[
        str,
        typer.Option(
            "--output", "-o", metavar="DIR", help="Output folder, created if needed; or a URL."
        ),
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
        ),
    ] = None,
    recursive: Recursive = False,
    overwrite: Annotated[
        bool,
        typer.Option("--overwrite", help="Replace existing outputs; inputs are never replaced."),
    ] = False,
    resume: Resume = False,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Only list the outputs that would be written.")
    ] = False,
    denoise: Annotated[
        bool, typer.Option("--denoise", help="Denoise instead, with the options of denoise.")
    ] = False,
    recipe: Recipe = None,
    save_recipe: SaveRecipe = None,
    script: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Apply a MeshLab filter script (.mlx) instead of the options. Sizes in it are "
            "lengths, not percentages.",
        ),
    ] = None,
    report: ReportFile = None,
    workers: WorkerCount = None,
    memory_limit: MemoryLimit = None,
    timeout: Timeout = None,
    scheduler: Scheduler = None,
    as_json: AsJson = False,
) -> None:
    """Filter many meshes: see `meshlab-spectral batch --help`."""
    if script is not None and save_recipe is not None:
        raise typer.BadParameter(
            "a recipe holds options of the filter, which a script replaces: leave out one of them",
            param_hint="--save-recipe",
        )
    with errors_reported(INTERRUPTED):
        using = Workers(workers, memory_limit, scheduler)
        options: Options | None = None
        if script is None or given or recipe is not None or denoise:
            table = FilterOptions if recipe is None else load_recipe(recipe)[0]
            options = chosen_options(DenoiseOptions if denoise else table, given, recipe)
        begin = time.monotonic()
        with saving_recipe(save_recipe, options), planning_shown(resume):
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
        if dry_run:
            _print_plan(batch)
            return
        tally = run_shown(batch, using)
        _print_summary(batch, tally, time.monotonic() - begin, as_json)
    if tally.counts["failed"]:
        raise typer.Exit(EXIT_FAILED)


def _print_plan(batch: Batch) -> None:
    for result in batch.done:
        typer.echo(f"{result.input} -> {result.output} (already done)")
    for job in batch.jobs:
        typer.echo(f"{job.source} -> {job.target}")


def _print_summary(batch: Batch, tally: Tally, seconds: float, as_json: bool) -> None:
    if as_json:
        outcomes = ("filtered", "failed", "unchanged", "already done")
        summary = {
            **{outcome.replace(" ", "_"): tally.counts[outcome] for outcome in outcomes},
            "with_warnings": len(tally.warnings),
            "warnings": grouped_warnings(tally.warnings),
            "seconds": round(seconds, 1),
            "report": str(batch.report),
        }
        typer.echo(json.dumps(summary))
        return
    print_result(f"{tally.summary('filtered')} in {seconds:.1f} s; report: {batch.report}")
