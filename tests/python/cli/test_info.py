"""The command `meshlab-spectral info`."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pymeshlab
import pytest
from batches import make_meshes
from commands import command, succeeded, write_ply
from helpers import diagonal, mesh_set_of
from meshlab_spectral import denoise_mesh, filter_mesh, geometry_spectrum
from meshlab_spectral.files.meshes import load_arrays

# Two squares cut apart along their common side, a triangle, and an unreferenced vertex.
CUT = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n1 0 0\n2 0 0\n2 1 0\n1 1 0\n5 0 0\n6 0 0\n5 1 0\n9 9 9"
CUT_FACES = "3 0 1 2\n3 0 2 3\n3 4 5 6\n3 4 6 7\n3 8 9 10"


def info(path: Path, *arguments: str) -> dict:
    return json.loads(succeeded("info", path, "--json", *arguments).stdout)


def test_the_surface_is_counted_with_its_seams_closed(tmp_path: Path) -> None:
    found = info(path := write_ply(tmp_path / "cut.ply", CUT, CUT_FACES))
    names = ["vertices", "faces", "components", "rims", "joined_vertices", "unreferenced_vertices"]
    assert [found[name] for name in names] == [12, 5, 2, 2, 2, 1]
    assert found["extent"] == [9, 9, 9]
    assert (found["selected_vertices"], found["selected_faces"]) == (0, 0)
    assert re.search(r"Vertices without faces\W+1\W*\n", command("info", path).stdout)


def test_lengths_and_noise_are_those_of_the_filters(tmp_path: Path) -> None:
    (scan,) = make_meshes(tmp_path, 1, rings=48)
    found, before = info(scan), scan.read_bytes()
    V, F = load_arrays(scan)
    spectrum, (_, denoised) = geometry_spectrum(V, F), denoise_mesh(V, F)
    for name in ("diagonal", "mean_edge", "area"):
        assert found[name] == pytest.approx(getattr(spectrum, name), rel=1e-9)
    assert found["default_feature_size"] == filter_mesh(V, F)[1]["feature_size"]
    assert found["diagonal"] == pytest.approx(diagonal(V))
    assert found["rims"] == 0
    for name in ("noise_height", "noise_size", "noise_share", "spikes"):
        assert found[name] == pytest.approx(denoised[name], rel=1e-6)
    assert found["noise_kind"] == denoised["noise_kind"] == "white"
    assert found["noise_summary"] == denoised["summary"].removesuffix(": removed")
    assert found["noise_height"] > 0
    assert scan.read_bytes() == before
    assert [path.name for path in tmp_path.iterdir()] == [scan.name]


def test_without_json_a_labelled_table_is_printed(tmp_path: Path) -> None:
    (scan,) = make_meshes(tmp_path, 1, rings=48)
    done = succeeded("info", scan)
    for label in ("Vertices", "Rims", "Mean edge", "Noise height", "Suggested feature size"):
        assert label in done.stdout
    assert "Selected" not in done.stdout
    assert done.stdout.splitlines()[-1].startswith("Noise: ")


def test_a_selection_in_the_file_is_counted(tmp_path: Path) -> None:
    (torus,) = make_meshes(tmp_path, 1)
    mesh_set = mesh_set_of(*load_arrays(torus))
    mesh_set.compute_selection_by_condition_per_face(condselect="(z0 > 0)")
    chosen = mesh_set.current_mesh().selected_face_number()
    path = tmp_path / "selected.ply"
    mesh_set.save_current_mesh(str(path), save_vertex_flag=True, save_face_flag=True)
    found = info(path)
    assert (found["selected_vertices"], found["selected_faces"]) == (0, chosen)
    assert f"{chosen} faces, 0 vertices" in command("info", path).stdout


def test_closed_surfaces_have_no_rims_and_holes_one_each(tmp_path: Path) -> None:
    (torus,) = make_meshes(tmp_path, 1)
    V, F = load_arrays(torus)
    far = [k for k, corners in enumerate(F) if not {0, 70} & set(corners)]
    mesh = pymeshlab.Mesh(V, np.delete(F, np.setdiff1d(np.arange(len(F)), far), axis=0))
    mesh_set = pymeshlab.MeshSet()
    mesh_set.add_mesh(mesh)
    holes = tmp_path / "holes.off"
    mesh_set.save_current_mesh(str(holes))
    assert (info(torus)["rims"], info(holes)["rims"]) == (0, 2)
