"""Every filter gives the same bits through pymeshlab, the package's own module, and the command."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import plyfile
import pymeshlab
import pytest
from calls_of_filters import CALLS, SHAPES, Call, Inputs, inputs_named, inputs_of
from commands import command
from helpers import mesh_set_of
from meshlab_spectral import _core

Result = dict[str, Any]


def as_for_pymeshlab(value: Any) -> Any:
    if isinstance(value, str) and value.endswith("%"):
        return pymeshlab.PercentageValue(float(value[:-1]))
    return value


@pytest.fixture(scope="module")
def inputs(decimated: Any) -> Inputs:
    return inputs_of(*decimated("bunny.obj"))


@pytest.fixture(scope="module", params=SHAPES)
def every_inputs(request: pytest.FixtureRequest, decimated: Any) -> Inputs:
    return inputs_named(request.param, decimated)


def made_for_pymeshlab(inputs: Inputs) -> pymeshlab.MeshSet:
    V, F, quality, levels, selected = inputs
    colors = np.column_stack([levels / 255, np.ones(len(V))])
    mesh_set = mesh_set_of(V, F, v_scalar_array=quality, v_color_matrix=colors)
    mesh = mesh_set.current_mesh()
    mesh.add_vertex_custom_scalar_attribute(selected.astype(float), "chosen")
    mesh_set.compute_selection_by_condition_per_vertex(condselect="chosen > 0.5")
    return mesh_set


def through_pymeshlab(call: Call, mesh_set: pymeshlab.MeshSet) -> Result:
    given = {name: as_for_pymeshlab(value) for name, value in call.options.items()}
    report = mesh_set.apply_filter(call.name, **given)
    mesh = mesh_set.current_mesh()
    colors = np.round(255 * mesh.vertex_color_matrix()[:, :3]).astype(int)
    return {
        "vertices": mesh.vertex_matrix().copy(),
        "quality": mesh.vertex_scalar_array().copy(),
        "colors": colors,
        "report": report,
    }


def through_core(call: Call, inputs: Inputs) -> Result:
    V, F, quality, levels, selected = inputs
    is_color = "color" in call.name
    values = levels.astype(float) if is_color else quality[:, None]
    result = _core.apply(call.name, V, F, call.options, selected=selected, values=values)
    new = result.get("values", values)
    return {
        "vertices": result.get("vertices", V),
        "quality": quality if is_color else new[:, 0],
        "colors": new.astype(int) if is_color else None,
        # pymeshlab passes on no texts.
        "report": {k: v for k, v in result["report"].items() if not isinstance(v, str)},
    }


def assert_same(one: Result, other: Result) -> None:
    np.testing.assert_array_equal(one["vertices"], other["vertices"])
    np.testing.assert_array_equal(one["quality"], other["quality"])
    if one["colors"] is not None and other["colors"] is not None:
        np.testing.assert_array_equal(one["colors"], other["colors"])
    assert one["report"].keys() == other["report"].keys()
    for name, value in one["report"].items():
        np.testing.assert_array_equal(value, other["report"][name], err_msg=name)


def test_every_filter_is_among_the_calls() -> None:
    assert {call.name for call in CALLS} == {one["python_name"] for one in _core.filters()}


def refused_by_the_core(call: Call, inputs: Inputs) -> str:
    try:
        through_core(call, inputs)
    except Exception as error:
        return str(error)
    return ""


@pytest.mark.parametrize("call", CALLS)
def test_pymeshlab_and_the_module_give_the_same_bits(call: Call, every_inputs: Inputs) -> None:
    mesh_set = made_for_pymeshlab(every_inputs)
    if refused_by_the_core(call, every_inputs):
        with pytest.raises(pymeshlab.PyMeshLabException):
            through_pymeshlab(call, mesh_set)
    else:
        assert_same(through_core(call, every_inputs), through_pymeshlab(call, mesh_set))


# Each shape takes the next: what the module does with it, all calls have shown above.
COMMANDS = [
    ("filter", CALLS[0]),
    ("denoise", CALLS[5]),
    ("filter", CALLS[3]),
    ("denoise", CALLS[6]),
]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("shape", "number"), [(shape, k % len(COMMANDS)) for k, shape in enumerate(SHAPES)]
)
def test_the_command_gives_the_same_bits(
    shape: str, number: int, decimated: Any, tmp_path: Path
) -> None:
    name, call = COMMANDS[number]
    inputs = inputs_named(shape, decimated)
    V, F = inputs.V, inputs.F
    columns = [("x", "f8"), ("y", "f8"), ("z", "f8")]
    rows = np.array([tuple(v) for v in V], columns)
    faces = np.array([(face,) for face in F], [("vertex_indices", "i4", (3,))])
    elements = [plyfile.PlyElement.describe(r, n) for r, n in ((rows, "vertex"), (faces, "face"))]
    source, target = tmp_path / "in.ply", tmp_path / "out.ply"
    plyfile.PlyData(elements).write(source)
    options = [f"--{key.replace('_', '-')}={value}" for key, value in call.options.items()]
    options = ["--no-keep-creases" if "keep-creases" in each else each for each in options]
    done = command(name, source, target, *options)
    if refused_by_the_core(call, inputs):
        assert done.returncode != 0
        return
    assert done.returncode == 0, done.stderr
    read = plyfile.PlyData.read(target)["vertex"]
    result = np.column_stack([read[axis] for axis in "xyz"])
    np.testing.assert_array_equal(result, through_core(call, inputs)["vertices"])


# MeshLab's own filters crash in threads, so that the meshes are made in one.
@pytest.mark.parametrize(
    ("run", "made"),
    [(through_core, lambda inputs: inputs), (through_pymeshlab, made_for_pymeshlab)],
    ids=["module", "mesh_set"],
)
def test_threads_give_the_same_bits_as_one_run_after_the_other(
    run: Any, made: Any, inputs: Inputs
) -> None:
    alone = [run(call, made(inputs)) for call in CALLS]
    meshes = [made(inputs) for _ in range(2 * len(CALLS))]
    with ThreadPoolExecutor(8) as pool:
        for number, result in enumerate(pool.map(run, [*CALLS, *CALLS], meshes)):
            assert_same(result, alone[number % len(CALLS)])


def test_the_number_of_threads_changes_no_bit(inputs: Inputs) -> None:
    call = CALLS[0]
    one, two = (_core.apply(call.name, inputs.V, inputs.F, {}, threads=n) for n in (1, 2))
    np.testing.assert_array_equal(one["vertices"], two["vertices"])


def test_an_unknown_filter_of_a_mesh_set_is_told(inputs: Inputs) -> None:
    with pytest.raises(pymeshlab.PyMeshLabException):
        mesh_set_of(inputs.V, inputs.F).apply_filter("apply_coord_spectral_nothing")
    with pytest.raises(IndexError, match="apply_coord_spectral_nothing"):
        _core.apply("apply_coord_spectral_nothing", inputs.V, inputs.F, {})
