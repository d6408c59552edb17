"""`progress=`: True shows it, a function gets it and may cancel, in all functions alike."""

from __future__ import annotations

import io
import sys
import tempfile
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import meshlab_spectral
import numpy as np
import pytest
import pyvista
from meshlab_spectral import Cancelled, OptionError, filter_mesh
from meshlab_spectral.filters import progress

_SPHERE = pyvista.Icosphere(nsub=4)
V, F = np.array(_SPHERE.points, dtype=float), np.array(_SPHERE.regular_faces)


def of_file(function: Callable[..., Any], **more: Any) -> Any:
    """Call a function that writes a file."""
    with tempfile.TemporaryDirectory() as folder:
        source, target = Path(folder) / "in.ply", Path(folder) / "out.ply"
        pyvista.PolyData.from_regular_faces(V, F).save(source)
        return function(source, target, **more)


CALLS: dict[str, Callable[..., Any]] = {
    "filter_mesh": lambda **more: filter_mesh(V, F, **more),
    "filter_file": lambda **more: of_file(meshlab_spectral.filter_file, **more),
    "denoise_file": lambda **more: of_file(meshlab_spectral.denoise_file, **more),
    "denoise_mesh": lambda **more: meshlab_spectral.denoise_mesh(V, F, **more),
    "filter_scalars": lambda **more: meshlab_spectral.filter_scalars(V, F, V, **more),
    "filter_colors": lambda **more: meshlab_spectral.filter_colors(V, F, np.abs(V), **more),
    "geometry_spectrum": lambda **more: meshlab_spectral.geometry_spectrum(V, F, **more),
    "measure_artefacts": lambda **more: meshlab_spectral.measure_artefacts(V, F, 0.5, **more),
    "surface_texture": lambda **more: meshlab_spectral.surface_texture(V, F, waviness=0.5, **more),
    "laplacian": lambda **more: meshlab_spectral.laplacian(V, F, **more),
    "manifold_harmonics": lambda **more: meshlab_spectral.manifold_harmonics(V, F, 20, **more),
    "shape_dna": lambda **more: meshlab_spectral.shape_dna(V, F, 20, **more),
}
each_call = pytest.mark.parametrize("call", CALLS)


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_every_function_that_has_a_progress_is_tried() -> None:
    import inspect

    public = (getattr(meshlab_spectral, name) for name in meshlab_spectral.__all__)
    functions = (one for one in public if inspect.isfunction(one))
    taking = {one.__name__ for one in functions if "progress" in inspect.signature(one).parameters}
    assert taking == CALLS.keys()


@each_call
def test_true_shows_a_bar_on_a_terminal(call: str, monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    CALLS[call](progress=True)
    assert "0:00:0" in terminal.getvalue()


@each_call
def test_a_function_that_returns_false_cancels(call: str) -> None:
    with pytest.raises(Cancelled):
        CALLS[call](progress=lambda stage, fraction: False)


def test_a_comparison_of_numpy_cancels_as_well() -> None:
    with pytest.raises(Cancelled):
        CALLS["filter_mesh"](progress=lambda stage, fraction: np.float64(fraction) > 2.0)


def test_what_is_no_function_is_refused() -> None:
    with pytest.raises(OptionError, match="progress = 'bar': pass True, or a function"):
        CALLS["filter_mesh"](progress="bar")


@each_call
def test_false_and_none_show_nothing(call: str, capfd: pytest.CaptureFixture[str]) -> None:
    CALLS[call](progress=False)
    CALLS[call](progress=None)
    assert capfd.readouterr() == ("", "")


def test_elsewhere_lines_tell_it_every_few_seconds(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    filter_mesh(V, F, progress=True)
    assert capsys.readouterr().err == ""  # it was done before the first
    monkeypatch.setattr(progress, "SECONDS_BETWEEN", 0.0)
    filter_mesh(V, F, progress=True)
    assert capsys.readouterr().err.startswith("[0 s] ")


def test_without_rich_a_terminal_gets_lines(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setattr(progress, "SECONDS_BETWEEN", 0.0)
    monkeypatch.setattr(
        progress, "find_spec", lambda name: None if name == "rich" else find_spec(name)
    )
    filter_mesh(V, F, progress=True)
    assert terminal.getvalue().startswith("[0 s] ")


def test_a_notebook_gets_one_output_that_is_updated(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without IPython in the test environment, a stand-in for what is called of it."""
    shown: list[str] = []
    place = SimpleNamespace(update=shown.append)
    package, module = ModuleType("IPython"), ModuleType("IPython.display")
    package.get_ipython = lambda: SimpleNamespace(kernel="a kernel")  # type: ignore[attr-defined]
    module.HTML = str  # type: ignore[attr-defined]
    module.display = lambda html, display_id: shown.append(html) or place  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "IPython", package)
    monkeypatch.setitem(sys.modules, "IPython.display", module)
    filter_mesh(V, F, progress=True)
    assert "starting" in shown[0]
    assert "done" in shown[-1]
    with pytest.raises(OptionError):
        filter_mesh(V, F, laplacian="uniform", feature_size=-1, progress=True)
