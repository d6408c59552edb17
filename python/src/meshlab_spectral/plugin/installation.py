"""Install the plugin into MeshLab, for the current user."""

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
from meshlab_spectral.plugin.loading import library_name

_PLUGINS = Path(__file__).parent
_VERSION_SECONDS = 20


@dataclass(frozen=True)
class Host:
    """One of the two builds of MeshLab 2025.07; each loads only plugins of its own precision."""

    # Precision of its coordinates, "single" or "double". The plugin computes in double for both.
    precision: str
    version: str  # version that MeshLab reports
    application: str  # Qt application name, which also names MeshLab's data folder
    plugin: str  # base name of the plugin's library, without platform prefix and extension


SINGLE = Host("single", "2025.07", "MeshLab_64bit_fp", "filter_spectral_float")
DOUBLE = Host("double", "2025.07d", "MeshLab_64bit_dp", "filter_spectral")
HOSTS = (SINGLE, DOUBLE)


@dataclass(frozen=True)
class Change:
    """A change to one file, made or, in a dry run, only planned."""

    host: Host  # the MeshLab that loads the file
    path: Path  # the file
    done: str  # "installed", "replaced", "up to date", "removed" or "not there"


@dataclass(frozen=True)
class FoundMeshLab:
    """A MeshLab on this machine."""

    program: Path  # its executable
    version: str | None  # version it reports; None if it reports none
    host: Host | None  # its build; None if it is not MeshLab 2025.07


def extra_plugins_folder(
    host: Host, platform: str = sys.platform, environment: Mapping[str, str] = os.environ
) -> Path:
    """Return the folder from which a MeshLab loads extra plugins for the current user.

    It is named after MeshLab's version in its AppDataLocation (Qt), and need not exist. `platform`
    is as in `sys.platform`; raises PluginError when the variables of the environment do not locate
    the user's data folder.
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


def install(dry_run: bool = False) -> list[Change]:
    """Copy the plugins of both precisions to where MeshLab looks for them when it starts.

    A dry run changes nothing, and only returns what would be done. Raises PluginError when a plugin
    is missing from this package, or a folder is not writable.
    """
    return [_install(host, dry_run) for host in HOSTS]


def uninstall(dry_run: bool = False) -> list[Change]:
    """Remove what `install` has copied; parameter, result and errors are those of `install`."""
    return [_uninstall(host, dry_run) for host in HOSTS]


def find_meshlab(
    platform: str = sys.platform, environment: Mapping[str, str] = os.environ
) -> FoundMeshLab | None:
    """Look for MeshLab on the path, then where its installer puts it, and query its version.

    `platform` and `environment` are those of `extra_plugins_folder`.
    """
    places = _usual_places(platform, environment)
    program = next((path for path in places if path.is_file()), None)
    if program is None:
        return None
    version = _version_of(program)
    host = next((host for host in HOSTS if host.version == version), None)
    return FoundMeshLab(program, version, host)


def _folder_of(environment: Mapping[str, str], variable: str) -> Path:
    folder = environment.get(variable)
    if not folder:
        raise PluginError(
            f"the environment variable {variable}, which locates your data folder, is not set"
        )
    return Path(folder)


def _install(host: Host, dry_run: bool) -> Change:
    source = _PLUGINS / library_name(host.plugin)
    target = extra_plugins_folder(host) / source.name
    if not source.is_file():
        raise PluginError(
            f"no plugin at {source}: install this package again: "
            "pip install --force-reinstall ./python"
        )
    with _as_plugin_error(target):
        there = target.read_bytes() if target.exists() else None
        if there == source.read_bytes():
            return Change(host, target, "up to date")
        if not dry_run:
            _copy_whole(source, target)
    return Change(host, target, "installed" if there is None else "replaced")


def _copy_whole(source: Path, target: Path) -> None:
    """Copy atomically: no partial file, and a running MeshLab keeps the old one."""
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".", dir=target.parent) as scratch:
        copy = Path(shutil.copy(source, scratch))
        copy.replace(target)


def _uninstall(host: Host, dry_run: bool) -> Change:
    target = extra_plugins_folder(host) / library_name(host.plugin)
    with _as_plugin_error(target):
        if not target.exists():
            return Change(host, target, "not there")
        if not dry_run:
            target.unlink()
    return Change(host, target, "removed")


@contextmanager
def _as_plugin_error(target: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise PluginError(
            f"{target} cannot be changed: {error.strerror}. Check that you own the file; on "
            "Windows, close MeshLab first"
        ) from error


def _usual_places(platform: str, environment: Mapping[str, str]) -> Iterator[Path]:
    for name in ("meshlab", "MeshLab"):
        if on_path := shutil.which(name, path=environment.get("PATH")):
            yield Path(on_path)
    if platform == "win32":
        programs = environment.get("PROGRAMFILES", r"C:\Program Files")
        yield Path(programs) / "VCG" / "MeshLab" / "meshlab.exe"
    elif platform == "darwin":
        for applications in (
            Path("/Applications"),
            _folder_of(environment, "HOME") / "Applications",
        ):
            for folder in sorted(applications.glob("MeshLab*.app"), reverse=True):
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
    match = re.search(r"^MeshLab (\S+)", done.stdout, re.MULTILINE)
    return match[1] if match else None
