"""The command `meshlab-spectral batch`."""

from __future__ import annotations

import json
import time
from typing import Annotated, Any

import typer

from meshlab_spectral.batch.jobs import Outcome
from meshlab_spectral.batch.plan import Batch, plan_batch
from meshlab_spectral.batch.report import Tally
from meshlab_spectral.batch.settings import Settings
from meshlab_spectral.cli.filter_options import (
    AsJson,
    Recipe,
    SavePreset,
    SaveRecipe,
    chosen_options,
    with_options,
)
from meshlab_spectral.cli.many_files import INTERRUPTED, Inputs, planning_shown, run_shown
from meshlab_spectral.cli.messages import (
    EXIT_FAILED,
    errors_reported,
    print_result,
    warn_of_points_only,
)
from meshlab_spectral.files.presets import preset_place
from meshlab_spectral.files.recipe import load_recipe, saving_recipe
from meshlab_spectral.filters.option_types import Options
from meshlab_spectral.filters.options import DenoiseOptions, FilterOptions


@with_options(FilterOptions, DenoiseOptions, Settings)
def batch_command(
    explicit: dict[str, Any],
    settings: Settings,
    inputs: Inputs,
    output: Annotated[
        str,
        typer.Option(
            "--output", "-o", metavar="DIR", help="Output folder, created if needed; or a URL."
        ),
    ],
    dry_run: Annotated[
        bool, typer.Option("--dry-run", "-n", help="Only list the outputs that would be written.")
    ] = False,
    denoise: Annotated[
        bool, typer.Option("--denoise", help="Denoise instead, with the options of denoise.")
    ] = False,
    recipe: Recipe = None,
    save_recipe: SaveRecipe = None,
    save_preset: SavePreset = None,
    as_json: AsJson = False,
) -> None:
    """Filter or denoise many meshes in parallel, with a report.

    Smooth a folder of scans:
      meshlab-spectral batch scans --output smooth --feature-size 2%
    Denoise it, as denoise does for one scan, with the same options:
      meshlab-spectral batch scans --output clean --denoise
    Continue after an interruption, or with more scans:
      meshlab-spectral batch scans --output smooth --feature-size 2% --resume
    Save the options for next time:
      meshlab-spectral batch scans -o clean --denoise --save-recipe clean.toml
      meshlab-spectral batch more/*.obj -o more_clean --recipe clean.toml

    Each file gets a line in the report, DIR/batch_report.jsonl, as soon as it is done: outcome,
    options, the filter's report and warnings, SHA-256 of input and output, seconds, memory,
    versions. A file that fails does not stop the others.
    """
    if settings.script is not None and (save_recipe or save_preset) is not None:
        raise typer.BadParameter(
            "a recipe holds options of the filter, which a script replaces: leave out one of them",
            param_hint="--save-recipe",
        )
    with errors_reported(INTERRUPTED):
        options: Options | None = None
        if settings.script is None or explicit or recipe is not None or denoise:
            table = FilterOptions if recipe is None else load_recipe(recipe)[0]
            options = chosen_options(DenoiseOptions if denoise else table, explicit, recipe)
        if save_preset is not None:
            save_recipe = preset_place(save_preset)
        begin = time.monotonic()
        with saving_recipe(save_recipe, options), planning_shown(settings.resume):
            batch = plan_batch(inputs, output, settings, options)
        warn_of_points_only(settings.ending or "")
        if dry_run:
            _print_plan(batch)
            return
        tally = run_shown(batch)
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
        outcomes: tuple[Outcome, ...] = ("filtered", "failed", "unchanged", "already done")
        summary = {
            **{outcome.replace(" ", "_"): tally.counts[outcome] for outcome in outcomes},
            **tally.warnings_by_kind(),
            "seconds": round(seconds, 1),
            "report": str(batch.report),
        }
        typer.echo(json.dumps(summary))
        return
    print_result(f"{tally.summary('filtered')} in {seconds:.1f} s; report: {batch.report}")
