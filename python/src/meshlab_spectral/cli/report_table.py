"""The filter's report as a table."""

from __future__ import annotations

from typing import Any

from rich.table import Table
from rich.text import Text

from meshlab_spectral.cli.messages import one_line

_SHOWN_NUMBERS = 6  # of a vector


def report_table(report: dict[str, Any], title: str, in_full: bool = False) -> Table:
    """Format a report of the filter as a table; lengths are in the units of the mesh.

    The title is plain text. `in_full` adds every number of the report, under its own name.
    """
    same = ": unchanged" if report["max_displacement"] == 0 else ""
    rows = _rows(report)
    if in_full:
        numbers = {name: value for name, value in report.items() if "warning" not in name}
        rows += [(name, _plain(x)) for name, x in numbers.items() if not isinstance(x, str)]
    return table_of(rows, title + same)


def table_of(rows: list[tuple[str, str]], title: str) -> Table:
    """Format labels and values."""
    # Text, not str: a name such as "[red].ply" is not markup.
    shown = Text(one_line(title))
    table = Table(title=shown, show_header=False, title_justify="left", title_style="bold")
    table.add_column(style="cyan", no_wrap=True)
    table.add_column(justify="right")
    for label, value in rows:
        table.add_row(one_line(label), Text(one_line(value)))
    return table


def _plain(value: Any) -> str:
    if not isinstance(value, list):
        return f"{value:.6g}" if isinstance(value, float) else str(value)
    shown = ", ".join(map(_plain, value[:_SHOWN_NUMBERS]))
    return f"{shown}, ... ({len(value)})" if len(value) > _SHOWN_NUMBERS else shown


def _rows(report: dict[str, Any]) -> list[tuple[str, str]]:
    is_of_filter = "noise_height" not in report
    rows = []
    if is_of_filter:
        rows += [
            ("Feature size", f"{report['feature_size']:.6g}"),
            ("Cutoff frequency", f"{report['cutoff_frequency']:.6g} rad per unit"),
            ("Steps", _steps(report)),
        ]
        if report["step_error"]:
            rows.append(("Estimated error of the steps", f"{report['step_error']:.2g}"))
        rows.append(("Area", change(report["area_before"], report["area_after"])))
    else:
        rows.append(("Mean edge", f"{report['mean_edge']:.4g}"))
    rows += [
        ("Largest displacement", f"{report['max_displacement']:.4g}"),
        ("RMS displacement", f"{report['rms_displacement']:.4g}"),
    ]
    if report.get("rounded_creases"):
        told = f"by up to {report['rounded_creases']:.2g}; --crease-angle 50 keeps them"
        rows.append(("Sharp edges rounded", told))
    if report.get("limited_share"):
        rows.append(("Bound reached at", f"{100 * report['limited_share']:.2g} % of the surface"))
    if report.get("has_volume"):
        rows.append(("Volume", change(report["volume_before"], report["volume_after"])))
    # What a run in tiles cannot tell.
    if "components" in report:
        rows.append(("Components", f"{report['components']}"))
    else:
        rows.append(("Tiles", f"{report['tiles']}"))
    for name, label, more in (
        ("joined_vertices", "Vertices joined at seams", ""),
        ("unreferenced_vertices", "Vertices without faces", ", unchanged"),
        ("fixed_vertices", "Vertices on a fixed boundary or crease", ", unchanged"),
        ("folded_faces", "Faces folded over", ""),
    ):
        if report.get(name):
            rows.append((label, f"{report[name]}{more}"))
    return rows + (_work(report) if is_of_filter else [])


def _steps(report: dict[str, Any]) -> str:
    # One automatic step is not one of the paper's.
    if report["passes"]:
        return f"automatic, {report['steps']} in pass {report['passes']}"
    return f"{report['steps']}"


def _work(report: dict[str, Any]) -> list[tuple[str, str]]:
    rows = []
    if "eigenvalues" in report:
        rows.append(("Harmonics", f"{len(report['eigenvalues'])}"))
        rows.append(("Bases computed", f"{report['computed_bases']}"))
    else:
        rows.append(("Estimated relative error", f"{report['error_estimate']:.1e}"))
    work = [f"{report[what]} {what}" for what in ("factorizations", "solves", "products")]
    return [*rows, ("Work", ", ".join(work))]


def length_text(x: float, mean_edge: float, diagonal: float) -> str:
    """Format a length, also in mean edges and in percent of the diagonal."""
    return f"{x:.4g} ({x / mean_edge:.3g}e, {100 * x / diagonal:.3g} %)"


def change(before: float, after: float) -> str:
    """Format two numbers and their relative difference."""
    text = f"{before:.6g} -> {after:.6g}"
    return f"{text} ({(after - before) / before:+.1%})" if before else text
