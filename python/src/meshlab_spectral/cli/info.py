"""The command `meshlab-spectral info`."""

from __future__ import annotations

import json
from typing import Any

import typer
from rich.console import Console

from meshlab_spectral.cli.filter_options import AsJson, OneMesh, Source
from meshlab_spectral.cli.messages import errors_reported, print_warning
from meshlab_spectral.cli.progress import progress_shown
from meshlab_spectral.cli.report_table import length_text, table_of
from meshlab_spectral.files.request import Request
from meshlab_spectral.plugin.versions import versions
from meshlab_spectral.workers.single_file import measure_in_child


def info_command(source: Source, mesh: OneMesh = None, as_json: AsJson = False) -> None:
    """Describe a mesh: surface, noise, and a feature size to try.

    Nothing is written. Lengths are in the units of the file; the noise is what denoise would
    remove, the feature size the default of filter.

      meshlab-spectral info scan.ply
      meshlab-spectral info scan.ply --json
    """
    with errors_reported("nothing was printed"), progress_shown() as on_progress:
        report = measure_in_child("mesh_info", Request(source, mesh=mesh), on_progress)
    for warning in report["warnings"]:
        print_warning(warning)
    if as_json:
        typer.echo(json.dumps({"input": str(source), **report, "versions": versions()}))
        return
    Console(emoji=False).print(table_of(_rows(report), source.name))
    typer.echo(f"Noise: {report['noise_summary']}")


def _rows(report: dict[str, Any]) -> list[tuple[str, str]]:
    edge, diagonal = report["mean_edge"], report["diagonal"]

    def length(name: str) -> str:
        return length_text(report[name], edge, diagonal) if report[name] else "none"

    selected = [report.get(f"selected_{what}", 0) for what in ("faces", "vertices")]
    # What was found nevertheless is none that was searched for: voxel steps.
    searched = report["noise_searched"] or report["noise_height"] > 0
    voxel = " x ".join(f"{x:.4g}" for x in report["voxel_size"] if x)
    rows = [
        ("Meshes", ", ".join(report["meshes"]) if len(report["meshes"]) > 1 else ""),
        ("Vertices", f"{report['vertices']}"),
        ("Faces", f"{report['faces']}"),
        ("Components", f"{report['components']}"),
        ("Rims (boundary loops)", f"{report['rims']}"),
        ("Vertices joined at seams", f"{report['joined_vertices']}"),
        ("Vertices without faces", f"{report['unreferenced_vertices'] or ''}"),
        ("Selected", "{} faces, {} vertices".format(*selected) if any(selected) else ""),
        ("Extent", " x ".join(f"{x:.4g}" for x in report["extent"])),
        ("Diagonal", f"{diagonal:.4g}"),
        ("Mean edge", f"{edge:.4g} ({100 * edge / diagonal:.2g} %)"),
        ("Noise height", length("noise_height") if searched else "not searched for, see below"),
        ("Noise size", length("noise_size") if report["noise_size"] else ""),
        ("Spikes", f"{report['spikes'] or ''}"),
        ("Voxels", voxel),
        ("Suggested feature size", length("default_feature_size")),
    ]
    return [(label, value) for label, value in rows if value]
