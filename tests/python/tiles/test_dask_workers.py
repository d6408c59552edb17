"""Tiles on the workers of a Dask cluster that was started by hand."""

from __future__ import annotations

import os
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import psutil
import pytest
from batches import wait_until
from commands import assert_fails, command, succeeded
from dask_clusters import dask_cluster, meshlab_processes
from meshlab_spectral import BatchError, FilterOptions, MeshFileError
from meshlab_spectral.errors import FilterError, MeshError
from meshlab_spectral.tiles import tile_jobs
from meshlab_spectral.tiles.run import filter_in_tiles
from meshlab_spectral.workers import cluster as cluster_module
from tiled_meshes import bumpy_torus, write_ply

SMALL = FilterOptions(feature_size="6e", passes=1)
OPTIONS = ["--tiles", 8, "--feature-size", "6e", "--steps", 2]


def _ignore(*_: object) -> None:
    pass


@pytest.fixture(scope="module")
def started(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, list[psutil.Process]]]:
    """A cluster: its address, and its workers."""
    with dask_cluster(tmp_path_factory.mktemp("cluster")) as (address, (_, *workers)):
        yield address, [psutil.Process(worker.pid) for worker in workers]


@pytest.fixture
def cluster(started: tuple[str, list[psutil.Process]]) -> str:
    return started[0]


@pytest.fixture
def source(tmp_path: Path) -> Path:
    path = tmp_path / "in" / "mesh.ply"
    path.parent.mkdir()
    (tmp_path / "out").mkdir()
    write_ply(path, *bumpy_torus(60))
    return path


@pytest.fixture
def target(tmp_path: Path) -> Path:
    return tmp_path / "out" / "mesh.ply"


@pytest.mark.parametrize(
    "arguments",
    [
        ["filter", "--tiles", 8, "--feature-size", "6e"],  # in several rounds
        ["filter", "--feature-size", "6e", "--steps", 2],
        ["denoise", "--tiles", 4],
    ],
    ids=["filter", "any number", "denoise"],
)
def test_a_cluster_gives_the_same_bytes_as_this_machine(
    arguments: list[object], cluster: str, source: Path, target: Path
) -> None:
    name, *options = arguments
    local = target.with_stem("local")
    tiles = [] if "--tiles" in options else ["--tiles", 2]
    succeeded(name, source, local, *options, *tiles)
    done = succeeded(name, source, target, *options, "--scheduler", cluster)
    assert f"tiles by the workers at {cluster}" in done.stderr
    assert target.read_bytes() == local.read_bytes() != source.read_bytes()
    assert {path.name for path in target.parent.iterdir()} == {target.name, local.name}


def test_a_worker_killed_in_the_middle_of_a_tile_changes_nothing(
    source: Path, target: Path, tmp_path: Path
) -> None:
    local, stages = target.with_stem("local"), list[str]()
    filter_in_tiles(source, local, SMALL, _ignore, 8, _ignore)
    with dask_cluster(tmp_path) as (address, (_, nanny, _other)):
        victim = psutil.Process(nanny.pid)

        def kill(stage: str, fraction: float | None) -> None:
            if not stage.startswith("tile"):
                return
            stages.append(stage)
            if stage == "tile 1":  # whatever the victim has been given, it does not finish
                wait_until(lambda: bool(meshlab_processes([victim])))
                os.kill(meshlab_processes([victim])[0].pid, signal.SIGSTOP)
            if stage == "tile 6":  # a worker holds two at most
                for process in [victim, *victim.children(recursive=True)]:
                    process.kill()

        filter_in_tiles(source, target, SMALL, kill, 8, _ignore, scheduler=address)
        assert not victim.is_running() or victim.status() == psutil.STATUS_ZOMBIE
    assert stages == [f"tile {number}" for number in range(1, 9)]
    assert target.read_bytes() == local.read_bytes()


def test_a_meshlab_process_killed_on_a_worker_is_replaced(
    started: tuple[str, list[psutil.Process]], source: Path, target: Path
) -> None:
    local = target.with_stem("local")
    filter_in_tiles(source, local, SMALL, _ignore, 8, _ignore)
    address, workers = started

    def kill(stage: str, fraction: float | None) -> None:
        if stage == "tile 2":
            for process in meshlab_processes(workers):
                process.kill()

    filter_in_tiles(source, target, SMALL, kill, 8, _ignore, scheduler=address)
    assert target.read_bytes() == local.read_bytes()


