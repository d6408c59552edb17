"""The command `meshlab-spectral filter`: results, messages, exit codes, outputs left whole."""

from __future__ import annotations

import json
import os
import pty
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pymeshlab
import pytest
from helpers import FILTER, diagonal, largest_distance, percent
from meshlab_spectral import FilterOptions

COMMAND = [sys.executable, "-m", "meshlab_spectral.cli"]
PRECIOUS = b"precious bytes of a file that was here before\n"


def command(*arguments: object, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*COMMAND, *map(str, arguments)],
        env={**os.environ, "COLUMNS": "200", **environment},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


def assert_fails(done: subprocess.CompletedProcess[str], code: int, *words: str) -> None:
    """The exit code, one message with these words, no traceback, nothing on standard output."""
    assert done.returncode == code, done.stderr
    assert done.stdout == ""
    assert "Traceback" not in done.stderr
    assert "LOG:" not in done.stderr
    for word in words:
        assert word in done.stderr
    if code == 1:
        assert len(done.stderr.splitlines()) == 1


def write_ply(path: Path, vertices: str, faces: str) -> Path:
    V, F = vertices.splitlines(), faces.splitlines()
    path.write_text(
        f"ply\nformat ascii 1.0\nelement vertex {len(V)}\nproperty float x\nproperty float y\n"
        f"property float z\nelement face {len(F)}\nproperty list uchar int vertex_indices\n"
        "end_header\n" + "".join(line + "\n" for line in V + F)
    )
    return path


def arrays_of(path: Path) -> tuple[Any, Any]:
    mesh_set = pymeshlab.MeshSet()
    mesh_set.load_new_mesh(str(path))
    mesh = mesh_set.current_mesh()
    return mesh.vertex_matrix().copy(), mesh.face_matrix().copy()


@pytest.fixture
def cow(samples: Path) -> Path:
    return samples / "cow.obj"


@pytest.fixture
def existing(tmp_path: Path) -> Iterator[Path]:
    """An output that was there before; it must be the only file left, byte for byte."""
    folder = tmp_path / "out"
    folder.mkdir()
    target = folder / "result.ply"
    target.write_bytes(PRECIOUS)
    yield target
    assert target.read_bytes() == PRECIOUS
    assert list(folder.iterdir()) == [target]


# --- what comes out -------------------------------------------------------------------------------


def test_output_is_what_the_filter_computes(cow: Path, tmp_path: Path) -> None:
    target = tmp_path / "cow.ply"
    done = command("filter", cow, target, "--feature-size", "8%", "--steps", 3)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    mesh_set = pymeshlab.MeshSet()
    mesh_set.load_new_mesh(str(cow))
    mesh_set.apply_filter(FILTER, feature_size=percent(8), steps=3)
    V, F = arrays_of(target)
    np.testing.assert_array_equal(V, mesh_set.current_mesh().vertex_matrix())
    np.testing.assert_array_equal(F, mesh_set.current_mesh().face_matrix())
    assert list(tmp_path.iterdir()) == [target]


def test_json_is_one_object_with_report_options_and_versions(cow: Path, tmp_path: Path) -> None:
    target = tmp_path / "cow.ply"
    done = command("filter", cow, target, "--json", "--feature-size", 0.15, "--steps", 2)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("\n") == 1
    record = json.loads(done.stdout)
    assert record["input"] == str(cow)
    assert record["output"] == str(target)
    expected = {**FilterOptions().as_dict(), "feature_size": "0.15", "steps": 2}
    assert record["options"] == expected
    assert record["report"]["feature_size"] == pytest.approx(0.15, rel=1e-6)
    assert record["report"]["step_sizes"] == [0.5, 0.5]
    assert record["report"]["max_displacement"] > 0
    assert record["versions"]["pymeshlab"] == "2025.7.post1"
    assert {"meshlab_spectral", "python"} <= record["versions"].keys()


