"""The package's table of options is the plugin's own table of parameters."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, cast, get_args, get_type_hints

import numpy as np
import pymeshlab
import pytest
from helpers import FILTER, loaded, mesh_set_of, refusal
from meshlab_spectral import (
    DenoiseOptions,
    FilterOptions,
    Length,
    OptionError,
    denoise_mesh,
    filter_mesh,
)
from shared_types import Decimated

CHOICES = {
    name: get_args(type_)
    for name, type_ in get_type_hints(FilterOptions).items()
    if get_args(type_)
}


@pytest.fixture
def tetrahedron() -> pymeshlab.MeshSet:
    return mesh_set_of(
        [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
    )


def test_names_order_and_defaults_are_those_of_the_plugin(tetrahedron: pymeshlab.MeshSet) -> None:
    parameters = tetrahedron.filter_parameter_values(FILTER)
    for plugin_own in ("color_by_displacement", "keep_original"):
        assert parameters.pop(plugin_own) is False
    expected: dict[str, Any] = FilterOptions().as_dict()
    assert list(parameters) == list(expected)
    diagonal = tetrahedron.current_mesh().bounding_box().diagonal()
    for name, value in parameters.items():
        default = expected[name]
        if name in CHOICES:
            assert CHOICES[name][value] == default, name
        elif name == "feature_size":
            assert default == "auto"  # of a mesh as coarse as this: 5 %
            assert value == pytest.approx(0.05 * diagonal)
        elif name == "max_displacement":
            assert (value, default) == (0.0, "auto")  # no bound
        elif name == "tolerance":
            assert f"{100 * value / diagonal:g}%" == default
        else:
            assert value == default, name
            assert type(value) is type(default), name


def test_the_feature_size_of_a_fine_mesh_is_six_mean_edges(samples: Path) -> None:
    ms = loaded(samples / "bunny.obj")
    V, F = ms.current_mesh().vertex_matrix(), ms.current_mesh().face_matrix()
    edges = np.linalg.norm(V[F] - V[np.roll(F, 1, axis=1)], axis=2)
    size = ms.filter_parameter_values(FILTER)["feature_size"]
    assert size == pytest.approx(6 * edges.mean(), rel=1e-6)
    assert ms.apply_filter(FILTER)["feature_size"] == pytest.approx(size, rel=1e-6)


def test_an_automatic_length_is_its_default() -> None:
    names = ("feature_size", "tolerance", "max_displacement")
    assert (
        FilterOptions.from_dict({"feature_size": "auto", "max_displacement": 0}) == FilterOptions()
    )
    one, other = FilterOptions(), FilterOptions.from_dict(dict.fromkeys(names, "auto"))
    assert one.sizes(100.0, 0.5, 80.0) == other.sizes(100.0, 0.5, 80.0)
    sizes = {"feature_size": 3.0, "tolerance": float(np.float32(0.04)), "max_displacement": None}
    assert one.sizes(100.0, 0.5, 80.0) == sizes


@pytest.mark.parametrize("name", CHOICES)
def test_choices_and_their_order_are_those_of_the_plugin(
    name: str, tetrahedron: pymeshlab.MeshSet
) -> None:
    with pytest.raises(pymeshlab.InvalidEnumException) as error:
        tetrahedron.apply_filter(FILTER, **{name: "no such choice"})
    offered = str(error.value).split("Possible values are")[1]
    assert tuple(re.findall(r"'([^']*)'", offered)) == CHOICES[name]


OUT_OF_RANGE = [
    ("order", 0, {"response": "butterworth"}),
    ("order", 65, {"response": "butterworth"}),
    ("band_width", 0.0, {"filter_type": "band-pass"}),
    ("band_width", -1.0, {"filter_type": "band-pass"}),
    ("pass_gain", -0.5, {}),
    ("pass_gain", float("inf"), {}),
    ("stop_gain", -0.5, {}),
    ("stop_gain", float("nan"), {}),
    ("power", 0.0, {}),
    ("power", 1.5, {}),
    ("conformal_share", 1.5, {}),
    ("conformal_share", float("nan"), {}),
    ("power", 1e-60, {}),
    ("pass_gain", 1e39, {}),
    ("steps", -3, {}),
    ("basis_size", 0, {"spectrum": "truncated"}),
]


@pytest.mark.parametrize(("name", "value", "where"), OUT_OF_RANGE)
def test_table_and_plugin_refuse_the_same_values_and_name_the_option(
    name: str, value: float, where: dict[str, Any], tetrahedron: pymeshlab.MeshSet
) -> None:
    with pytest.raises(OptionError, match=name):
        FilterOptions(**{name: value})
    assert name in refusal(tetrahedron, **where, **{name: value})


@pytest.mark.parametrize("name", CHOICES)
def test_an_unknown_choice_is_refused_with_the_choices(name: str) -> None:
    with pytest.raises(OptionError, match=CHOICES[name][0]):
        FilterOptions(**{name: "no such choice"})  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("steps", 2.5),
        ("steps", "ten"),
        ("steps", True),
        ("order", None),
        ("pass_gain", "2"),
        ("band_width", True),
        ("reinject_residual", 1),
        ("feature_size", True),
    ],
)
def test_a_value_of_the_wrong_type_is_refused_by_the_name_of_the_option(
    name: str, value: Any
) -> None:
    with pytest.raises(OptionError, match=name):
        FilterOptions(**{name: value})


@pytest.mark.parametrize(
    ("name", "value", "same"),
    [
        ("stop_gain", np.array(0.5), 0.5),
        ("power", np.float32(0.5), 0.5),
        ("steps", np.array(5), 5),
        ("steps", np.int8(5), 5),
        ("max_displacement", np.array(0.5), 0.5),
        ("preserve_volume", np.True_, True),
    ],
)
def test_numbers_of_numpy_are_numbers(name: str, value: Any, same: float) -> None:
    assert FilterOptions(**{name: value}) == FilterOptions(**{name: same})


@pytest.mark.parametrize("value", [np.array(2.5), np.array([5]), np.array(True)])
def test_arrays_that_are_no_count_are_refused(value: Any) -> None:
    with pytest.raises(OptionError, match="steps = "):
        FilterOptions(steps=value)


@pytest.mark.parametrize(
    ("text", "value", "unit"),
    [("5%", 5, "%"), (" 2.5 % ", 2.5, "%"), ("0.02", 0.02, ""), ("1e3", 1000, ""), ("6e", 6, "e")],
)
def test_a_feature_size_is_a_percentage_mean_edges_or_a_length(
    text: str, value: float, unit: Any
) -> None:
    assert Length.parse(text) == Length(value, unit)
    assert FilterOptions(feature_size=cast(Any, text)).feature_size == Length(value, unit)


def test_a_number_is_a_length_in_the_units_of_the_mesh() -> None:
    assert FilterOptions(feature_size=cast(Any, 3)).feature_size == Length(3)
    with pytest.raises(OptionError, match=r"feature_size = -1: .*percentage"):
        FilterOptions(feature_size=cast(Any, -1))


def test_options_may_be_given_as_one_object_or_by_name(decimated: Decimated) -> None:
    V, F = decimated("cow.obj", 1000)
    by_name, _ = filter_mesh(V, F, feature_size="10%", steps=1)
    as_object, _ = filter_mesh(V, F, FilterOptions(feature_size=Length(10, "%"), steps=1))
    np.testing.assert_array_equal(by_name, as_object)
    with pytest.raises(OptionError, match="one object or by name"):
        filter_mesh(V, F, FilterOptions(), steps=1)
    with pytest.raises(OptionError, match="DenoiseOptions"):
        filter_mesh(V, F, cast(Any, DenoiseOptions()))
    same, _ = denoise_mesh(V, F, DenoiseOptions(strength=0))
    np.testing.assert_array_equal(same, V)


def test_a_size_in_mean_edges_is_that_length(decimated: Decimated) -> None:
    V, F = decimated("bunny.obj", 1000)
    edges = [np.linalg.norm(V[F[:, i]] - V[F[:, (i + 1) % 3]], axis=1) for i in range(3)]
    _, report = filter_mesh(V, F, feature_size="7.5e", steps=1)
    assert report["feature_size"] == pytest.approx(7.5 * np.mean(edges), rel=1e-6)


@pytest.mark.parametrize(
    "text", ["", "%", "five", "0", "0%", "-3%", "nan", "inf", "120%", "5 mm", "e", "6ee"]
)
def test_a_malformed_feature_size_is_refused_with_an_example(text: str) -> None:
    with pytest.raises(OptionError, match="percentage"):
        Length.parse(text)


def test_options_survive_a_round_trip_through_plain_values() -> None:
    options = FilterOptions(
        filter_type="band-pass", feature_size=Length(0.3), pass_gain=2.5, stop_gain=1.0
    )
    assert FilterOptions.from_dict(options.as_dict()) == options


def test_an_unknown_option_is_refused_by_name() -> None:
    with pytest.raises(OptionError, match="feature_sise"):
        FilterOptions.from_dict({"feature_sise": "5%"})
