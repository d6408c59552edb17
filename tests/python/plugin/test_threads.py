"""How many threads the plugin computes with."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from meshlab_spectral import FilterError, OptionError, filter_mesh, set_threads, threads
from meshlab_spectral.plugin.limits import THREADS, threads_each
from meshlab_spectral.workers.process import NO_LIMITS
from meshlab_spectral.workers.processes import Processes
from shared_types import Decimated


class NotStartedError(Exception):
    """Raised instead of starting a process."""


@pytest.fixture(autouse=True)
def _restored(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(THREADS, raising=False)


def test_results_have_the_same_bits_for_every_number_of_threads(decimated: Decimated) -> None:
    V, F = decimated("bunny.obj", 20000)
    results = []
    for count in (1, 2, 3, None):
        set_threads(count)
        assert threads() == count
        results.append(filter_mesh(V, F, feature_size="4%")[0])
    for other in results[1:]:
        np.testing.assert_array_equal(results[0], other)


def test_an_invalid_number_of_threads_is_refused(
    monkeypatch: pytest.MonkeyPatch, decimated: Decimated
) -> None:
    with pytest.raises(OptionError, match="threads = 0: give a number"):
        set_threads(0)
    V, F = decimated("cow.obj", 2000)
    wrong: Any
    for wrong in (-1, 1.5, "a", 1 << 40):
        words = f"threads = {wrong}: give a number of threads"
        with pytest.raises(OptionError, match=words):
            set_threads(wrong)
        with pytest.raises(OptionError, match=words):
            filter_mesh(V, F, threads=wrong)
    for value in ("0", "-3", "many", ""):
        monkeypatch.setenv(THREADS, value)
        with pytest.raises(FilterError, match=f"{THREADS} = {value}: give a number of threads"):
            filter_mesh(V, F)
        with pytest.raises(OptionError, match=f"{THREADS} = {value}: give a number of threads"):
            threads()


def test_processes_share_the_threads(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    set_threads(8)
    assert [threads_each(count) for count in (1, 2, 3, 8, 50)] == [8, 4, 2, 1, 1]
    environments: list[dict[str, str]] = []

    def start(*_: object, env: dict[str, str], **__: object) -> None:
        environments.append(env)
        raise NotStartedError

    monkeypatch.setattr("meshlab_spectral.workers.process.subprocess.Popen", start)
    with pytest.raises(NotStartedError), Processes(4, NO_LIMITS, tmp_path).one():
        pass
    assert [environment[THREADS] for environment in environments] == ["2"]
