"""How many workers a batch has, and how much memory they share."""

from __future__ import annotations

import os
from pathlib import Path

import psutil
import pytest
from meshlab_spectral.batch.task import run_job
from meshlab_spectral.workers import memory, opening


@pytest.fixture(autouse=True)
def group(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The files of a container's limits; none at first."""
    monkeypatch.setattr(memory, "_GROUP", tmp_path)
    monkeypatch.setattr(os, "cpu_count", lambda: 8)
    monkeypatch.setattr(psutil.Process, "cpu_affinity", lambda self: range(8), raising=False)
    (tmp_path / "cpu").mkdir()
    (tmp_path / "memory").mkdir()
    return tmp_path


def test_a_machine_is_used_whole() -> None:
    assert memory.processors() == 8
    assert memory.machine_memory() == psutil.virtual_memory().total


def test_only_processors_that_the_process_may_use_count(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(psutil.Process, "cpu_affinity", lambda self: [2, 5, 6])
    assert memory.processors() == 3
    monkeypatch.delattr(psutil.Process, "cpu_affinity")  # as on macOS
    assert memory.processors() == 8


@pytest.mark.parametrize(
    ("quota", "expected"),
    [("max 100000", 8), ("150000 100000", 2), ("1000 100000", 1), ("900000 100000", 8)],
)
def test_the_share_of_a_container_counts(quota: str, expected: int, group: Path) -> None:
    (group / "cpu.max").write_text(quota + "\n")
    assert memory.processors() == expected


def test_the_memory_of_a_container_counts(group: Path) -> None:
    (group / "memory.max").write_text("max\n")
    assert memory.machine_memory() == psutil.virtual_memory().total
    (group / "memory.max").write_text("1000000\n")
    assert memory.machine_memory() == 1000000


def test_older_containers_count(group: Path) -> None:
    (group / "cpu" / "cpu.cfs_quota_us").write_text("300000\n")
    (group / "cpu" / "cpu.cfs_period_us").write_text("100000\n")
    (group / "memory" / "memory.limit_in_bytes").write_text("2000000\n")
    assert memory.processors() == 3
    assert memory.machine_memory() == 2000000
    (group / "cpu" / "cpu.cfs_quota_us").write_text("-1\n")
    (group / "memory" / "memory.limit_in_bytes").write_text(f"{2**63 - 4096}\n")
    assert memory.processors() == 8
    assert memory.machine_memory() == psutil.virtual_memory().total


def test_workers_share_nine_tenths_of_the_memory(group: Path) -> None:
    (group / "memory.max").write_text(f"{10 * 2**30}\n")
    with opening.open_workers(run_job, count=3) as workers:
        processes = workers.do.args[0]  # type: ignore[attr-defined]
    assert processes.limits.memory == 3 * 2**30
    assert not processes.limits.replaces_environment
    with opening.open_workers(run_job, count=3, memory_limit=2**30) as workers:
        processes = workers.do.args[0]  # type: ignore[attr-defined]
    assert processes.limits.memory == 2**30
    assert processes.limits.replaces_environment


def test_without_a_place_for_temporary_files_the_remedy_is_named(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "none"))
    failing = opening.open_workers(run_job, count=1)
    with pytest.raises(opening.BatchError, match="set TMPDIR"), failing:
        pass
