"""The command `meshlab-spectral spectrum`: its plot, its numbers, what it refuses."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

import commands
import matplotlib.image
import numpy as np
import pytest
from commands import messages_in
from helpers import diagonal, loaded, lower_part, mesh_set_of
from meshlab_spectral import FilterOptions, geometry_spectrum
from meshlab_spectral.cli.spectrum import SHOWN_OPTIONS
from meshlab_spectral.files.meshes import load_arrays


def command(*arguments: object, folder: Path | None = None) -> subprocess.CompletedProcess[str]:
    return commands.command("spectrum", *arguments, folder=folder)


def colours(path: Path) -> Any:
    return np.asarray(matplotlib.image.imread(path))[:, :, :3]


def test_the_plot_and_a_table_of_the_octaves_are_made(cow: Path, tmp_path: Path) -> None:
    done = command(cow, "--basis-size", 20, "--feature-size", "10%", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert messages_in(done.stderr) == ""
    assert [path.name for path in tmp_path.iterdir()] == ["cow_spectrum.png"]
    assert done.stdout.splitlines()[-1] == "cow_spectrum.png"
    for word in ("cow.obj", "low-pass", "Amplitude", "Gain", "50, 90, 99 %", "oise"):
        assert word in done.stdout
    rows = [line for line in done.stdout.splitlines() if line.startswith("│")]
    cells = np.array([line.replace("│", " ").split() for line in rows], float)
    for length, percent in (cells[:, :2].T, cells[:, 2:4].T):
        np.testing.assert_allclose(percent, 100 * length / diagonal(load_arrays(cow)[0]), rtol=5e-3)
    picture = colours(tmp_path / "cow_spectrum.png")
    assert picture.shape[0] > 500
    assert 0.1 < (picture < 0.98).any(axis=2).mean() < 0.9


def test_noise_is_reported_and_shaded(samples: Path, tmp_path: Path) -> None:
    mesh_set = loaded(samples / "bunny.obj")
    mesh_set.meshing_decimation_quadric_edge_collapse(targetfacenum=12000)
    mesh = mesh_set.current_mesh()
    V, F = mesh.vertex_matrix(), mesh.face_matrix()
    noisy = V + 0.002 * np.random.default_rng(3).standard_normal(V.shape)
    mesh_set_of(noisy, F).save_current_mesh(str(tmp_path / "noisy.ply"))
    done = command(tmp_path / "noisy.ply", "--basis-size", 50, folder=tmp_path)
    assert "White noise: height" in done.stdout
    assert "more than the shape in details" in " ".join(done.stdout.split())
    shaded = colours(tmp_path / "noisy_spectrum.png")
    # A pale brown that only the shading has, over the right part of the plot.
    brown = (shaded[:, :, 0] > shaded[:, :, 2] + 0.03) & (shaded.min(axis=2) > 0.8)
    columns = np.flatnonzero(brown.sum(axis=0) > 200)
    assert 0.5 * shaded.shape[1] < columns.min() < columns.max()


def test_a_mesh_too_small_to_estimate_noise_is_drawn(samples: Path, tmp_path: Path) -> None:
    mesh_set_of(
        np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]])
    ).save_current_mesh(str(tmp_path / "triangle.ply"))
    done = command("triangle.ply", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "Too few vertices" in done.stdout


def test_a_fixed_boundary_changes_the_spectrum(tmp_path: Path, decimated: Any) -> None:
    mesh_set_of(*lower_part(*decimated("bunny.obj", 1500))).save_current_mesh(
        str(tmp_path / "open.ply")
    )
    free, fixed = (
        json.loads(
            command(
                "open.ply", "--json", "--boundary", b, "--basis-size", 9, folder=tmp_path
            ).stdout
        )
        for b in ("free", "fixed")
    )
    assert fixed["options"]["boundary"] == "fixed"
    assert fixed["spectrum"]["total_energy"] != free["spectrum"]["total_energy"]


def test_the_filter_options_change_the_plot(cow: Path, tmp_path: Path) -> None:
    plots = [tmp_path / "low.png", tmp_path / "band.png"]
    command(cow, "--output", plots[0], "--basis-size", 20)
    command(cow, "--output", plots[1], "--basis-size", 20, "--filter-type", "band-pass")
    low, band = map(colours, plots)
    assert low.shape == band.shape
    assert not np.array_equal(low, band)


def test_json_holds_the_spectrum_the_options_and_the_gains(cow: Path, tmp_path: Path) -> None:
    done = command(cow, "--json", "--basis-size", 20, "--stop-gain", 0.5, folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert list(tmp_path.iterdir()) == [], "no plot unless one is named"
    record = json.loads(done.stdout)
    assert record["output"] is None
    assert set(record["options"]) == set(SHOWN_OPTIONS)
    assert record["options"]["stop_gain"] == 0.5
    assert record["versions"].keys() == {"meshlab_spectral", "core", "pymeshlab", "python"}
    expected = geometry_spectrum(*load_arrays(cow), basis_size=20)
    found = record["spectrum"]
    np.testing.assert_allclose(found["octave_energies"], expected.octave_energies, rtol=1e-9)
    np.testing.assert_allclose(found["frequencies"], expected.frequencies, rtol=1e-9)
    assert found["feature_size_90"] == pytest.approx(expected.feature_size_90)
    # The Gaussian low-pass of 5 %, that keeps at least one half.
    x = 0.05 * expected.diagonal / expected.octave_feature_sizes
    np.testing.assert_allclose(record["octave_gains"], 0.5 + 0.5 * 2 ** (-(x**2) / 2), rtol=1e-9)


@pytest.mark.parametrize("ending", ["png", "pdf", "svg"])
def test_json_and_every_kind_of_plot_go_together(ending: str, cow: Path, tmp_path: Path) -> None:
    plot = tmp_path / f"cow.{ending}"
    done = command(cow, "--json", "--output", plot, "--basis-size", 5)
    assert json.loads(done.stdout)["output"] == str(plot)
    start = {"png": b"\x89PNG", "pdf": b"%PDF", "svg": b"<?xml"}[ending]
    assert plot.read_bytes().startswith(start)
    assert list(tmp_path.iterdir()) == [plot]
    refused = command(cow, "--output", plot)
    assert refused.returncode == 2
    assert "exists: choose another name" in messages_in(refused.stderr)


def test_help_names_the_options_that_make_the_curve_and_no_others() -> None:
    done = command("--help")
    assert done.returncode == 0
    for name in FilterOptions().as_dict():
        shown = f"--{name.replace('_', '-')} " in done.stdout
        assert shown == (name in SHOWN_OPTIONS or name == "basis_size"), name
