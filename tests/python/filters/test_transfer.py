"""The gains that figures draw are those of an independent implementation."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pytest
import pyvista
import spectral_reference as reference
from hypothesis import assume, event, given, settings
from hypothesis import strategies as st
from meshlab_spectral import filter_mesh
from meshlab_spectral.errors import OptionError
from meshlab_spectral.filters.option_types import Length
from meshlab_spectral.filters.options import FilterOptions
from meshlab_spectral.filters.transfer import MeshLengths, gain

LENGTHS = MeshLengths(feature_size=0.4, diagonal=8.0, mean_edge=0.05)


@pytest.mark.parametrize("response", ["gaussian", "butterworth", "ideal"])
@pytest.mark.parametrize("filter_type", ["low-pass", "high-pass", "band-pass", "band-stop"])
@pytest.mark.parametrize(
    "more",
    [{}, {"order": 5, "band_width": 0.5}, {"stop_gain": 1.0, "pass_gain": 2.5}],
    ids=["defaults", "order and width", "gains"],
)
def test_gains_agree(filter_type: Any, response: Any, more: dict[str, Any]) -> None:
    options = FilterOptions(
        filter_type=filter_type, response=response, feature_size=Length(0.4), **more
    )
    expected = reference.transfer_function(filter_type, 0.4, response, **more)
    x = np.geomspace(0.02, 30, 200)
    np.testing.assert_allclose(gain(options, x), expected(x * 2 * np.pi / 0.4), atol=1e-12)


def test_a_power_of_a_filter_is_the_power_of_its_gains() -> None:
    x = np.linspace(0.1, 4, 50)
    whole = FilterOptions(filter_type="band-pass", stop_gain=0.5, pass_gain=3.0)
    part = FilterOptions(filter_type="band-pass", stop_gain=0.5, pass_gain=3.0, power=0.3)
    np.testing.assert_allclose(gain(part, x), gain(whole, x) ** 0.3, rtol=1e-14)


@pytest.mark.parametrize(
    ("filter_type", "expected"),
    [("low-pass", 1), ("high-pass", 0), ("band-pass", 0), ("band-stop", 1)],
)
@pytest.mark.parametrize("response", ["gaussian", "butterworth", "ideal"])
def test_the_gain_at_frequency_zero_is_the_limit(
    filter_type: Any, response: Any, expected: float
) -> None:
    options = FilterOptions(filter_type=filter_type, response=response)
    assert gain(options, np.array([0.0])) == [expected]


def test_a_custom_expression_is_evaluated_as_python_would() -> None:
    options = FilterOptions(filter_type="custom", transfer_function="0.5 + exp(-w) + l/f^2")
    x = np.geomspace(0.02, 30, 200)
    np.testing.assert_allclose(gain(options, x, LENGTHS), 1.5 + np.exp(-x), rtol=1e-14)


def test_custom_points_are_interpolated_between_their_gains() -> None:
    options = FilterOptions(
        filter_type="custom", transfer_function="50%:1, 20%:3, 1:2.5, 6e:0, 2e:0.5", power=0.5
    )
    sizes, levels = [4, 1.6, 1, 0.3, 0.1], np.sqrt([1, 3, 2.5, 0.001, 0.5])
    np.testing.assert_allclose(gain(options, 0.4 / np.array(sizes), LENGTHS), levels, rtol=1e-12)
    for i, (large, small) in enumerate(itertools.pairwise(sizes)):
        between = gain(options, 0.4 / np.geomspace(large, small, 100), LENGTHS)
        assert np.all(np.diff(between) * (levels[i + 1] - levels[i]) >= 0)


# Texts in the languages of muParser and of Python, without parentheses but where these differ: who
# binds tighter is left to the two languages.
Texts = tuple[str, str]


def _joined(parts: tuple[Texts, tuple[str, str], Texts]) -> Texts:
    left, operator, right = parts
    return left[0] + operator[0] + right[0], left[1] + operator[1] + right[1]


def _same(*operators: str) -> list[tuple[str, str]]:
    return [(operator, operator) for operator in operators]


def _longer(texts: st.SearchStrategy[Texts]) -> st.SearchStrategy[Texts]:
    arithmetic = st.sampled_from([*_same("+", " - ", "*", "/"), ("^", "**")])
    comparison = st.sampled_from(_same("<", " <= ", ">", ">=", "==", " != "))
    logic = st.sampled_from([("&&", " and "), (" || ", " or ")])
    compared = st.tuples(texts, comparison, texts).map(_joined)
    condition = compared | st.tuples(compared, logic, compared).map(_joined)
    choice = st.tuples(condition, texts, texts).map(
        lambda t: (
            f"({t[0][0]} ? {t[1][0]}:{t[2][0]})",
            f"(({t[1][1]}) if {t[0][1]} else ({t[2][1]}))",
        )
    )
    call = st.tuples(st.sampled_from(["abs", "exp", "cos", "min", "max"]), texts, texts).map(
        lambda t: (
            f"{t[0]}({t[1][0]}, {t[2][0]})" if t[0].startswith("m") else f"{t[0]}({t[1][0]})",
            f"{t[0]}({t[1][1]}, {t[2][1]})" if t[0].startswith("m") else f"{t[0]}({t[1][1]})",
        )
    )
    group = (texts | condition).map(lambda t: (f"({t[0]})", f"({t[1]})"))
    return st.one_of(
        st.tuples(texts, arithmetic, texts).map(_joined),
        st.tuples(texts, arithmetic, texts).map(_joined),
        group,
        call,
        choice,
        condition,
    )


_EXPRESSIONS = st.recursive(
    st.sampled_from([*_same("w", "w", "1", "2", "0.5", "-w", "1e-1", ".25", "3.")]), _longer
)


def _by_python(text: str, w: float) -> Any:
    """Evaluate a gain; NaN where it has none, be it by a pole or a root of a negative number."""
    names = {"w": w, "abs": abs, "exp": math.exp, "cos": math.cos, "min": min, "max": max}
    try:
        value = eval(text, {"__builtins__": {}}, names)
    except (ArithmeticError, TypeError):  # TypeError: comparison of complex numbers
        return math.nan
    return math.nan if isinstance(value, complex) else float(value)


@settings(max_examples=500)
@given(_EXPRESSIONS)
def test_an_expression_means_what_it_means_in_python_or_is_refused(texts: Texts) -> None:
    w = np.array([0.37, 1.0, 2.9])
    bounded = "min(abs({}), 1e3)"  # a gain must be finite and not negative at every w
    expected = np.array([_by_python(bounded.format(texts[1]), x) for x in w.tolist()])
    assume(np.isfinite(expected).all())
    options = FilterOptions(filter_type="custom", transfer_function=bounded.format(texts[0]))
    try:
        actual = gain(options, w, LENGTHS)
    except OptionError as error:
        chains, has_no_value = "a second comparison" in str(error), "is nan" in str(error)
        event("refused" if chains else "no value somewhere")
        if not chains and not has_no_value:
            raise
        return
    event("agrees")
    np.testing.assert_allclose(actual, expected, rtol=1e-9, atol=1e-9)


@given(
    st.lists(
        st.tuples(st.integers(1, 100), st.integers(1, 40)),
        min_size=2,
        max_size=6,
        unique_by=lambda p: p[0],
    ),
    st.sampled_from([":", " : ", ": "]),
    st.sampled_from([",", ", ", " , "]),
)
def test_points_have_their_gains(points: list[tuple[int, int]], colon: str, comma: str) -> None:
    text = comma.join(f"{size}%{colon}{level / 8}" for size, level in points)
    options = FilterOptions(filter_type="custom", transfer_function=text)
    w = np.array([0.4 / (0.08 * size) for size, _ in points])
    np.testing.assert_allclose(gain(options, w, LENGTHS), [level / 8 for _, level in points])


@given(
    st.lists(st.integers(1, 9), min_size=2, max_size=4, unique=True),
    st.sampled_from(["{};", "{} ", "{}:", "{}=", "{},5,", "{}"]),
)
def test_points_that_are_joined_otherwise_are_refused(sizes: list[int], joint: str) -> None:
    text = "".join(joint.format(f"{size}%:1") for size in sizes)
    options = FilterOptions(filter_type="custom", transfer_function=text)
    with pytest.raises(OptionError, match="at character"):
        gain(options, np.ones(1), LENGTHS)


def test_one_point_is_refused_with_the_band_that_it_means() -> None:
    """It would double the whole shape: a user has asked for details of one size."""
    remedy = r"one point .* band-pass with feature_size = 5%, pass_gain = 2 and stop_gain = 1"
    with pytest.raises(OptionError, match=remedy):
        gain(FilterOptions(filter_type="custom", transfer_function=" 5% : 2"), np.ones(1), LENGTHS)
    sphere = pyvista.Icosphere(nsub=2)
    with pytest.raises(OptionError, match=remedy):
        filter_mesh(sphere, filter_type="custom", transfer_function="5%:2")
    filter_mesh(sphere, filter_type="band-pass", feature_size="5%", pass_gain=2, stop_gain=1)


def test_a_custom_function_needs_the_lengths_of_a_mesh() -> None:
    with pytest.raises(OptionError, match="needs the lengths of a mesh"):
        gain(FilterOptions(filter_type="custom"), np.ones(1))