def test_an_interrupted_run_goes_on_with_or_without_the_cluster(
    cluster: str, source: Path, target: Path
) -> None:
    local, stages = target.with_stem("local"), list[str]()
    filter_in_tiles(source, local, SMALL, _ignore, 8, _ignore)

    def interrupt(stage: str, fraction: float | None) -> None:
        if stage.startswith("tile 3"):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        filter_in_tiles(source, target, SMALL, interrupt, 8, _ignore, scheduler=cluster)
    assert not target.exists()
    filter_in_tiles(source, target, SMALL, lambda stage, _: stages.append(stage), 8, _ignore)
    assert not any("dividing" in stage for stage in stages)
    assert sum(stage.startswith("tile") for stage in stages) <= 5
    assert target.read_bytes() == local.read_bytes()


def _hiding(folder: Path) -> list[str]:
    """Words before a command to which another folder is mounted there; skips where forbidden."""
    words = ["unshare", "--user", "--map-root-user", "--mount", "sh", "-c"]
    words += ['mount -t tmpfs none "$0" && exec "$@"', str(folder)]
    if subprocess.run([*words, "true"], capture_output=True, check=False).returncode:
        pytest.skip("this system lets users mount nothing")
    return words


@pytest.mark.parametrize("hidden", ["in", "out"])
def test_what_a_worker_does_not_see_is_named_before_anything_is_done(
    hidden: str, source: Path, target: Path, tmp_path: Path
) -> None:
    missing = {"in": source, "out": target.with_name(f".{target.name}.tiles")}[hidden]
    with dask_cluster(tmp_path, 1, _hiding(tmp_path / hidden)) as (address, _):
        done = command("filter", source, target, *OPTIONS, "--scheduler", address)
    assert_fails(done, 1, f"does not see {missing}: keep input and output in folders that all")
    assert not list(tmp_path.rglob("*.faces"))
    assert not target.exists()


def test_a_worker_that_joins_later_says_what_it_does_not_see(tmp_path: Path) -> None:
    with pytest.raises(MeshFileError, match=r"the worker on .* does not see .*none"):
        tile_jobs.check_seen(str(tmp_path), str(tmp_path / "none"))


def test_a_failed_tile_is_named_by_its_error(cluster: str, target: Path, source: Path) -> None:
    V, F = bumpy_torus(60)
    write_ply(source, V, np.vstack([F, [[0, 0, 1]]]))
    cotangent = FilterOptions(feature_size="6e", passes=1, laplacian="cotangent")
    with pytest.raises(MeshError, match=r"tile . of 8: .*no area.*goes on") as caught:
        filter_in_tiles(source, target, cotangent, _ignore, 8, _ignore, scheduler=cluster)
    assert caught.value.code


def test_a_tile_that_kills_every_worker_is_named(
    source: Path, target: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def die(*_: object) -> None:
        os.kill(os.getpid(), signal.SIGKILL)

    monkeypatch.setattr(cluster_module, "_run", die)
    with (
        dask_cluster(tmp_path) as (address, _),
        pytest.raises(FilterError, match=r"tile . of 8: \d workers that had it were ended"),
    ):
        filter_in_tiles(source, target, SMALL, _ignore, 8, _ignore, scheduler=address)


def test_tiles_fit_the_memory_of_the_workers(
    cluster: str, source: Path, target: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster_module, "_memory", lambda dask_worker: 152 * 2**20)
    with pytest.raises(MeshFileError, match=r"give the workers \d+ MiB each"):
        filter_in_tiles(source, target, SMALL, _ignore, 2, _ignore, scheduler=cluster)


def test_a_cluster_that_is_not_there_is_reported(
    source: Path, target: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster_module, "_SECONDS_TO_CONNECT", 0.5)
    with pytest.raises(BatchError, match="no Dask scheduler"):
        filter_in_tiles(source, target, SMALL, _ignore, 8, _ignore, scheduler="tcp://127.0.0.1:1")
    assert not list(target.parent.iterdir())


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (["--tiles", "off"], "leave out tiles = off, or the scheduler"),
        (["--memory", "4GB"], "leave out --memory"),
        (["--box", "0,0,0,1,1,1"], "leave out box, or the scheduler"),
    ],
    ids=lambda value: value[0] if isinstance(value, list) else "",
)
def test_what_excludes_a_scheduler_is_named(
    options: list[str], reason: str, source: Path, target: Path
) -> None:
    done = command("filter", source, target, "--scheduler", "tcp://127.0.0.1:1", *options)
    assert done.returncode in (1, 2)
    assert reason in done.stderr


def test_a_dry_run_asks_the_workers_how_many_tiles_there_are(
    cluster: str, source: Path, target: Path
) -> None:
    done = succeeded("filter", source, target, "--dry-run", "--scheduler", cluster)
    assert "in 2 tiles" in done.stdout
    assert not list(target.parent.iterdir())