def test_a_fixed_boundary_with_nothing_inside_is_a_warning(tmp_path: Path) -> None:
    source = write_ply(tmp_path / "triangle.ply", "0 0 0\n1 0 0\n0 1 0", "3 0 1 2")
    target = tmp_path / "out.ply"
    done = command("filter", source, target, "--boundary", "fixed")
    assert done.returncode == 0, done.stderr
    assert "nothing moved" in done.stderr
    assert "fixed boundary" in done.stdout
    np.testing.assert_array_equal(arrays_of(target)[0], arrays_of(source)[0])


def test_json_holds_the_eigenvalues_of_a_truncated_spectrum(cow: Path, tmp_path: Path) -> None:
    arguments = ["--spectrum", "truncated", "--basis-size", 50, "--steps", 1, "--json"]
    done = command("filter", cow, tmp_path / "cow.ply", *arguments, "--no-reinject-residual")
    record = json.loads(done.stdout)
    assert len(record["report"]["eigenvalues"]) >= 50
    assert record["options"]["reinject_residual"] is False


def test_every_option_reaches_the_filter(cow: Path, tmp_path: Path) -> None:
    options: dict[str, Any] = {
        "filter_type": "band-pass",
        "feature_size": "12%",
        "response": "butterworth",
        "order": 3,
        "band_width": 1.5,
        "pass_gain": 2.0,
        "stop_gain": 1.0,
        "power": 0.5,
        "steps": 2,
        "tolerance": "0.1%",
        "basis_update": "conformal",
        "conformal_share": 0.25,
        "spectrum": "truncated",
        "basis_size": 60,
        "reinject_residual": False,
        "laplacian": "cotangent",
        "boundary": "fixed",
    }
    assert options.keys() == FilterOptions().as_dict().keys()
    arguments: list[object] = []
    for name, value in options.items():
        option = name.replace("_", "-")
        if isinstance(value, bool):
            arguments.append(f"--{option}" if value else f"--no-{option}")
        else:
            arguments += [f"--{option}", value]
    target = tmp_path / "cow.ply"
    done = command("filter", cow, target, "--json", *arguments)
    assert json.loads(done.stdout)["options"] == options
    mesh_set = pymeshlab.MeshSet()
    mesh_set.load_new_mesh(str(cow))
    mesh_set.apply_filter(
        FILTER, **{**options, "feature_size": percent(12), "tolerance": percent(0.1)}
    )
    V, _ = arrays_of(target)
    np.testing.assert_array_equal(V, mesh_set.current_mesh().vertex_matrix())


def test_report_is_a_table_with_the_input_and_the_output_as_they_are_called(
    cow: Path, tmp_path: Path
) -> None:
    source = tmp_path / "[red] kühe.obj"
    shutil.copy(cow, source)
    done = command("filter", source, tmp_path / "[bold]öut.ply", "--steps", 1)
    assert done.returncode == 0, done.stderr
    assert "[red] kühe.obj -> [bold]öut.ply" in done.stdout
    for row in ("Feature size", "Largest displacement", "Area", "Volume", "Work"):
        assert row in done.stdout
    assert len(arrays_of(tmp_path / "[bold]öut.ply")[0]) == len(arrays_of(cow)[0])


@pytest.mark.parametrize("ending", [".ply", ".obj", ".stl", ".off"])
def test_every_usual_format_is_written(ending: str, cow: Path, tmp_path: Path) -> None:
    target = tmp_path / f"cow{ending}"
    assert command("filter", cow, target, "--steps", 1).returncode == 0
    V, F = arrays_of(target)
    assert len(F) == len(arrays_of(cow)[1])
    reference = tmp_path / "reference.ply"
    assert command("filter", cow, reference, "--steps", 1).returncode == 0
    if ending != ".stl":  # which has its vertices in another order
        expected, _ = arrays_of(reference)
        assert largest_distance(V, expected) < 1e-6 * diagonal(expected)


