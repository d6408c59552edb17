"""Putting the plugin where MeshLab looks for plugins that are not its own."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from meshlab_spectral.errors import PluginError

_PLUGINS = Path(__file__).parent
_VERSION_SECONDS = 20


@dataclass(frozen=True)
class Host:
    """One of the two kinds of MeshLab 2025.07; each takes plugins of its own precision only.

    Attributes
    ----------
    precision
        Of its coordinates: "single" or "double". The plugin computes in double for both.
    version
        As MeshLab calls itself.
    application
        As MeshLab calls itself towards Qt, and with it the folder of its data.
    plugin
        Name of the plugin's library, without what the system puts round it.
    """

    precision: str
    version: str
    application: str
    plugin: str


SINGLE = Host("single", "2025.07", "MeshLab_64bit_fp", "filter_spectral_float")
DOUBLE = Host("double", "2025.07d", "MeshLab_64bit_dp", "filter_spectral")
HOSTS = (SINGLE, DOUBLE)


@dataclass(frozen=True)
class Change:
    """What was done to one file, or would be.

    Attributes
    ----------
    host
        The MeshLab that reads the file.
    path
        Where the file is, or was.
    done
        "installed", "replaced", "up to date", "removed" or "not there".
    """

    host: Host
    path: Path
    done: str


@dataclass(frozen=True)
class FoundMeshLab:
    """A MeshLab on this machine.

    Attributes
    ----------
    program
        Its executable.
    version
        As it tells it; None when it did not.
    host
        Which of the plugins it takes; None for other versions than 2025.07.
    """

    program: Path
    version: str | None
    host: Host | None


def extra_plugins_folder(
    host: Host, platform: str = sys.platform, environment: Mapping[str, str] = os.environ
) -> Path:
    """Tell the folder of this user's from which a MeshLab reads extra plugins.

    Parameters
    ----------
    host
        The kind of MeshLab.
    platform
        As `sys.platform` names it.
    environment
        Variables that say where the user's data is.

    Returns
    -------
    Path
        The folder, which need not exist: Qt's AppDataLocation of MeshLab, and below it a folder of
        MeshLab's version.

    Raises
    ------
    PluginError
        When the environment does not say where the user's data is.
    """
    if platform == "win32":
        data = _folder_of(environment, "APPDATA")
    elif platform == "darwin":
        data = _folder_of(environment, "HOME") / "Library" / "Application Support"
    elif environment.get("XDG_DATA_HOME"):
        data = Path(environment["XDG_DATA_HOME"])
    else:
        data = _folder_of(environment, "HOME") / ".local" / "share"
    return data / "VCG" / host.application / "MeshLabExtraPlugins" / host.version


def library_name(host: Host, platform: str = sys.platform) -> str:
    """Tell the file name of the plugin for a MeshLab."""
    return f"{host.plugin}.dll" if platform == "win32" else f"lib{host.plugin}.so"


def install(dry_run: bool = False) -> list[Change]:
    """Copy the plugins of both precisions to where MeshLab finds them at its next start.

    Parameters
    ----------
    dry_run
        Change nothing, only tell what would be done.

    Returns
    -------
    list of Change
        One for each precision.

    Raises
    ------
    PluginError
        When this package lacks a plugin, or a folder cannot be written to.
    """
    return [_install(host, dry_run) for host in HOSTS]


def uninstall(dry_run: bool = False) -> list[Change]:
    """Take away what `install` has put there.

    Parameters
    ----------
    dry_run
        Change nothing, only tell what would be done.

    Returns
    -------
    list of Change
        One for each precision.

    Raises
    ------
    PluginError
        When a file cannot be removed.
    """
    return [_uninstall(host, dry_run) for host in HOSTS]


def find_meshlab() -> FoundMeshLab | None:
    """Look for MeshLab where programs are, and ask it for its version."""
    program = next((path for path in _usual_places() if path.is_file()), None)
    if program is None:
        return None
    version = _version_of(program)
    host = next((host for host in HOSTS if host.version == version), None)
    return FoundMeshLab(program, version, host)


def _folder_of(environment: Mapping[str, str], variable: str) -> Path:
    folder = environment.get(variable)
    if not folder:
        raise PluginError(f"the environment variable {variable}, of the user's folder, is not set")
    return Path(folder)


def _install(host: Host, dry_run: bool) -> Change:
    source = _PLUGINS / library_name(host)
    target = extra_plugins_folder(host) / source.name
    if not source.is_file():
        raise PluginError(
            f"no plugin at {source}: install this package again: "
            "pip install --force-reinstall ./python"
        )
    with _problems_told(target):
        there = target.read_bytes() if target.exists() else None
        if there == source.read_bytes():
            return Change(host, target, "up to date")
        if not dry_run:
            _copy_whole(source, target)
    return Change(host, target, "installed" if there is None else "replaced")


def _copy_whole(source: Path, target: Path) -> None:
    """Copy so that there is never half a file, nor a changed one under a running MeshLab."""
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".", dir=target.parent) as scratch:
        copy = Path(shutil.copy(source, scratch))
        copy.replace(target)


def _uninstall(host: Host, dry_run: bool) -> Change:
    target = extra_plugins_folder(host) / library_name(host)
    with _problems_told(target):
        if not target.exists():
            return Change(host, target, "not there")
        if not dry_run:
            target.unlink()
    return Change(host, target, "removed")


@contextmanager
def _problems_told(target: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise PluginError(
            f"{target} cannot be changed: {error.strerror}. It must be a file of yours; on Windows "
            "close MeshLab first"
        ) from error


def _usual_places() -> Iterator[Path]:
    for name in ("meshlab", "MeshLab"):
        if on_path := shutil.which(name):
            yield Path(on_path)
    if sys.platform == "win32":
        programs = os.environ.get("PROGRAMFILES", r"C:\Program Files")
        yield Path(programs) / "VCG" / "MeshLab" / "meshlab.exe"
    elif sys.platform == "darwin":
        for folder in sorted(Path("/Applications").glob("MeshLab*.app"), reverse=True):
            yield folder / "Contents" / "MacOS" / "meshlab"


def _version_of(program: Path) -> str | None:
    try:
        done = subprocess.run(
            [program, "--version"],
            capture_output=True,
            text=True,
            errors="replace",
            timeout=_VERSION_SECONDS,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired):
        return None
    told = re.search(r"^MeshLab (\S+)", done.stdout, re.MULTILINE)
    return told[1] if told else None
