"""`filter` and `denoise` on a region: --box, --component, --where and --mask."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from commands import arrays_of, assert_fails, command, succeeded
from helpers import mesh_set_of
from meshlab_spectral import InputError, OptionError, denoise_mesh, filter_mesh
from meshlab_spectral.files.region import Region
from meshlab_spectral.files.region_vertices import vertices_in
from numpy.typing import NDArray

Arrays = tuple[NDArray[np.float64], NDArray[np.int32]]
Select = Callable[[NDArray[np.float64]], NDArray[np.bool_]]

REGIONS: dict[str, tuple[list[str], Select]] = {
    "box": (["--box", "-inf,-inf,0.2,0.1,inf,inf"], lambda V: (V[:, 2] >= 0.2) & (V[:, 0] <= 0.1)),
    "a box by any two corners": (["--box", "9,9,9,0,-9,-9"], lambda V: V[:, 0] >= 0),
    "where": (
        ["--where", "z > 0.2 && x + y < 0.1"],
        lambda V: (V[:, 2] > 0.2) & (V[:, 0] + V[:, 1] < 0.1),
    ),
    "both": (
        ["--box", "-9,-9,0.2,9,9,9", "--where", "x < 0"],
        lambda V: (V[:, 2] >= 0.2) & (V[:, 0] < 0),
    ),
}


def spheres(*radii: float) -> Arrays:
    """Noisy icospheres side by side."""
    import pyvista

    rng, vertices, faces, count = np.random.default_rng(3), [], [], 0
    for number, radius in enumerate(radii):
        ball = pyvista.Icosphere(radius=radius, nsub=3, center=(5.0 * number, 0, 0))
        noise = 1 + 0.03 * rng.standard_normal(ball.n_points)[:, None]
        vertices.append((ball.points - ball.center) * noise + ball.center)
        faces.append(ball.regular_faces + count)
        count += ball.n_points
    return np.vstack(vertices), np.vstack(faces).astype(np.int32)


def written(folder: Path, mesh: Arrays, ending: str = "ply") -> Path:
    path = folder / f"in.{ending}"
    mesh_set_of(*mesh).save_current_mesh(str(path))
    return path


@pytest.mark.parametrize("verb", ["filter", "denoise"])
@pytest.mark.parametrize("region", REGIONS)
def test_a_region_is_filtered_as_the_same_selection_in_python(
    verb: str, region: str, tmp_path: Path
) -> None:
    arguments, select = REGIONS[region]
    source, target = written(tmp_path, spheres(1.0)), tmp_path / "out.ply"
    done = succeeded(verb, source, target, *arguments, "--json")
    V, F = arrays_of(source)
    function: Any = filter_mesh if verb == "filter" else denoise_mesh
    expected, report = function(V, F, selection=select(V))
    np.testing.assert_allclose(arrays_of(target)[0], expected, atol=1e-6)
    record = json.loads(done.stdout)
    assert record["report"]["max_displacement"] == pytest.approx(report["max_displacement"])
    assert record["region"].keys() == {name[2:] for name in arguments[::2]}
    far = np.linalg.norm(V - V[select(V)].mean(axis=0), axis=1).argmax()
    assert not select(V)[far]
    if verb == "denoise":  # which reaches four edges beyond
        np.testing.assert_array_equal(arrays_of(target)[0][far], V[far])


def test_the_normal_and_the_quality_are_variables_of_a_condition(tmp_path: Path) -> None:
    mesh_set = mesh_set_of(*spheres(1.0))
    mesh_set.compute_scalar_by_function_per_vertex(q="x * 10")
    source = tmp_path / "in.ply"
    mesh_set.save_current_mesh(str(source))
    for condition in ("q > 5", "nx > 0.5"):
        succeeded("filter", source, tmp_path / "out.ply", "--where", condition, "--overwrite")
        V, moved = arrays_of(source)[0], arrays_of(tmp_path / "out.ply")[0]
        where = (moved != V).any(axis=1)
        assert 50 < where.sum() < 0.7 * len(V)
        assert V[where, 0].mean() > 0.3


@pytest.mark.parametrize("ending", ["ply", "obj"])
def test_how_much_is_in_the_region_is_no_warning(ending: str, tmp_path: Path) -> None:
    source, target = written(tmp_path, spheres(1.0)), tmp_path / f"out.{ending}"
    V, _ = arrays_of(source)
    arguments = ("filter", source, target, "--where", "z > 0.2", "--overwrite")
    done = command(*arguments)
    number = np.count_nonzero(V[:, 2] > 0.2)
    assert f"in.ply: only {number} of {len(V)} vertices are chosen" in done.stdout
    quiet = command(*arguments, "--quiet")
    assert quiet.stdout == ""
    assert "vertices" not in done.stderr + quiet.stderr


@pytest.mark.parametrize(("given", "number"), [("largest", 1), ("1", 1), ("2", 0), ("3", 2)])
def test_components_are_counted_by_area(given: str, number: int, tmp_path: Path) -> None:
    source, target = written(tmp_path, spheres(1.0, 1.5, 0.5)), tmp_path / "out.ply"
    succeeded("denoise", source, target, "--component", given)
    V, moved = arrays_of(source)[0], arrays_of(target)[0]
    n = len(V) // 3
    has_moved = (moved != V).any(axis=1).reshape(3, n).sum(axis=1)
    assert has_moved[number] > n / 2
    assert has_moved.sum() == has_moved[number]


@pytest.mark.parametrize("ending", ["txt", "npy"])
@pytest.mark.parametrize("output", ["ply", "obj"])
def test_a_mask_file_has_a_number_for_each_vertex(ending: str, output: str, tmp_path: Path) -> None:
    source = written(tmp_path, spheres(1.0))
    V, F = arrays_of(source)
    mask, path = V[:, 1] > 0.3, tmp_path / f"mask.{ending}"
    np.save(path, mask) if ending == "npy" else np.savetxt(path, mask)
    target = tmp_path / f"out.{output}"
    succeeded("denoise", source, target, "--mask", path)
    expected, _ = denoise_mesh(V, F, selection=mask)
    np.testing.assert_allclose(arrays_of(target)[0], expected, atol=1e-5)


MASKS: dict[str, tuple[Any, str]] = {
    "nan": ([0.0, np.nan, 1.0], "has nan for vertex 1: give 0"),
    "infinite": ([0.0, 1.0, np.inf], "has inf for vertex 2: give 0"),
    "several": (np.zeros((3, 2)), "has 3 x 2 numbers for 3 vertices"),
    "complex": ([0.0, 1.0, 1j], "it has complex numbers"),
}


@pytest.mark.parametrize("mask", MASKS)
def test_a_mask_that_does_not_say_what_is_selected_is_refused(mask: str, tmp_path: Path) -> None:
    numbers, reason = MASKS[mask]
    np.save(tmp_path / "mask.npy", numbers)
    with pytest.raises((InputError, OptionError), match=reason):
        vertices_in(Region(mask=tmp_path / "mask.npy"), np.eye(3), np.array([[0, 1, 2]]))


@pytest.mark.parametrize("name", ["mask.npy", "mask.txt", "mask.npz"])
def test_a_mask_without_numbers_is_refused(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    path.touch()
    if name == "mask.npz":
        np.savez(path, np.ones(3))
    with pytest.raises((InputError, OptionError), match=r"^the mask .*/mask.* is no"):
        vertices_in(Region(mask=path), np.eye(3), np.array([[0, 1, 2]]))


@pytest.mark.parametrize("shape", [(3, 1), (1, 3)])
def test_a_mask_may_be_a_column_or_a_row(shape: tuple[int, int], tmp_path: Path) -> None:
    np.save(tmp_path / "mask.npy", np.reshape([0, 1, 0], shape))
    chosen = vertices_in(Region(mask=tmp_path / "mask.npy"), np.eye(3), np.array([[0, 1, 2]]))
    np.testing.assert_array_equal(chosen, [False, True, False])


@pytest.mark.parametrize(("given", "name"), [("largest", "b"), ("2", "a"), ("3", "c")])
def test_components_are_counted_over_all_meshes_of_a_file(
    given: str, name: str, tmp_path: Path
) -> None:
    source, target = tmp_path / "in.glb", tmp_path / "out.glb"
    scene = trimesh.Scene()
    V, F = spheres(1.0, 1.5, 0.5)
    for number, one in enumerate("abc"):
        part = slice(number * len(V) // 3, (number + 1) * len(V) // 3)
        corners = F[number * len(F) // 3 : (number + 1) * len(F) // 3] - part.start
        scene.add_geometry(trimesh.Trimesh(V[part], corners, process=False), geom_name=one)
    scene.export(source)
    assert_fails(command("denoise", source, target, "--component", 4), 2, "there are 3")
    assert (
        json.loads(succeeded("denoise", source, target, "--component", given, "--json").stdout)[
            "report"
        ]["mesh"]
        == name
    )


def test_a_recipe_that_lacks_the_region_says_so(tmp_path: Path) -> None:
    source, recipe = written(tmp_path, spheres(1.0)), tmp_path / "recipe.toml"
    arguments = ("filter", source, tmp_path / "out.ply", "--overwrite", "--save-recipe", recipe)
    assert "recipe" not in command(*arguments).stderr
    done = command(*arguments, "--where", "z > 0", "--box", "0,0,0,2,2,2")
    assert f"{recipe} does not hold --box, --where" in done.stderr