def test_colour_and_quality_are_in_the_output(samples: Path, tmp_path: Path) -> None:
    source, target = samples / "colored_airplane.ply", tmp_path / "airplane.ply"
    assert command("filter", source, target, "--steps", 1).returncode == 0
    meshes = []
    for path in (source, target):
        mesh_set = pymeshlab.MeshSet()
        mesh_set.load_new_mesh(str(path))
        meshes.append(mesh_set)
    before, after = (mesh_set.current_mesh() for mesh_set in meshes)
    np.testing.assert_array_equal(before.vertex_color_matrix(), after.vertex_color_matrix())
    np.testing.assert_array_equal(before.vertex_scalar_array(), after.vertex_scalar_array())


def test_material_and_texture_of_an_obj_appear_beside_it_under_their_names(
    samples: Path, tmp_path: Path
) -> None:
    target = tmp_path / "bunny.obj"
    arguments = ("filter", samples / "bunny10k_textured.obj", target, "--steps", 1)
    for _ in range(2):  # the second run replaces its own files
        done = command(*arguments)
        assert done.returncode == 0, done.stderr
        names = sorted(path.name for path in tmp_path.iterdir())
        assert names == ["TextureDouble_A.png", "bunny.obj", "bunny.obj.mtl"]
    assert "mtllib ./bunny.obj.mtl" in target.read_text()
    assert "map_Kd TextureDouble_A.png" in (tmp_path / "bunny.obj.mtl").read_text()
    mesh_set = pymeshlab.MeshSet()
    mesh_set.load_new_mesh(str(target))
    assert mesh_set.current_mesh().has_wedge_tex_coord()
    assert list(mesh_set.current_mesh().textures()) == ["TextureDouble_A.png"]


def test_a_texture_in_a_folder_keeps_its_place(samples: Path, tmp_path: Path) -> None:
    source = textured_bunny(samples, tmp_path / "in", "maps/skin.png")
    target = tmp_path / "out" / "bunny.obj"
    target.parent.mkdir()
    assert command("filter", source, target, "--steps", 1).returncode == 0
    assert (target.parent / "maps" / "skin.png").is_file()
    assert "map_Kd maps/skin.png" in (target.parent / "bunny.obj.mtl").read_text()


def test_the_texture_of_the_input_is_left_alone_when_the_output_lies_beside_it(
    samples: Path, tmp_path: Path
) -> None:
    source = textured_bunny(samples, tmp_path / "in", "skin.png")
    skin = source.parent / "skin.png"
    before = skin.read_bytes()
    assert command("filter", source, source.parent / "new.obj", "--steps", 1).returncode == 0
    assert skin.read_bytes() == before
    assert "map_Kd skin.png" in (source.parent / "new.obj.mtl").read_text()


def test_a_texture_outside_of_the_folder_is_never_written(samples: Path, tmp_path: Path) -> None:
    source = textured_bunny(samples, tmp_path / "in", "../skin.png")
    target = tmp_path / "out" / "bunny.obj"
    target.parent.mkdir()
    assert command("filter", source, target, "--steps", 1).returncode == 0
    names = sorted(path.name for path in target.parent.iterdir())
    assert names == ["bunny.obj", "bunny.obj.mtl"]


def test_a_foreign_file_in_the_place_of_a_texture_is_not_replaced(
    samples: Path, existing: Path, tmp_path: Path
) -> None:
    source = textured_bunny(samples, tmp_path / "in", "skin.png")
    foreign = existing.parent / "skin.png"
    foreign.write_bytes(PRECIOUS)
    done = command("filter", source, existing, "--steps", 1)
    assert_fails(done, 1, "skin.png", "folder of its own")
    assert foreign.read_bytes() == PRECIOUS
    foreign.unlink()


def textured_bunny(samples: Path, folder: Path, texture: str) -> Path:
    """Copy pymeshlab's textured bunny; its texture gets the given path."""
    place = folder / texture
    place.parent.mkdir(parents=True, exist_ok=True)
    folder.mkdir(exist_ok=True)
    shutil.copy(samples / "TextureDouble_A.png", place)
    material = (samples / "bunny10k_textured.mtl").read_text()
    (folder / "bunny10k_textured.mtl").write_text(material.replace("TextureDouble_A.png", texture))
    return Path(shutil.copy(samples / "bunny10k_textured.obj", folder))


