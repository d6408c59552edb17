"""The plugin's files as linked: for which MeshLab each is, and which symbols it needs of it.

The single-precision MeshLab is not on PyPI. What can be checked without it is checked here;
tests/gui loads the file into the program.
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pymeshlab
import pytest
from meshlab_spectral.plugin import installation
from meshlab_spectral.plugin.installation import DOUBLE, HOSTS, SINGLE, Host
from meshlab_spectral.plugin.loading import library_name

CORE_LIBRARY = Path(pymeshlab.__file__).parent / "lib" / "libmeshlab-common.so"
SCALARS = {SINGLE: "float", DOUBLE: "double"}
# Defined in other object files of every program, or left undefined on purpose.
OF_THE_COMPILER = {"_ITM_deregisterTMCloneTable", "_ITM_registerTMCloneTable", "__gmon_start__"}

each_host = pytest.mark.parametrize("host", HOSTS, ids=lambda host: host.precision)


def plugin_of(host: Host) -> Path:
    return Path(installation.__file__).parent / library_name(host.plugin)


def output_of(*command: object) -> str:
    return subprocess.run(
        [*map(str, command)], capture_output=True, text=True, check=True, timeout=60
    ).stdout


def symbols(library: Path, kind: str) -> set[str]:
    """Demangled symbols, "defined" or "undefined"; those of versioned libraries with an @."""
    lines = output_of("nm", "--dynamic", "--demangle", f"--{kind}-only", library).splitlines()
    return {re.sub(r"^[0-9a-f ]*[A-Za-z] ", "", line) for line in lines}


def asked_of_meshlab(host: Host) -> set[str]:
    undefined = symbols(plugin_of(host), "undefined")
    return {name for name in undefined if "@" not in name} - OF_THE_COMPILER


@each_host
def test_numbers_go_to_meshlab_in_its_own_precision(host: Host) -> None:
    constructors = [name for name in asked_of_meshlab(host) if "RichFloat::RichFloat(" in name]
    assert constructors
    for constructor in constructors:
        assert f"(QString const&, {SCALARS[host]}, " in constructor


@each_host
def test_only_the_double_plugin_is_for_the_double_version_of_meshlab(host: Host) -> None:
    assert (b"2025.07d" in plugin_of(host).read_bytes()) == (host is DOUBLE)


@each_host
def test_every_symbol_needed_of_meshlab_is_in_its_core_library(host: Host) -> None:
    # In the other precision the library has the same functions, except for their scalars.
    def in_double(name: str) -> str:
        return re.sub(r"\bfloat\b", "double", name)

    offered = {in_double(name) for name in symbols(CORE_LIBRARY, "defined")}
    asked = asked_of_meshlab(host)
    assert asked
    strange = {name for name in asked if in_double(name) not in offered}
    assert strange == set()


@each_host
def test_libraries_are_those_of_the_program_and_no_path_is_built_in(host: Host) -> None:
    dynamic = output_of("readelf", "--dynamic", "--wide", plugin_of(host))
    needed = set(re.findall(r"\(NEEDED\).*\[(.*)\]", dynamic))
    # Python hides what it has loaded from what it loads later; the program does not.
    assert ("libmeshlab-common.so" in needed) == (host is DOUBLE)
    others = needed - {"libmeshlab-common.so"}
    # The loader itself provides thread-local variables. muParser is inside.
    system = r"(lib(Qt5\w+|stdc\+\+|m|gcc_s|c|pthread)|ld-linux[\w-]*)\.so\."
    assert all(re.match(system, name) for name in others)
    assert "RPATH" not in dynamic
    assert "RUNPATH" not in dynamic


@each_host
def test_the_functions_for_python_can_be_found_by_name(host: Host) -> None:
    functions = {f"meshlab_spectral_{name}" for name in ("warnings", "summary", "error", "filters")}
    assert functions <= symbols(plugin_of(host), "defined")


def test_the_muparser_of_pymeshlab_is_the_only_shared_one() -> None:
    import_and_list = (
        "import meshlab_spectral, pathlib; from meshlab_spectral import _core;"
        "meshlab_spectral.load();"
        "print(pathlib.Path('/proc/self/maps').read_text())"
    )
    maps = output_of(sys.executable, "-c", import_and_list)
    used = {line.split()[-1] for line in maps.splitlines() if "libmuparser" in line}
    assert [Path(path).parent for path in used] == [CORE_LIBRARY.parent]
