"""Sphinx: the directive `commands`, the help of all commands as the program writes it."""

from __future__ import annotations

from typing import Any

from docutils import nodes
from meshlab_spectral.cli.app import app as program
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective
from typer.main import get_command
from typer.testing import CliRunner

# Width of the page: longer lines would be cut off.
_COLUMNS = 88


def command_names() -> list[str]:
    """Return the names of all commands, in the order of the program's help."""
    group: Any = get_command(program)
    return list(group.commands)


def help_of(*command: str) -> str:
    """Return what `meshlab-spectral COMMAND --help` prints."""
    done = CliRunner().invoke(
        program, [*command, "--help"], prog_name="meshlab-spectral", terminal_width=_COLUMNS
    )
    if done.exit_code != 0:
        raise RuntimeError(f"{' '.join(command)} --help: {done.output}")
    return done.output.strip()


class Commands(SphinxDirective):
    """A section for each command, with its help."""

    def run(self) -> list[nodes.Node]:
        """Write the sections."""
        written: list[nodes.Node] = [_block(help_of())]
        for name in command_names():
            section = nodes.section(ids=[f"command-{name}"], names=[name])
            section += nodes.title(text=name)
            section += _block(help_of(name))
            written.append(section)
        return written


def _block(text: str) -> nodes.literal_block:
    block = nodes.literal_block(text, text)
    block["language"] = "none"
    return block


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the directive."""
    app.add_directive("commands", Commands)
    return {"parallel_read_safe": True}