def test_an_existing_output_is_replaced_and_keeps_its_permissions(
    cow: Path, tmp_path: Path
) -> None:
    target = tmp_path / "cow.ply"
    target.write_bytes(PRECIOUS)
    target.chmod(0o640)
    assert command("filter", cow, target, "--steps", 1).returncode == 0
    assert len(arrays_of(target)[0]) == len(arrays_of(cow)[0])
    assert target.stat().st_mode & 0o777 == 0o640


def test_a_symbolic_link_as_output_stays_a_link(cow: Path, tmp_path: Path) -> None:
    real, link = tmp_path / "real.ply", tmp_path / "link.ply"
    link.symlink_to(real)
    assert command("filter", cow, link, "--steps", 1).returncode == 0
    assert link.is_symlink()
    assert real.is_file()


def test_pip_installs_the_command_under_its_name() -> None:
    installed = Path(sys.executable).with_name("meshlab-spectral")
    done = subprocess.run(
        [installed, "--version"], capture_output=True, text=True, timeout=60, check=True
    )
    assert done.stdout.startswith("meshlab-spectral ")


def test_help_names_every_option_and_the_exit_codes() -> None:
    done = command("filter", "--help")
    assert done.returncode == 0
    for name in FilterOptions().as_dict():
        assert f"--{name.replace('_', '-')}" in done.stdout
    assert "130 interrupted" in done.stdout
    assert "--debug" not in done.stdout


def test_version_names_the_package_and_pymeshlab() -> None:
    done = command("--version")
    assert done.returncode == 0
    assert re.fullmatch(r"meshlab-spectral \d+\.\d+\.\d+, pymeshlab 2025\.7\.post1\n", done.stdout)


# --- what goes wrong: exit code 1 -----------------------------------------------------------------


def test_a_missing_input_is_named(existing: Path, tmp_path: Path) -> None:
    missing = tmp_path / "no such.ply"
    assert_fails(command("filter", missing, existing), 1, str(missing), "does not exist")


def test_a_folder_as_input_is_refused(existing: Path, tmp_path: Path) -> None:
    assert_fails(command("filter", tmp_path, existing), 1, "is a folder")


@pytest.mark.parametrize("ending", [".ply", ".obj", ".stl", ".off"])
@pytest.mark.parametrize("content", ["", "this is no mesh\n"], ids=["empty", "text"])
def test_a_broken_input_is_refused_with_advice(
    content: str, ending: str, existing: Path, tmp_path: Path
) -> None:
    broken = tmp_path / f"broken{ending}"
    broken.write_text(content)
    assert_fails(command("filter", broken, existing), 1, str(broken), "damaged")


def test_a_cut_off_input_is_refused(cow: Path, existing: Path, tmp_path: Path) -> None:
    whole, cut = tmp_path / "whole.ply", tmp_path / "cut.ply"
    command("filter", cow, whole, "--steps", 1)
    cut.write_bytes(whole.read_bytes()[:20_000])
    assert_fails(command("filter", cut, existing), 1, str(cut), "damaged")


def test_an_input_that_is_no_mesh_format_is_refused_with_formats(
    existing: Path, tmp_path: Path
) -> None:
    text = tmp_path / "notes.txt2"
    text.write_text("notes\n")
    assert_fails(command("filter", text, existing), 1, ".txt2", ".ply")


def test_an_empty_mesh_is_refused(existing: Path, tmp_path: Path) -> None:
    assert_fails(command("filter", write_ply(tmp_path / "m.ply", "", ""), existing), 1, "empty")


def test_a_point_cloud_is_refused_with_a_way_to_a_surface(existing: Path, tmp_path: Path) -> None:
    cloud = write_ply(tmp_path / "cloud.ply", "0 0 0\n1 0 0\n0 1 0", "")
    assert_fails(command("filter", cloud, existing), 1, "point cloud", "Surface Reconstruction")


