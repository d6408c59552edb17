"""The gains that figures draw are those of an independent implementation."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import spectral_reference as reference
from meshlab_spectral.filters.options import FilterOptions, Length
from meshlab_spectral.filters.transfer import gain


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
