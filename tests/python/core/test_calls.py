"""Progress, cancelling, errors and the interpreter's end, of calls of the package's module."""

from __future__ import annotations

import os
import signal
import time
from typing import Any

import numpy as np
import pytest
from commands import python
from meshlab_spectral import _core, errors
from meshlab_spectral.errors import (
    Cancelled,
    FilterError,
    MemoryLimitError,
    MeshError,
    OptionError,
    SpectralError,
)

FILTER = "apply_coord_spectral_filter_fractional"
LONG = {"steps": 1000, "basis_update": "full"}


@pytest.fixture(scope="module")
def mesh(decimated: Any) -> tuple[Any, Any]:
    V, F = decimated("bunny.obj")
    return np.ascontiguousarray(V), F.astype(np.int32)


def test_progress_rises_to_the_end_in_the_calling_thread(mesh: Any) -> None:
    reports: list[tuple[str, float]] = []
    _core.apply(FILTER, *mesh, {"steps": 30}, progress=lambda *report: reports.append(report))
    fractions = [fraction for _, fraction in reports]
    assert fractions == sorted(fractions)
    assert all(0 <= fraction <= 1 for fraction in fractions)
    assert all(isinstance(stage, str) and stage for stage, _ in reports)


def test_progress_cancels_by_returning_false(mesh: Any) -> None:
    began = time.monotonic()
    with pytest.raises(Cancelled) as caught:
        _core.apply(FILTER, *mesh, LONG, progress=lambda stage, fraction: False)
    assert caught.value.code == "cancelled"
    assert time.monotonic() - began < 30  # alone on a machine 0.06


def test_what_progress_raises_is_passed_on(mesh: Any) -> None:
    def fail(stage: str, fraction: float) -> None:
        raise LookupError(stage)

    with pytest.raises(LookupError):
        _core.apply(FILTER, *mesh, LONG, progress=fail)


@pytest.mark.parametrize(
    ("change", "options", "kind", "code", "words"),
    [
        (lambda V, F: (V[:0], F[:0]), {}, MeshError, "empty_mesh", "give a mesh with some"),
        (lambda V, F: (V, F[:0]), {}, MeshError, "no_faces", "no faces"),
        (lambda V, F: (V, F + 10**6), {}, MeshError, "bad_index", "refers to vertex"),
        (lambda V, F: (V * np.nan, F), {}, MeshError, "not_finite", "not finite"),
        (lambda V, F: (V * [1, 0, 0], F), {}, MeshError, "no_area", "zero area"),
        (lambda V, F: (V, F), {"steps": -1}, OptionError, "option_out_of_range", "steps = -1"),
        (lambda V, F: (V, F), {"steps": 1.5}, OptionError, "option_out_of_range", "an integer"),
        (lambda V, F: (V, F), {"stepz": 1}, OptionError, "option_out_of_range", "stepz"),
        (lambda V, F: (V, F), {"laplacian": "flat"}, OptionError, "option_out_of_range", "uniform"),
        (lambda V, F: (V, F), {"feature_size": "5 m"}, OptionError, "option_out_of_range", "5 m"),
        (lambda V, F: (V, F), {"order": None}, OptionError, "option_out_of_range", "order = None"),
    ],
)
def test_errors_have_a_class_a_code_and_advice(
    change: Any, options: Any, kind: type[FilterError], code: str, words: str, mesh: Any
) -> None:
    V, F = change(*mesh)
    with pytest.raises(kind, match=words) as caught:
        _core.apply(FILTER, np.ascontiguousarray(V), np.ascontiguousarray(F), options)
    assert caught.value.code == code
    assert isinstance(caught.value, FilterError)


def test_a_limit_of_the_memory_is_told_with_the_largest_basis(mesh: Any) -> None:
    _core.set_memory_limit(1)
    try:
        with pytest.raises(MemoryLimitError) as caught:
            _core.apply(FILTER, *mesh, {"feature_size": "15%"})
    finally:
        _core.set_memory_limit(0)
    assert caught.value.code == "out_of_memory"


