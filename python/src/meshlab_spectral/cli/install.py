"""The command `meshlab-spectral install`."""

from __future__ import annotations

from typing import Annotated

import typer

from meshlab_spectral.cli.messages import errors_reported
from meshlab_spectral.plugin.installation import (
    HOSTS,
    Change,
    FoundMeshLab,
    find_meshlab,
    install,
    uninstall,
)

# "\b" keeps a paragraph's lines as they are.
INSTALL_HELP = """Make the filters known to MeshLab 2025.07, for you alone.

Puts the plugin into the folders from which MeshLab reads extra plugins at its start: one for the
usual MeshLab, of single precision, and one for MeshLab 2025.07d, of double precision. The filters
are then in the menu Filters, Smoothing, Fairing and Deformation.

\b
  meshlab-spectral install
  meshlab-spectral install --uninstall
"""


def install_command(
    remove: Annotated[
        bool, typer.Option("--uninstall", help="Take the plugin out of these folders again.")
    ] = False,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Change nothing, only tell what would be done.")
    ] = False,
    debug: Annotated[bool, typer.Option("--debug", hidden=True)] = False,
) -> None:
    """Make the filters known to MeshLab: `meshlab-spectral install --help` tells more."""
    with errors_reported(debug, "some files may have been changed"):
        changes = uninstall(dry_run) if remove else install(dry_run)
        for change in changes:
            typer.echo(_line(change, dry_run))
        if not remove:
            typer.echo(_advice(find_meshlab()))


def _line(change: Change, dry_run: bool) -> str:
    done = change.done
    if dry_run and done in ("installed", "replaced", "removed"):
        done = f"would be {done}"
    return f"{change.host.precision} precision: {change.path} {done}"


def _advice(found: FoundMeshLab | None) -> str:
    wanted = " or ".join(host.version for host in HOSTS)
    if found is None:
        return f"No MeshLab was found; the plugin is for MeshLab {wanted}."
    if found.version is None:
        return f"{found.program} does not tell its version; the plugin is for MeshLab {wanted}."
    if found.host is None:
        return (
            f"Warning: {found.program} is MeshLab {found.version}, which does not take the plugin: "
            f"it is for MeshLab {wanted}."
        )
    return (
        f"{found.program} is MeshLab {found.version}, of {found.host.precision} precision: start "
        "it anew and look in Filters > Smoothing, Fairing and Deformation."
    )
