"""The manual page, from the help of all commands."""

from __future__ import annotations

from typing import Any

import typer
from typer.main import get_command

_COLUMNS = 76  # of a terminal of 80, indented by man


def manual(app: typer.Typer) -> str:
    """Return the page in roff, as `man` reads it."""
    group: Any = get_command(app)
    context = group.make_context("meshlab-spectral", ["--help"], resilient_parsing=True)
    page = [
        '.TH MESHLAB-SPECTRAL 1 "" "" "User Commands"',
        ".SH NAME",
        "meshlab-spectral \\- filter meshes by the size of their details",
    ]
    page += _section("DESCRIPTION", group, context)
    for name, command in group.commands.items():
        of_command = type(context)(command, info_name=name, parent=context, terminal_width=_COLUMNS)
        page += _section(name.upper(), command, of_command)
    return "\n".join(page)


def _section(heading: str, command: Any, context: Any) -> list[str]:
    context.terminal_width = _COLUMNS
    lines = command.get_help(context).replace("\\", "\\e").replace("-", "\\-").splitlines()
    # A dot at the beginning of a line would be a request.
    return [f".SH {heading}", ".nf", *(f"\\&{line}" for line in lines), ".fi"]
