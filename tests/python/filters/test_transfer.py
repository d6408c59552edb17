"""The gains that figures draw are those of an independent implementation."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest
import spectral_reference as reference
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


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("1/(1 + q)", "character 8"),
        ("5%:1, 2%", "character 6"),
        ("1 - w", "transfer_function is -"),
        ("", "character 1"),
    ],
)
def test_an_invalid_custom_function_is_refused(text: str, words: str) -> None:
    options = FilterOptions(filter_type="custom", transfer_function=text)
    with pytest.raises(OptionError, match=words):
        gain(options, np.ones(1), LENGTHS)


def test_a_custom_function_needs_the_lengths_of_a_mesh() -> None:
    with pytest.raises(OptionError, match="needs the lengths of a mesh"):
        gain(FilterOptions(filter_type="custom"), np.ones(1))