def test_every_error_of_the_package_is_a_spectral_error() -> None:
    classes = [one for one in vars(errors).values() if isinstance(one, type)]
    assert all(issubclass(one, SpectralError) for one in classes)


def test_arrays_of_other_shapes_are_refused(mesh: Any) -> None:
    V, F = mesh
    for wrong in ((V[:, :2], F), (V, F[:, :2]), (V[0], F)):
        with pytest.raises(TypeError):
            _core.apply(FILTER, *wrong, {})


def test_other_numbers_of_rows_than_vertices_are_refused(mesh: Any) -> None:
    V, F = mesh
    for n in (len(V) - 1, len(V) + 1):
        with pytest.raises(ValueError, match="vertex"):
            _core.apply(FILTER, V, F, {"selected": True}, selected=np.ones(n, bool))
        with pytest.raises(ValueError, match="vertex"):
            _core.apply(FILTER, V, F, {"weight": "vertex quality"}, values=np.ones((n, 1)))
    with pytest.raises(TypeError):
        _core.apply(FILTER, V, F, {}, gain=np.ones((5, 1)))
    with pytest.raises(ValueError, match="Laplacian"):
        _core.laplacian(V, F, 3)


PROGRAM = """
import os, signal, threading, time
import numpy as np
from meshlab_spectral import _core
t = np.linspace(0, 2 * np.pi, 120, endpoint=False)
u, v = map(np.ravel, np.meshgrid(t, t))
V = np.column_stack([(2 + np.cos(v)) * np.cos(u), (2 + np.cos(v)) * np.sin(u), np.sin(v)])
i, j = map(np.ravel, np.meshgrid(np.arange(120), np.arange(120)))
at = lambda i, j: (j % 120) * 120 + i % 120
F = np.vstack([np.column_stack([at(i, j), at(i + 1, j), at(i + 1, j + 1)]),
               np.column_stack([at(i, j), at(i + 1, j + 1), at(i, j + 1)])]).astype(np.int32)
def run(steps=1000):
    _core.apply("apply_coord_spectral_filter_fractional", V, F, {"steps": steps})
"""
INTERRUPTED = """
def interrupt():
    time.sleep(0.5)
    os.kill(os.getpid(), signal.SIGINT)
threading.Thread(target=interrupt, daemon=True).start()
try:
    run()
except KeyboardInterrupt:
    print("stopped")
"""
ENDING = """
threading.Thread(target=run, daemon=True).start()
time.sleep(0.5)
print("stopped")
"""
# Threads that call again once they are cancelled, or write a file.
CALLING_AGAIN = """
text = b"1.5 2.5 3.5\\n" * 1000
places = np.arange(1000) * 12
before, after = np.tile([1.5, 2.5, 3.5], (1000, 1)), np.ones((1000, 3))
def write():
    _core.write_patched(text, 0, [(places, 0, before, after, 9)], lambda piece: None)
def repeat(task):
    while True:
        try:
            task()
        except Exception:
            pass
for task in [lambda: run(1), run, write] * 2:
    threading.Thread(target=repeat, args=[task], daemon=True).start()
time.sleep(0.5)
print("stopped")
"""
FORKED = """
threading.Thread(target=run, daemon=True).start()
time.sleep(0.2)
if child := os.fork():
    print("stopped" if os.waitpid(child, 0)[1] == 0 else "failed")
else:
    signal.alarm(60)
"""


@pytest.mark.parametrize("ending", [INTERRUPTED, ENDING, CALLING_AGAIN, FORKED])
@pytest.mark.skipif(os.name == "nt", reason="Windows has no signals to send")
def test_an_interrupt_and_the_interpreters_end_stop_a_run(ending: str) -> None:
    done = python(
        "-c",
        PROGRAM + ending,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    assert (done.returncode, done.stdout) == (0, "stopped\n")
