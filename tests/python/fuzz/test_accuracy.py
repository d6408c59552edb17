"""Where a filter says that its accuracy is reached, all eigenvectors agree.

The core's own fuzzer (tests/fuzz) checks the same against its own reference; this one is SciPy's.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import spectral_reference as reference
from fuzz.meshes import shape_of
from fuzz.runs import as_many_as
from helpers import diagonal, filter_arrays, largest_distance, percent
from hypothesis import event, given
from hypothesis import strategies as st
from transfer_functions import gain_of

ACCURACY = 1e-6  # of the diagonal, requested by a filter with given steps
LEEWAY = 3.0

_sides = st.integers(4, 17)  # at most 289 vertices
_SHAPES = st.one_of(
    st.tuples(st.just("torus"), _sides, _sides, st.sampled_from((0.4, 0.1, 0.9))),
    st.tuples(st.just("grid"), _sides, _sides, st.sampled_from((0.3, 0.0, 2.0))),
    st.tuples(st.just("wheel"), st.integers(5, 250), st.booleans(), st.sampled_from((0.3, 3.0))),
)
_NOISE = st.tuples(
    st.just("noise"), st.integers(0, 999), st.sampled_from((1.0, 0.8, 0.6, 0.4, 0.01))
)
_TRANSFER = st.fixed_dictionaries(
    {
        "filter_type": st.sampled_from(("low-pass", "high-pass", "band-pass", "band-stop")),
        "response": st.sampled_from(("gaussian", "butterworth")),
        "order": st.sampled_from((1, 2, 4, 8, 16)),
        "band_width": st.sampled_from((2.0, 1.0, 0.3, 0.1, 0.03, 0.01)),
        "pass_gain": st.sampled_from((1.0, 0.5, 2.0, 3.0)),
        "stop_gain": st.sampled_from((0.0, 0.3, 1.0)),
        "laplacian": st.sampled_from(("cotangent", "intrinsic delaunay", "uniform")),
    }
)


@as_many_as(60, share=0.1)
@given(_SHAPES, _NOISE, st.sampled_from((3, 8, 15, 30, 45, 70, 100)), _TRANSFER)
def test_claimed_accuracy_is_true(
    shape: tuple[Any, ...], noise: tuple[Any, ...], size: int, options: dict[str, Any]
) -> None:
    made = shape_of(
        {"shape": shape, "changes": [noise], "exponent": 0, "offset": 0.0, "spoiled": ""}
    )
    V, F = made.V, made.triangles()
    options = {"feature_size": percent(size), **options}
    Y, report = filter_arrays(V, F, steps=1, **options)
    event(f"accuracy reached: {report['accuracy_reached']}")
    if not report["accuracy_reached"]:
        return
    expected = reference.full_filter(
        V, F.astype(np.int64), gain_of(options, report), 1, "none", options["laplacian"]
    )
    claimed = max(ACCURACY, report["error_estimate"])
    assert largest_distance(Y, expected) <= LEEWAY * claimed * diagonal(V)
