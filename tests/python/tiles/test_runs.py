"""What is refused, what an interrupted or failed run leaves, and how it goes on."""

from __future__ import annotations

import math
import os
import re
import resource
import shutil
import signal
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import command, python, succeeded
from meshlab_spectral import FilterOptions, MemoryLimitError, MeshFileError
from meshlab_spectral.errors import FilterError, OptionError, ProcessDiedError, UntiledError
from meshlab_spectral.files.request import Request
from meshlab_spectral.tiles import whole_or_tiles
from meshlab_spectral.tiles.halo import kernel_tails, reach_of
from meshlab_spectral.tiles.plan import Workspace
from meshlab_spectral.tiles.run import filter_in_tiles
from meshlab_spectral.tiles.survey import Lengths
from meshlab_spectral.tiles.tile import filter_tile
from meshlab_spectral.workers import memory
from meshlab_spectral.workers.process import MeshLabProcess, from_text
from tiled_meshes import bumpy_torus, write_ply

SMALL = FilterOptions(feature_size="6e", passes=1)


def _ignore(*_: object) -> None:
    pass


@pytest.fixture
def source(tmp_path: Path) -> Path:
    path = tmp_path / "mesh.ply"
    write_ply(path, *bumpy_torus(60))
    return path


def test_tails_of_a_gaussian_are_known() -> None:
    x = np.linspace(0, 16, (1 << 17) + 1)
    tails = kernel_tails(2.0 ** (-(x**2) / 2))
    s = math.sqrt(math.log(2)) / (2 * math.pi)
    for h in (0.25, 0.375, 0.5):
        density = math.exp(-((h / s) ** 2) / 2) / math.sqrt(2 * math.pi)
        exact = 2 * (s * density - h * math.erfc(h / s / math.sqrt(2)) / 2)
        assert exact < tails[int(h * 32)] < 1.2 * exact


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        ({"laplacian": "uniform"}, "uniform"),
        ({"spectrum": "truncated"}, "truncated"),
        ({"response": "ideal"}, "ideal"),
        ({"basis_update": "full"}, "full"),
        ({"preserve_volume": True}, "preserve_volume"),
        ({"result": "details"}, "details"),
        ({"filter_type": "high-pass"}, "stop_gain = 1"),
        ({"filter_type": "custom", "transfer_function": "96e:2, 6e:1"}, "gain of the largest"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_a_filter_that_is_not_local_is_refused_with_the_reason(
    options: dict[str, Any], reason: str
) -> None:
    with pytest.raises(UntiledError, match=reason):
        reach_of(FilterOptions(**options), Lengths(1.0, 0.001, 1.0))


def test_every_option_is_known_to_be_local_or_refused() -> None:
    local = """filter_type feature_size power pass_gain stop_gain transfer_function band_width
        response order selected steps tolerance passes basis_update conformal_share boundary
        crease_angle max_displacement weight"""
    refused = "spectrum basis_size reinject_residual laplacian preserve_volume result"
    assert {*local.split(), *refused.split()} == {*vars(FilterOptions())}, "see require_local"


def test_a_halo_that_does_not_fit_is_refused(
    source: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("meshlab_spectral.tiles.run.workers_for_tiles", lambda: (1, 152 * 2**20))
    wide = FilterOptions(feature_size="30%", response="butterworth")
    for tiles in (0, 8):
        with pytest.raises(UntiledError, match=r"reaches .* far"):
            filter_in_tiles(source, tmp_path / "out.ply", wide, _ignore, tiles, _ignore)
    assert not (tmp_path / "out.ply").exists()


@pytest.mark.parametrize("content", ["text", "polygons", "other"])
def test_a_file_that_cannot_be_read_in_parts_is_refused(content: str, tmp_path: Path) -> None:
    head = "ply\nformat {} 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
    head += "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    path = tmp_path / ("mesh.off" if content == "other" else "mesh.ply")
    if content == "text":
        path.write_text(head.format("ascii") + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n")
    else:
        vertices = np.eye(4, 3, dtype="<f4").tobytes()
        corners = b"\4" + np.arange(4, dtype="<i4").tobytes()
        path.write_bytes(head.format("binary_little_endian").encode() + vertices + corners)
    with pytest.raises(UntiledError, match=r"convert |split them"):
        filter_in_tiles(path, path.with_stem("out"), SMALL, _ignore, 4, _ignore)


def test_tiles_take_over_where_memory_is_refused(
    source: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object, **__: object) -> dict[str, Any]:
        raise MemoryLimitError("needs more memory")

    monkeypatch.setattr(whole_or_tiles, "write_in_child", refuse)
    target, lines = tmp_path / "out.ply", list[str]()

    def run(options: FilterOptions, **others: Any) -> dict[str, Any]:
        request = Request(source, options)
        return whole_or_tiles.filter_file(request, target, _ignore, overwrite=True, **others)

    report = run(SMALL, tiles=0, tell=lines.append)
    assert report["tiles"] >= 2
    assert lines == [
        f"mesh.ply is processed in {report['tiles']} tiles, as it does not fit in memory as a whole"
    ]
    with pytest.raises(MemoryLimitError, match="nor can it be filtered in tiles"):
        run(FilterOptions(preserve_volume=True), tiles=0, tell=_ignore)
    with pytest.raises(MemoryLimitError, match=r"needs more memory$"):
        run(SMALL, tiles=None, tell=_ignore)


@pytest.mark.parametrize("given", [100 << 20, 160 << 20])
def test_the_memory_that_tiles_are_said_to_need_is_enough(
    given: int, source: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(memory, "machine_memory", lambda: given)
    run = partial(filter_in_tiles, source, tmp_path / "out.ply", SMALL, _ignore, 0, _ignore)
    with pytest.raises(UntiledError, match=r"more free memory") as refused:
        run()
    assert "smaller feature_size" not in str(refused.value)  # no tile fits, however small
    (needed,) = re.findall(r"a machine with (\d+)MB", str(refused.value))
    monkeypatch.setattr(memory, "machine_memory", lambda: int(needed) << 20)
    assert run()["tiles"] >= 2


def _interrupted(source: Path, target: Path, options: FilterOptions = SMALL) -> None:
    """Begin a run in eight tiles, and interrupt it after three."""

    def interrupt(stage: str, fraction: float | None) -> None:
        if stage.startswith("tile 3"):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        filter_in_tiles(source, target, options, interrupt, 8, _ignore)


def _is_as_never_interrupted(source: Path, target: Path, options: FilterOptions = SMALL) -> bool:
    """Go on with a run; whether its output is that of a run in one go, and nothing else is left."""
    fresh = target.with_stem("fresh")
    filter_in_tiles(source, target, options, _ignore, 8, _ignore)
    filter_in_tiles(source, fresh, options, _ignore, 8, _ignore)
    assert {path.name for path in target.parent.iterdir()} == {source.name, target.name, fresh.name}
    return target.read_bytes() == fresh.read_bytes()


def test_an_interrupted_run_goes_on(source: Path, tmp_path: Path) -> None:
    target = tmp_path / "out.ply"
    folder = tmp_path / ".out.ply.tiles"
    _interrupted(source, target)
    assert not target.exists()
    done = {path.name: path.stat().st_mtime_ns for path in folder.glob("*.json")}
    assert 3 <= len(done) - 1 < 8
    stages = list[str]()

    def look(stage: str, fraction: float | None) -> None:
        stages.append(stage)
        now = {name: (folder / name).stat().st_mtime_ns for name in done}
        assert now == done

    filter_in_tiles(source, target, SMALL, look, 8, _ignore)
    assert not any("dividing" in stage for stage in stages)
    assert sum(stage.startswith("tile") for stage in stages) == 8 - (len(done) - 1)
    assert _is_as_never_interrupted(source, target)


def test_a_run_with_other_options_begins_anew(source: Path, tmp_path: Path) -> None:
    target = tmp_path / "out.ply"
    _interrupted(source, target)
    other = FilterOptions(feature_size="8e", passes=1)
    assert _is_as_never_interrupted(source, target, other)


def test_a_killed_worker_loses_its_tile_alone(
    source: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target, send = tmp_path / "out.ply", MeshLabProcess._send

    def send_and_kill(process: MeshLabProcess, line: str) -> None:
        send(process, line)
        if from_text(line)["tile"] == 5:
            os.kill(process.pid, signal.SIGKILL)

    target.write_bytes(b"before")
    with monkeypatch.context() as patch:
        patch.setattr(MeshLabProcess, "_send", send_and_kill)
        with pytest.raises(ProcessDiedError, match=r"tile 6 of 8: .*SIGKILL.*goes on"):
            filter_in_tiles(source, target, SMALL, _ignore, 8, _ignore)
    assert target.read_bytes() == b"before"
    assert not (tmp_path / ".out.ply.tiles" / "5.json").exists()
    assert _is_as_never_interrupted(source, target)


def test_a_tile_of_a_run_that_is_over_writes_nothing(source: Path, tmp_path: Path) -> None:
    _interrupted(source, tmp_path / "out.ply")
    folder = tmp_path / ".out.ply.tiles"
    tile = next(tile for tile in range(8) if not (folder / f"{tile}.json").exists())
    before = {path.name for path in folder.iterdir()}

    def begin_another(stage: str, fraction: float | None) -> None:
        work = Workspace(folder)
        work.begin(replace(work.plan(), stamp=[0, 0]))

    with pytest.raises(MeshFileError, match="another run has begun"):
        filter_tile(folder, tile, {"passes": 1}, begin_another)
    assert {path.name for path in folder.iterdir()} == before


def test_a_failed_tile_is_named_and_the_others_stay(tmp_path: Path) -> None:
    V, F = bumpy_torus(60)
    source, target = tmp_path / "mesh.ply", tmp_path / "out.ply"
    write_ply(source, V, np.vstack([F, [[0, 0, 1]]]))
    target.write_bytes(b"before")
    cotangent = FilterOptions(feature_size="6e", passes=1, laplacian="cotangent")
    with pytest.raises(FilterError, match=r"tile . of 8: .*no area.*goes on"):
        filter_in_tiles(source, target, cotangent, _ignore, 8, _ignore)
    assert target.read_bytes() == b"before"
    assert (tmp_path / ".out.ply.tiles").is_dir()


def test_space_is_asked_for_first(
    source: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        "shutil.disk_usage",
        lambda _: shutil._ntuple_diskusage(10**9, 10**9, 1000),  # type: ignore[attr-defined]
    )
    with pytest.raises(MeshFileError, match="GB of free space") as caught:
        filter_in_tiles(source, tmp_path / "out.ply", SMALL, _ignore, 8, _ignore)
    assert caught.value.code == "disk_full"
    assert not (tmp_path / ".out.ply.tiles").exists()  # nothing can go on from it


def test_an_empty_selection_is_refused(source: Path, tmp_path: Path) -> None:
    selected = FilterOptions(feature_size="6e", passes=1, selected=True)
    with pytest.raises(OptionError, match="nothing is selected"):
        filter_in_tiles(source, tmp_path / "out.ply", selected, _ignore, 8, _ignore)
    assert not (tmp_path / ".out.ply.tiles").exists()


@pytest.mark.parametrize("room", [20_000, 100_000], ids=["tiles", "output"])
def test_a_full_disk_loses_nothing(room: int, source: Path, tmp_path: Path) -> None:
    target = tmp_path / "out.ply"
    target.write_bytes(b"before")
    arguments = [
        "filter",
        source,
        target,
        "--overwrite",
        "--tiles",
        8,
        "--feature-size",
        "6e",
        "--passes",
        1,
    ]
    full = python(
        "-m",
        "meshlab_spectral.cli",
        *arguments,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (room, room)),
    )
    assert full.returncode == 1, full.stderr
    assert "make room" in full.stderr
    assert target.read_bytes() == b"before"
    done = succeeded(*arguments)
    assert "is processed in 8 tiles" in done.stderr
    assert _is_as_never_interrupted(source, target)


@pytest.mark.parametrize("word", ["1", "many", "0", "-3"])
def test_a_number_of_tiles_is_checked(word: str, source: Path, tmp_path: Path) -> None:
    done = command("filter", source, tmp_path / "out.ply", "--tiles", word)
    assert done.returncode == 2
    assert "auto, off or a number from 2" in done.stderr
