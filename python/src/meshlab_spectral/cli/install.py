"""The command `meshlab-spectral install`."""

from __future__ import annotations

from typing import Annotated

import typer

from meshlab_spectral.cli.messages import errors_reported, print_result
from meshlab_spectral.plugin.installation import (
    HOSTS,
    Change,
    FoundMeshLab,
    find_meshlab,
    install,
    uninstall,
)


def install_command(
    remove: Annotated[
        bool, typer.Option("--uninstall", help="Remove the plugin from these folders.")
    ] = False,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Change nothing, only show what would be done.")
    ] = False,
) -> None:
    """Install the filters in MeshLab 2025.07, for the current user.

    Copies the plugin to the folders from which MeshLab loads extra plugins when it starts: one for
    the usual single-precision MeshLab, one for the double-precision MeshLab 2025.07d. The filters
    are then in the menu Filters, Smoothing, Fairing and Deformation.

      meshlab-spectral install
      meshlab-spectral install --uninstall
    """
    with errors_reported("some files may have been changed"):
        changes = uninstall(dry_run) if remove else install(dry_run)
        tell = typer.echo if dry_run else print_result
        for change in changes:
            tell(_line(change, dry_run))
        if not remove:
            found = find_meshlab()
            fits = found is not None and found.host is not None
            (tell if fits else typer.echo)(_advice(found))


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
        return f"{found.program} does not report its version; the plugin is for MeshLab {wanted}."
    if found.host is None:
        return (
            f"Warning: {found.program} is MeshLab {found.version}, which cannot load the plugin: "
            f"it is for MeshLab {wanted}."
        )
    return (
        f"{found.program} is MeshLab {found.version}, of {found.host.precision} precision: restart "
        "it and look in Filters > Smoothing, Fairing and Deformation."
    )
