"""MeshLab loads the plugin that a user has installed, and reports one that it cannot load."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from desktop import Desktop
from meshlab import MeshLab
from meshlab_spectral.plugin.installation import DOUBLE, SINGLE, extra_plugins_folder
from meshlab_spectral.plugin.loading import library_name

SMOOTHING = "Smoothing, Fairing and Deformation"
MEASURES = "Quality Measure and Computations"
ENTRIES = [
    (SMOOTHING, "Spectral Denoise"),
    (SMOOTHING, "Spectral Equalizer"),
    (SMOOTHING, "Spectral Filter (Fractional)"),
    (SMOOTHING, "Spectral Filter: Vertex Quality"),
    (SMOOTHING, "Spectral Filter: Vertex Color"),
    (MEASURES, "Spectral Artefacts"),
    (MEASURES, "Manifold Harmonics"),
    (MEASURES, "Geometry Spectrum"),
]


def installed_plugin(home: Path) -> Path:
    return extra_plugins_folder(SINGLE, "linux", {"HOME": str(home)}) / library_name(SINGLE.plugin)


def maps_of(meshlab: MeshLab) -> str:
    return Path(f"/proc/{meshlab.pid}/maps").read_text()


def test_the_installed_plugin_is_loaded_without_an_error_and_its_filters_are_in_the_menus(
    meshlab: MeshLab, home: Path, desktop: Desktop
) -> None:
    assert desktop.inside(installed_plugin(home)) in maps_of(meshlab)
    assert meshlab.plugin_error() is None
    for path in ENTRIES:
        entry = meshlab.menu_entry("Filters", *path)
        assert entry is not None, path
        assert entry.enabled


def test_without_the_plugin_its_menu_entry_is_missing(
    start: Callable[[Path], MeshLab], bunny: Path
) -> None:
    assert start(bunny).menu_entry("Filters", *ENTRIES[0]) is None


def test_a_damaged_plugin_is_reported_at_startup(
    install: Callable[[], None], home: Path, start: Callable[[Path], MeshLab], bunny: Path
) -> None:
    install()
    plugin = installed_plugin(home)
    plugin.write_bytes(plugin.read_bytes()[:5000])
    error = start(bunny).plugin_error()
    assert error is not None
    assert plugin.name in error


def test_a_plugin_of_the_other_precision_is_reported_at_startup(
    install: Callable[[], None], home: Path, start: Callable[[Path], MeshLab], bunny: Path
) -> None:
    install()
    name = library_name(DOUBLE.plugin)
    double = extra_plugins_folder(DOUBLE, "linux", {"HOME": str(home)}) / name
    plugin = installed_plugin(home).with_name(name)
    double.rename(plugin)
    error = start(bunny).plugin_error()
    assert error is not None
    assert plugin.name in error
