"""Every filter gives the same bits through pymeshlab, the package's own module, and the command."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import plyfile
import pymeshlab
import pytest
from commands import command
from fuzz.meshes import shape_of
from helpers import mesh_set_of
from meshlab_spectral import _core
from numpy.typing import NDArray


class Call(NamedTuple):
    """A filter, and values of parameters; lengths as texts, numbers as in single precision."""

    name: str
    options: dict[str, Any]


FILTER = "apply_coord_spectral_filter_fractional"
CALLS = [
    Call(FILTER, {}),
    Call(FILTER, {"feature_size": "15%", "pass_gain": 1.125, "selected": True}),
    Call(FILTER, {"filter_type": "high-pass", "stop_gain": 1.0, "weight": "vertex quality"}),
    Call(FILTER, {"filter_type": "custom", "transfer_function": "20%:1, 6e:1.7, 1%:0.1"}),
    Call(FILTER, {"spectrum": "truncated", "basis_size": 20, "steps": 2, "basis_update": "full"}),
    Call("apply_coord_spectral_denoise", {}),
    Call("apply_coord_spectral_denoise", {"noise_height": "0.3%", "keep_creases": False}),
    Call("apply_coord_spectral_equalizer", {"gain_8x": 1.75, "gain_1x": 0.0}),
    Call("apply_scalar_spectral_filter_per_vertex", {"feature_size": "10%"}),
    Call("apply_color_spectral_filter_per_vertex", {"feature_size": "10%", "stop_gain": 0.25}),
    Call("compute_scalar_spectral_artefacts_per_vertex", {"feature_size": "10%"}),
    Call("compute_scalar_manifold_harmonic_per_vertex", {"basis_size": 20, "mode": 3}),
    Call("get_geometry_spectrum", {"basis_size": 10}),
    Call("compute_scalar_surface_texture_per_vertex", {"waviness": "5%", "noise": "1%"}),
]
# Shape and changes as in tests/python/fuzz/meshes.py; the bunny is one of pymeshlab's.
SHAPES: dict[str, Any] = {
    "bunny": None,
    "closed": ("torus", 24, 16, 0.4),
    "open": ("grid", 20, 22, 0.3),
    "fins": ("torus", 22, 14, 0.3, ("fins", 3, 1.0), ("fins", 201, 1.0)),
    "hole": ("torus", 24, 14, 0.3, ("hole", 40, 1.0), ("hole", 41, 1.0)),
    "two components": ("torus", 26, 14, 0.4, ("second component", 0, 1.0)),
    "duplicate faces": ("grid", 18, 18, 0.1, ("duplicate face", 5, 1.0), ("flipped face", 9, 1.0)),
    "unused vertex": ("torus", 20, 20, 0.5, ("isolated vertex", 0, 1.0)),
    "needles": ("torus", 20, 18, 0.4, ("short edge", 33, 0.5), ("flat triangle", 77, 1.0)),
    "soup": ("soup", 200, 390, 7),
    "high valence": ("wheel", 250, True, 0.5),
}
Result = dict[str, Any]


def as_for_pymeshlab(value: Any) -> Any:
    if isinstance(value, str) and value.endswith("%"):
        return pymeshlab.PercentageValue(float(value[:-1]))
    return value


class Inputs(NamedTuple):
    V: NDArray[np.float64]
    F: NDArray[np.int32]
    quality: NDArray[np.float64]
    levels: NDArray[np.uint8]
    selected: NDArray[np.bool_]


def inputs_of(V: NDArray[np.float64], F: NDArray[np.int32]) -> Inputs:
    rng = np.random.default_rng(1)
    V = V + 1e-3 * rng.standard_normal(V.shape)
    return Inputs(
        np.ascontiguousarray(V),
        F.astype(np.int32),
        rng.random(len(V)),
        rng.integers(0, 256, (len(V), 3), dtype=np.uint8),
        V[:, 0] > V[:, 0].mean(),
    )


@pytest.fixture(scope="module")
def inputs(decimated: Any) -> Inputs:
    return inputs_of(*decimated("bunny.obj"))


@pytest.fixture(scope="module", params=SHAPES)
def every_inputs(request: pytest.FixtureRequest, decimated: Any) -> Inputs:
    if SHAPES[request.param] is None:
        return inputs_of(*decimated("bunny.obj"))
    shape = [each for each in SHAPES[request.param] if not isinstance(each, tuple)]
    changes = [each for each in SHAPES[request.param] if isinstance(each, tuple)]
    description = {"shape": shape, "changes": changes, "exponent": 0, "offset": 0, "spoiled": ""}
    made = shape_of(description)
    return inputs_of(made.V, made.triangles())


def made_for_pymeshlab(inputs: Inputs) -> pymeshlab.MeshSet:
    V, F, quality, levels, selected = inputs
    colors = np.column_stack([levels / 255, np.ones(len(V))])
    mesh_set = pymeshlab.MeshSet()
    mesh_set.add_mesh(pymeshlab.Mesh(V, F, v_scalar_array=quality, v_color_matrix=colors))
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


@pytest.mark.parametrize(
    ("name", "call"),
    [("filter", CALLS[0]), ("filter", CALLS[3]), ("denoise", CALLS[5]), ("denoise", CALLS[6])],
)
def test_the_command_gives_the_same_bits(
    name: str, call: Call, every_inputs: Inputs, tmp_path: Path
) -> None:
    V, F = every_inputs.V, every_inputs.F
    columns = [("x", "f8"), ("y", "f8"), ("z", "f8")]
    rows = np.array([tuple(v) for v in V], columns)
    faces = np.array([(face,) for face in F], [("vertex_indices", "i4", (3,))])
    elements = [plyfile.PlyElement.describe(r, n) for r, n in ((rows, "vertex"), (faces, "face"))]
    source, target = tmp_path / "in.ply", tmp_path / "out.ply"
    plyfile.PlyData(elements).write(source)
    options = [f"--{key.replace('_', '-')}={value}" for key, value in call.options.items()]
    options = ["--no-keep-creases" if "keep-creases" in each else each for each in options]
    done = command(name, source, target, *options)
    if refused_by_the_core(call, every_inputs):
        assert done.returncode != 0
        return
    assert done.returncode == 0, done.stderr
    read = plyfile.PlyData.read(target)["vertex"]
    result = np.column_stack([read[axis] for axis in "xyz"])
    np.testing.assert_array_equal(result, through_core(call, every_inputs)["vertices"])


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
