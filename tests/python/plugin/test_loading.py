"""Loading the plugin: once or twice, and every way in which it can fail."""

from __future__ import annotations

import importlib.metadata
import subprocess
from pathlib import Path

import meshlab_spectral
import pymeshlab
import pytest
from commands import python
from helpers import FILTER
from meshlab_spectral import PluginError
from meshlab_spectral.plugin import loading


def run_python(code: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run code in a fresh interpreter, in which no plugin has been loaded."""
    return python("-c", code, **environment)


def test_load_binds_the_filter_as_a_method_of_mesh_set() -> None:
    done = run_python(
        "import pymeshlab, meshlab_spectral\n"
        f"assert not hasattr(pymeshlab.MeshSet, '{FILTER}')\n"
        "meshlab_spectral.load()\n"
        f"print(pymeshlab.MeshSet.{FILTER}.__name__)\n"
    )
    assert done.stdout.strip() == FILTER, done.stderr


def test_loading_twice_changes_nothing() -> None:
    meshlab_spectral.load()
    filters, method = pymeshlab.filter_list(), getattr(pymeshlab.MeshSet, FILTER)
    meshlab_spectral.load()
    assert pymeshlab.filter_list() == filters
    assert getattr(pymeshlab.MeshSet, FILTER) is method


def test_load_binds_methods_also_when_the_plugin_was_loaded_by_hand() -> None:
    done = run_python(
        "import pymeshlab, meshlab_spectral\n"
        "from meshlab_spectral.plugin.loading import plugin_path\n"
        "pymeshlab.load_plugin(str(plugin_path()))\n"
        "meshlab_spectral.load()\n"
        f"print(pymeshlab.MeshSet.{FILTER}.__name__)\n"
    )
    assert done.stdout.strip() == FILTER, done.stderr


@pytest.mark.parametrize("name", loading.FILTERS.values())
def test_after_a_filter_has_failed_another_mesh_can_be_loaded(name: str, samples: Path) -> None:
    done = run_python(
        "import gc, pymeshlab, meshlab_spectral\n"
        "meshlab_spectral.load()\n"
        "for _ in range(20):\n"
        "    points = pymeshlab.MeshSet()\n"
        "    points.add_mesh(pymeshlab.Mesh([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]))\n"
        "    try:\n"
        f"        points.{name}()\n"
        "    except pymeshlab.PyMeshLabException as error:\n"
        "        assert 'no faces' in str(error)\n"
        "    del points\n"
        "    gc.collect()\n"
        f"    pymeshlab.MeshSet().load_new_mesh({str(samples / 'cow.obj')!r})\n"
        "print('loaded')\n"
    )
    assert done.stdout == "loaded\n", done.stderr


def test_the_environment_variable_chooses_the_plugin(tmp_path: Path) -> None:
    copy = tmp_path / "libfilter_spectral_copy.so"
    copy.write_bytes(loading.plugin_path().read_bytes())
    done = run_python(
        "import pymeshlab, meshlab_spectral\n"
        "meshlab_spectral.load()\n"
        "pymeshlab.print_plugin_list()\n"
        "print(open('/proc/self/maps').read())\n",
        MESHLAB_SPECTRAL_PLUGIN=str(copy),
    )
    assert str(copy) in done.stdout, done.stderr


LOAD_AND_SHOW = (
    "import meshlab_spectral\n"
    "try: meshlab_spectral.load()\n"
    "except meshlab_spectral.PluginError as error: print(error)\n"
)


def test_a_missing_plugin_is_named_with_the_variable_that_asks_for_it(tmp_path: Path) -> None:
    missing = tmp_path / "nowhere.so"
    message = run_python(LOAD_AND_SHOW, MESHLAB_SPECTRAL_PLUGIN=str(missing)).stdout
    assert str(missing) in message
    assert "MESHLAB_SPECTRAL_PLUGIN" in message
    assert "unset it" in message


def test_a_plugin_missing_in_the_package_is_named_with_the_way_to_install_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    missing = tmp_path / "libfilter_spectral.so"
    monkeypatch.setattr(loading, "_INSTALLED", missing)
    monkeypatch.delenv("MESHLAB_SPECTRAL_PLUGIN", raising=False)
    with pytest.raises(PluginError, match="pip install") as error:
        loading.plugin_path()
    assert str(missing) in str(error.value)


def test_a_damaged_plugin_is_refused_with_its_path(tmp_path: Path) -> None:
    damaged = tmp_path / "libfilter_spectral.so"
    damaged.write_bytes(loading.plugin_path().read_bytes()[:5000])
    message = run_python(LOAD_AND_SHOW, MESHLAB_SPECTRAL_PLUGIN=str(damaged)).stdout
    assert str(damaged) in message
    assert "not a plugin that MeshLab can load" in message


def test_a_plugin_for_another_meshlab_is_refused_with_the_version_it_needs(tmp_path: Path) -> None:
    other = tmp_path / "libfilter_spectral.so"
    code = loading.plugin_path().read_bytes()
    assert b"2025.07d" in code
    other.write_bytes(code.replace(b"2025.07d", b"2023.12d"))
    message = run_python(LOAD_AND_SHOW, MESHLAB_SPECTRAL_PLUGIN=str(other)).stdout
    assert "built for another version of MeshLab" in message
    assert "2025.07" in message


def test_a_plugin_of_the_other_precision_is_refused_with_the_precision_it_needs(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # MeshLab's own words; a plugin of the other precision is not available here.
    def refuse(path: str) -> None:
        raise pymeshlab.PyMeshLabException(
            "libfilter_spectral.so has different floating point precision from the running MeshLab"
            " version."
        )

    monkeypatch.setattr(pymeshlab, "filter_list", list)
    monkeypatch.setattr(pymeshlab, "load_plugin", refuse)
    with pytest.raises(PluginError, match="double-precision build"):
        meshlab_spectral.load()


def test_another_pymeshlab_is_refused_with_the_version_to_install(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(pymeshlab, "filter_list", list)
    monkeypatch.setattr(importlib.metadata, "version", lambda name: "2023.12.post3")
    with pytest.raises(PluginError, match=r"pip install pymeshlab==2025\.7\.post1") as error:
        meshlab_spectral.load()
    assert "2023.12.post3" in str(error.value)


def test_an_absent_pymeshlab_is_reported_with_the_way_to_install_it() -> None:
    done = run_python("import sys\nsys.modules['pymeshlab'] = None\n" + LOAD_AND_SHOW)
    assert "pip install 'meshlab-spectral[meshlab]'" in done.stdout, done.stderr


FILTER_AND_SHOW = (
    "import meshlab_spectral\n"
    "from meshlab_spectral.plugin.mesh_sets import call_filter, mesh_set_of\n"
    "import numpy as np\n"
    "try: call_filter(mesh_set_of(np.eye(3), np.array([[0, 1, 2]])), "
    f"{FILTER!r}, {{'boundary': 'fixed'}})\n"
    "except meshlab_spectral.PluginError as error: print(error)\n"
)


def test_warnings_are_never_those_of_another_copy_of_the_plugin(tmp_path: Path) -> None:
    copy = tmp_path / "libfilter_spectral_copy.so"
    copy.write_bytes(loading.plugin_path().read_bytes())
    by_hand = f"import pymeshlab\npymeshlab.load_plugin({str(copy)!r})\n"
    message = run_python(by_hand + FILTER_AND_SHOW).stdout
    assert str(loading.plugin_path()) in message
    assert "meshlab_spectral.load()" in message


def test_a_plugin_too_old_to_report_warnings_is_refused(tmp_path: Path) -> None:
    code = loading.plugin_path().read_bytes()
    name = b"meshlab_spectral_warnings"
    assert name in code
    old = tmp_path / "old.so"
    old.write_bytes(code.replace(name, b"meshlab_spectral_nothing_"))
    message = run_python(FILTER_AND_SHOW, MESHLAB_SPECTRAL_PLUGIN=str(old)).stdout
    assert str(old) in message
    assert "older than this package" in message