def test_a_basis_as_large_as_the_mesh_is_refused(cow: Path, existing: Path) -> None:
    arguments = ("--spectrum", "truncated", "--basis-size", 5000)
    assert_fails(command("filter", cow, existing, *arguments), 1, "2904", "spectrum = full")


def test_vertices_that_are_no_numbers_do_not_get_in_the_way(tmp_path: Path) -> None:
    """MeshLab drops them when it reads a file; the rest is filtered."""
    vertices = "0 0 0\n1 0 0\n0 1 0\n0 0 1\nnan 0 0"
    faces = "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n3 0 1 4"
    source, target = write_ply(tmp_path / "nan.ply", vertices, faces), tmp_path / "out.ply"
    done = command("filter", source, target, "--steps", 1, "--feature-size", "20%")
    assert done.returncode == 0, done.stderr
    V, F = arrays_of(target)
    assert np.isfinite(V).all()
    assert F.shape == (4, 3)


def test_a_missing_output_folder_is_named(cow: Path, tmp_path: Path) -> None:
    target = tmp_path / "nowhere" / "out.ply"
    assert_fails(command("filter", cow, target), 1, str(target.parent), "create it first")


def test_a_folder_as_output_is_refused(cow: Path, tmp_path: Path) -> None:
    assert_fails(command("filter", cow, tmp_path), 1, "name a file")


@pytest.mark.skipif(not Path("/proc/self").is_dir(), reason="no folder here that even root may not")
def test_an_unwritable_output_folder_is_refused_before_the_work(cow: Path) -> None:
    begin = time.monotonic()
    assert_fails(command("filter", cow, "/proc/out.ply", "--steps", 1000), 1, "another folder")
    assert time.monotonic() - begin < 10


