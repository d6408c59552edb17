"""The command `meshlab-spectral install`: what it installs where, what it prints and refuses."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path, PurePosixPath

import pytest
from meshlab_spectral import PluginError
from meshlab_spectral.plugin import installation
from meshlab_spectral.plugin.installation import (
    DOUBLE,
    HOSTS,
    SINGLE,
    extra_plugins_folder,
    find_meshlab,
)
from meshlab_spectral.plugin.loading import library_name

Command = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture
def home(tmp_path: Path) -> Path:
    folder = tmp_path / "home of Zoë"
    folder.mkdir()
    return folder


@pytest.fixture
def programs(tmp_path: Path) -> Path:
    """The only folder in which programs are looked for."""
    folder = tmp_path / "programs"
    folder.mkdir()
    return folder


@pytest.fixture
def command(home: Path, programs: Path) -> Command:
    def run(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
        variables = {k: v for k, v in os.environ.items() if k != "XDG_DATA_HOME"}
        return subprocess.run(
            [sys.executable, "-m", "meshlab_spectral.cli", "install", *arguments],
            env={**variables, "HOME": str(home), "PATH": str(programs), **environment},
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )

    return run


def installed(data: Path) -> dict[str, Path]:
    """Where the plugins must be below a user's data folder, by precision."""
    return {
        "single": data
        / "VCG/MeshLab_64bit_fp/MeshLabExtraPlugins/2025.07/libfilter_spectral_float.so",
        "double": data / "VCG/MeshLab_64bit_dp/MeshLabExtraPlugins/2025.07d/libfilter_spectral.so",
    }


def files_below(folder: Path) -> list[Path]:
    return sorted(path for path in folder.rglob("*") if path.is_file())


def packaged(path: Path) -> bytes:
    return (Path(installation.__file__).parent / path.name).read_bytes()


def meshlab_that_tells(folder: Path, version: str, name: str = "meshlab") -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    program = folder / name
    program.write_text(f"#!/bin/sh\n[ \"$1\" = --version ] && echo '{version}'\n")
    program.chmod(0o755)
    return program


def test_install_puts_the_plugin_of_each_precision_where_its_meshlab_looks(
    command: Command, home: Path
) -> None:
    done = command()
    assert done.returncode == 0, done.stderr
    places = installed(home / ".local/share")
    assert files_below(home) == sorted(places.values())
    for precision, path in places.items():
        assert path.read_bytes() == packaged(path)
        assert f"{precision} precision: {path} installed" in done.stdout


def test_a_custom_data_folder_is_respected(command: Command, home: Path, tmp_path: Path) -> None:
    data = tmp_path / "data"
    assert command(XDG_DATA_HOME=str(data)).returncode == 0
    assert files_below(data) == sorted(installed(data).values())
    assert files_below(home) == []


def test_a_second_install_changes_nothing_and_says_so(command: Command, home: Path) -> None:
    command()
    times = {path: path.stat().st_mtime_ns for path in files_below(home)}
    done = command()
    assert done.stdout.count("up to date") == 2
    assert {path: path.stat().st_mtime_ns for path in files_below(home)} == times


def test_an_older_plugin_is_replaced_while_a_program_may_have_it_open(
    command: Command, home: Path
) -> None:
    path = installed(home / ".local/share")["double"]
    path.parent.mkdir(parents=True)
    path.write_bytes(b"older")
    with path.open("rb") as open_elsewhere:
        done = command()
        assert f"{path} replaced" in done.stdout
        assert open_elsewhere.read() == b"older"
    assert path.read_bytes() == packaged(path)


def test_uninstall_removes_only_its_own_files(command: Command, home: Path) -> None:
    command()
    places = installed(home / ".local/share")
    other = places["single"].with_name("libfilter_other.so")
    other.write_bytes(b"of somebody else")
    done = command("--uninstall")
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("removed") == 2
    assert files_below(home) == [other]
    assert command("--uninstall").stdout.count("not there") == 2


@pytest.mark.parametrize("arguments", [(), ("--uninstall",)])
def test_a_dry_run_prints_the_same_and_changes_nothing(
    arguments: tuple[str, ...], command: Command, home: Path
) -> None:
    if arguments:
        command()
    before = files_below(home)
    dry = command(*arguments, "--dry-run")
    assert dry.returncode == 0, dry.stderr
    assert dry.stdout.count("would be") == 2
    assert files_below(home) == before
    real = command(*arguments)
    assert dry.stdout.replace("would be ", "") == real.stdout


