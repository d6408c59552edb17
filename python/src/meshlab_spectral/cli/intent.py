"""What `filter --dry-run` prints."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import typer
from rich.console import Console

from meshlab_spectral.cli.messages import one_line, print_warning
from meshlab_spectral.cli.report_table import length_text, table_of
from meshlab_spectral.filters.option_types import Options
from meshlab_spectral.filters.options import FilterOptions
from meshlab_spectral.plugin.versions import versions


def print_intent(
    source: Path, target: Path, options: Options, intent: dict[str, Any], as_json: bool
) -> None:
    """Print what `intent_of_file` has returned; it is what was asked for, also with --quiet."""
    for surface in intent["surfaces"]:
        size, edge = surface["sizes"].get("feature_size"), surface["mean_edge"]
        if _is_size_given(options) and size < edge:
            print_warning(
                f"the feature size {size:.3g} is below the mean edge length {edge:.3g}: choose at "
                f"least two edges, {2 * edge:.3g}"
            )
    if as_json:
        record = {"input": str(source), "output": str(target), "options": options.as_dict()}
        typer.echo(json.dumps({**record, "intent": intent, "versions": versions()}))
        return
    console = Console(emoji=False)
    for surface in intent["surfaces"]:
        name = f", {surface['mesh']}" if surface["mesh"] else ""
        console.print(table_of(_rows(surface), f"{source} -> {target}{name}"))
    typer.echo(one_line(f"{target} would be {_way(target, intent)}. Nothing was written."))


def _is_size_given(options: Options) -> bool:
    """Whether there is a feature size that the run would warn of where the edges are longer."""
    if not isinstance(options, FilterOptions) or options.filter_type == "custom":
        return False
    size = options.feature_size
    return not size.automatic and size != FilterOptions().feature_size


def _rows(surface: dict[str, Any]) -> list[tuple[str, str]]:
    diagonal, edge = surface["diagonal"], surface["mean_edge"]
    vertices = f"{surface['vertices']}"
    if "filtered_vertices" in surface:
        vertices = f"{surface['filtered_vertices']} of {vertices}, and some around them"
    rows = [("Vertices", vertices), ("Faces", f"{surface['faces']}")]
    rows += [("Diagonal", f"{diagonal:.4g}"), ("Mean edge", f"{edge:.4g}")]
    for name, size in surface["sizes"].items():
        if size is not None:
            shown = length_text(size, edge, diagonal)
        elif name.startswith("noise_"):
            shown = "as measured in the run"
        else:
            continue
        rows.append((name.replace("_", " ").capitalize(), shown))
    return rows


def _way(target: Path, intent: dict[str, Any]) -> str:
    """Say how the output would be written, and whether it fits in memory."""
    replaced = "replaced" if target.is_file() else "written"
    how = "with all else kept" if intent["is_patched"] else "anew by MeshLab"
    tiles, needed = intent["tiles"], intent["memory"] / 2**30
    fits = f"in {tiles} tiles" if tiles else f"as a whole, in about {needed:.2g} GiB of memory"
    return f"{replaced} {how}, {fits}; {intent['available_memory'] / 2**30:.2g} GiB are free"