def test_a_full_disk_leaves_the_old_output(cow: Path, existing: Path) -> None:
    """The disk is played by a limit on the size of files."""
    limited = ["bash", "-c", 'ulimit -f 20; exec "$@"', "bash", *COMMAND]
    done = subprocess.run(
        [*limited, "filter", str(cow), str(existing), "--steps", "1"],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert_fails(done, 1)


def test_a_missing_plugin_is_told_without_traceback(cow: Path, existing: Path) -> None:
    done = command("filter", cow, existing, MESHLAB_SPECTRAL_PLUGIN="/no/such/plugin.so")
    assert_fails(done, 1, "/no/such/plugin.so", "MESHLAB_SPECTRAL_PLUGIN")


def test_debug_shows_where_an_error_arose(existing: Path, tmp_path: Path) -> None:
    cloud = write_ply(tmp_path / "cloud.ply", "0 0 0\n1 0 0\n0 1 0", "")
    done = command("filter", cloud, existing, "--debug")
    assert done.returncode == 1
    assert "Traceback" in done.stderr
    assert "filter_to_scratch" in done.stderr


# --- what goes wrong: exit code 2 -----------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["--feature-size", "0"], "feature-size"),
        (["--feature-size", "-5%"], "feature-size"),
        (["--feature-size", "big"], "5%"),
        (["--feature-size", "150%"], "100%"),
        (["--filter-type", "lowpass"], "low-pass"),
        (["--response", "bessel"], "butterworth"),
        (["--order", "0"], "order"),
        (["--order", "2.5"], "order"),
        (["--band-width", "0"], "band_width"),
        (["--pass-gain", "-1"], "pass_gain"),
        (["--stop-gain", "nan"], "stop_gain"),
        (["--steps", "-1"], "steps"),
        (["--basis-size", "0"], "basis_size"),
        (["--basis-update", "sometimes"], "conformal"),
        (["--no-such-option"], "--no-such-option"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_a_wrong_option_is_named_before_any_file_is_touched(
    arguments: list[str], word: str, existing: Path, tmp_path: Path
) -> None:
    done = command("filter", tmp_path / "no such.ply", existing, *arguments)
    assert_fails(done, 2, word)


@pytest.mark.parametrize("name", ["result.xyzzy", "result"])
def test_an_output_format_that_meshlab_cannot_write_is_refused_before_the_work(
    name: str, samples: Path, tmp_path: Path
) -> None:
    begin = time.monotonic()
    target = tmp_path / name
    done = command("filter", samples / "bunny.obj", target, "--steps", 1000)
    assert_fails(done, 2, name, ".ply")
    assert time.monotonic() - begin < 10
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("how", ["same name", "symbolic link", "hard link"])
def test_the_input_is_never_the_output(how: str, cow: Path, tmp_path: Path) -> None:
    source = tmp_path / "cow.obj"
    shutil.copy(cow, source)
    target = source if how == "same name" else tmp_path / "other.obj"
    if how == "symbolic link":
        target.symlink_to(source)
    if how == "hard link":
        target.hardlink_to(source)
    assert_fails(command("filter", source, target), 2, "INPUT itself")
    assert source.read_bytes() == cow.read_bytes()


def test_a_missing_argument_is_a_usage_error(cow: Path) -> None:
    assert_fails(command("filter", cow), 2, "OUTPUT")


# --- interruption ---------------------------------------------------------------------------------


@pytest.fixture
def long_run(samples: Path, existing: Path) -> Iterator[subprocess.Popen[str]]:
    """A filter that would take a minute, seen at work."""
    process = subprocess.Popen(
        [*COMMAND, "filter", str(samples / "bunny.obj"), str(existing), "--steps", "500"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # A shell's background jobs, and all that they start, ignore Ctrl-C; this one must not.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    try:
        wait_until(lambda: bool(child_of(process)))
        time.sleep(1)
        yield process
    finally:
        process.kill()
        process.communicate()


def child_of(process: subprocess.Popen[str]) -> int:
    """Process id of the command's own child, 0 as long as there is none."""
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
    return int(children[0]) if children else 0


def wait_until(reached: Callable[[], bool], seconds: float = 20) -> None:
    end = time.monotonic() + seconds
    while not reached():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.02)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interruption_ends_with_130_at_once_and_leaves_nothing_behind(
    number: signal.Signals, long_run: subprocess.Popen[str]
) -> None:
    child = child_of(long_run)
    begin = time.monotonic()
    long_run.send_signal(number)
    stdout, stderr = long_run.communicate(timeout=20)
    assert time.monotonic() - begin < 5
    assert long_run.returncode == 130
    assert stdout == ""
    assert stderr == "Interrupted: no output was written.\n"
    assert not Path(f"/proc/{child}").exists()


def test_the_death_of_the_working_process_is_told(long_run: subprocess.Popen[str]) -> None:
    os.kill(child_of(long_run), signal.SIGKILL)
    stdout, stderr = long_run.communicate(timeout=20)
    assert long_run.returncode == 1
    assert stdout == ""
    assert "SIGKILL" in stderr
    assert "memory" in stderr
    assert "Traceback" not in stderr


# --- progress -------------------------------------------------------------------------------------


def test_progress_is_shown_on_a_terminal_only(samples: Path, tmp_path: Path) -> None:
    arguments = ["filter", str(samples / "bunny.obj"), str(tmp_path / "out.ply"), "--steps", "20"]
    reader, terminal = pty.openpty()
    try:
        process = subprocess.Popen(
            [*COMMAND, *arguments],
            stdout=subprocess.PIPE,
            stderr=terminal,
            env={**os.environ, "COLUMNS": "100", "TERM": "xterm-256color"},
        )
        os.close(terminal)
        shown = b""
        while True:
            try:
                part = os.read(reader, 65536)
            except OSError:  # Linux's way to say that the last writer has gone
                break
            if not part:
                break
            shown += part
        stdout, _ = process.communicate(timeout=60)
    finally:
        os.close(reader)
    assert process.returncode == 0
    steps = [int(step) for step in re.findall(rb"step (\d+) of 20", shown)]
    assert len(set(steps)) >= 3
    assert steps == sorted(steps)
    assert b"step" not in stdout
    assert "step" not in command(*arguments).stderr