@pytest.mark.parametrize(
    ("told", "expected"),
    [
        ("MeshLab 2025.07", "is MeshLab 2025.07, of single precision"),
        ("MeshLab 2025.07d", "is MeshLab 2025.07d, of double precision"),
        ("MeshLab 2023.12", "Warning: .* is MeshLab 2023.12, which cannot load the plugin"),
        ("nothing of the kind", "does not report its version"),
    ],
)
def test_the_version_of_a_meshlab_on_the_path_is_checked(
    told: str, expected: str, command: Command, programs: Path
) -> None:
    program = meshlab_that_tells(programs, told)
    done = command()
    assert done.returncode == 0, done.stderr
    (line,) = [line for line in done.stdout.splitlines() if str(program) in line]
    assert re.search(expected, line), line


@pytest.mark.parametrize(
    ("platform", "place"),
    [
        ("win32", "Program Files/VCG/MeshLab/meshlab.exe"),
        ("darwin", "Applications/MeshLab2025.07.app/Contents/MacOS/meshlab"),
    ],
)
def test_a_meshlab_is_found_on_the_path_or_where_its_installer_puts_it(
    platform: str, place: str, home: Path, programs: Path
) -> None:
    environment = {
        "PATH": str(programs),
        "HOME": str(home),
        "PROGRAMFILES": str(home / "Program Files"),
    }
    assert find_meshlab(platform, environment) is None
    path = home / place
    meshlab_that_tells(path.parent, "MeshLab 2025.07", path.name)
    found = find_meshlab(platform, environment)
    assert found is not None
    assert (found.program, found.host) == (path, SINGLE)
    on_path = meshlab_that_tells(programs, "MeshLab 2025.07d")
    found = find_meshlab(platform, environment)
    assert found is not None
    assert (found.program, found.host) == (on_path, DOUBLE)


def test_without_a_meshlab_the_required_versions_are_named(command: Command) -> None:
    assert "No MeshLab was found; the plugin is for MeshLab 2025.07 or 2025.07d." in (
        command().stdout
    )


def test_a_folder_that_cannot_be_made_is_named(command: Command, home: Path) -> None:
    (home / ".local").write_text("a file where a folder should be")
    done = command()
    assert done.returncode == 1
    assert str(installed(home / ".local/share")["single"]) in done.stderr
    assert "Error:" in done.stderr


def test_a_package_without_a_plugin_names_the_remedy(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(installation, "_PLUGINS", tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path))
    with pytest.raises(PluginError, match="pip install"):
        installation.install()


# By Qt's rules for AppDataLocation.
@pytest.mark.parametrize(
    ("platform", "environment", "data"),
    [
        ("linux", {"HOME": "/home/zoe"}, "/home/zoe/.local/share"),
        ("linux", {"HOME": "/home/zoe", "XDG_DATA_HOME": "/data"}, "/data"),
        ("darwin", {"HOME": "/Users/zoe"}, "/Users/zoe/Library/Application Support"),
        ("win32", {"APPDATA": "C:/Users/zoe/AppData/Roaming"}, "C:/Users/zoe/AppData/Roaming"),
    ],
)
def test_the_folders_follow_the_rules_of_the_system(
    platform: str, environment: dict[str, str], data: str
) -> None:
    folders = [extra_plugins_folder(host, platform, environment) for host in HOSTS]
    assert [PurePosixPath(folder.as_posix()) for folder in folders] == [
        PurePosixPath(data, "VCG/MeshLab_64bit_fp/MeshLabExtraPlugins/2025.07"),
        PurePosixPath(data, "VCG/MeshLab_64bit_dp/MeshLabExtraPlugins/2025.07d"),
    ]


@pytest.mark.parametrize(
    ("platform", "names"),
    [
        ("linux", ["libfilter_spectral_float.so", "libfilter_spectral.so"]),
        ("darwin", ["libfilter_spectral_float.so", "libfilter_spectral.so"]),
        ("win32", ["filter_spectral_float.dll", "filter_spectral.dll"]),
    ],
)
def test_the_file_names_are_those_of_plugins_on_each_system(
    platform: str, names: list[str]
) -> None:
    assert [library_name(host.plugin, platform) for host in (SINGLE, DOUBLE)] == names


def test_a_user_without_a_folder_is_told_the_variable() -> None:
    with pytest.raises(PluginError, match="HOME"):
        extra_plugins_folder(SINGLE, "linux", {})
