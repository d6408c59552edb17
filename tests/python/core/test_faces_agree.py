"""Every filter gives the same bits through pymeshlab and through the package's own module."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import Any, NamedTuple

import numpy as np
import pymeshlab
import pytest
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
]
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


@pytest.fixture(scope="module")
def inputs(decimated: Any) -> Inputs:
    V, F = decimated("bunny.obj")
    rng = np.random.default_rng(1)
    V = V + 1e-3 * rng.standard_normal(V.shape)
    return Inputs(
        np.ascontiguousarray(V),
        F.astype(np.int32),
        rng.random(len(V)),
        rng.integers(0, 256, (len(V), 3), dtype=np.uint8),
        V[:, 0] > V[:, 0].mean(),
    )


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
        "report": result["report"],
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


@pytest.mark.parametrize("call", CALLS)
def test_pymeshlab_and_the_module_give_the_same_bits(call: Call, inputs: Inputs) -> None:
    assert_same(through_core(call, inputs), through_pymeshlab(call, made_for_pymeshlab(inputs)))


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
