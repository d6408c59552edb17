"""The command `meshlab-spectral spectra`: one table of many meshes."""

from __future__ import annotations

import csv
import json
import shutil
from pathlib import Path

import meshlab_spectral
import numpy as np
import pytest
from batches import make_meshes, records
from commands import PRECIOUS, arrays_of, assert_fails, command, succeeded


def test_the_table_has_the_octaves_of_every_mesh(cow: Path, samples: Path, tmp_path: Path) -> None:
    broken, table = tmp_path / "broken.ply", tmp_path / "spectra.csv"
    broken.write_text("no mesh")
    bone = samples / "bone.ply"
    done = command("spectra", cow, bone, broken, "--output", table, "--basis-size", 50)
    assert done.returncode == 1
    assert "2 measured, 1 failed" in done.stdout
    assert str(broken) in done.stderr
    with table.open(newline="") as file:
        rows = list(csv.DictReader(file))
    for path in (cow, bone):
        of_mesh = [row for row in rows if row["mesh"] == str(path)]
        spectrum = meshlab_spectral.geometry_spectrum(*arrays_of(path), basis_size=50)
        for column, expected in (
            ("feature_size", spectrum.octave_feature_sizes),
            ("amplitude", spectrum.octave_amplitudes),
            ("amplitude_percent", spectrum.octave_amplitudes / spectrum.diagonal * 100),
        ):
            values = [float(row[column]) for row in of_mesh]
            assert values == pytest.approx(list(expected), rel=1e-5)
        assert sum(float(row["energy_share"]) for row in of_mesh) == pytest.approx(1, rel=1e-5)
        octaves = np.log2([float(row["feature_size_percent"]) / 100 for row in of_mesh])
        np.testing.assert_allclose(octaves, np.round(octaves), atol=1e-5)
        np.testing.assert_allclose(np.diff(octaves), -1, atol=1e-5)
    assert len(rows) == sum(row["mesh"] in (str(cow), str(bone)) for row in rows)


def test_a_mistake_leaves_the_old_table(cow: Path, existing: Path, tmp_path: Path) -> None:
    missing = tmp_path / "none.ply"
    assert_fails(command("spectra", missing, "--output", existing), 2, str(missing))
    assert existing.read_bytes() == PRECIOUS


def test_a_mesh_is_not_replaced_by_the_table(cow: Path, tmp_path: Path) -> None:
    mesh = tmp_path / "other.obj"
    shutil.copy(cow, mesh)
    assert_fails(command("spectra", cow, "--output", mesh), 2, "is not a table of spectra")
    assert mesh.read_bytes() == cow.read_bytes()


@pytest.mark.parametrize("table", [".", "/"])
def test_a_table_that_is_a_folder_is_refused(table: str, cow: Path) -> None:
    assert_fails(command("spectra", cow, "--output", table), 1, "is a folder or a device")


def test_one_file_for_table_and_report_is_refused(cow: Path, tmp_path: Path) -> None:
    table = tmp_path / "x.csv"
    done = command("spectra", cow, "--output", table, "--report", table)
    assert_fails(done, 2, "is also the table")
    assert not table.exists()


def test_an_input_is_not_replaced_by_the_table(cow: Path, tmp_path: Path) -> None:
    mesh, link = tmp_path / "cow.obj", tmp_path / "link.csv"
    shutil.copy(cow, mesh)
    link.symlink_to(mesh)
    for table in (mesh, link):
        assert_fails(command("spectra", mesh, "--output", table), 2, "is an input itself")
    assert mesh.read_bytes() == cow.read_bytes()
    assert sorted(tmp_path.iterdir()) == [mesh, link]


def test_resume_measures_only_what_the_report_does_not_hold(tmp_path: Path) -> None:
    folder, table = tmp_path / "in", tmp_path / "spectra.csv"
    make_meshes(folder, 2)
    spectra = ["spectra", folder, "--output", table, "--basis-size", 20, "--workers", 1]
    succeeded(*spectra)
    before = table.read_text()
    assert_fails(command(*spectra), 2, "exists: choose another name, or replace it with")
    assert len(records(tmp_path / "spectra_report.jsonl")) == 2
    table.unlink()
    make_meshes(folder, 3)
    done = command(*spectra, "--resume")
    assert "1 measured, 0 failed, 2 already done" in done.stdout
    after = table.read_text()
    assert after.startswith(before)
    assert len({line.partition(",")[0] for line in after.splitlines()}) == 1 + 3
    other = command(*spectra, "--resume", "--boundary", "fixed", "--basis-size", 21)
    assert "3 measured" in other.stdout


def test_a_recorded_spectrum_that_cannot_be_written_is_measured_again(tmp_path: Path) -> None:
    table, report = tmp_path / "spectra.csv", tmp_path / "spectra_report.jsonl"
    spectra = ["spectra", *make_meshes(tmp_path, 2), "--output", table, "--workers", 1]
    succeeded(*spectra)
    before = table.read_text()
    run, first, second, *_ = map(json.loads, report.read_text().splitlines())
    first["report"] = {"diagonal": 0}
    second["report"]["octave_amplitudes"] = None
    report.write_text("".join(json.dumps(line) + "\n" for line in (run, first, second)))
    done = command(*spectra, "--resume")
    assert "2 measured, 0 failed" in done.stdout, done.stderr
    assert table.read_text() == before
