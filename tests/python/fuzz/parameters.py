"""Parameters of every filter, within, at and beyond their limits, as hypothesis draws them."""

from __future__ import annotations

from typing import Any

import pymeshlab
from hypothesis import strategies as st
from meshlab_spectral._core import filters

NAN, INFINITY = float("nan"), float("inf")
LARGEST_INTEGER = 2**31 - 1

# A size is ("%", percent of the diagonal) or ("length", in units of the mesh): plain for JSON.


def _of(within: tuple[Any, ...], beyond: tuple[Any, ...]) -> st.SearchStrategy[Any]:
    """Draw mostly values that are within the limits or at them."""
    one_in_twenty = st.integers(0, 19)
    return one_in_twenty.flatmap(lambda k: st.sampled_from(beyond if k == 19 else within))


_PERCENTAGES = _of((5.0, 15.0, 50.0, 100.0, 1.0, 0.01, 1e-9), (150.0, 1e6, 0.0, -5.0, NAN))
_LENGTHS = _of((1.0, 0.1, 1e-3, 1e-30, 1e-300, 1e30, 1e300), (0.0, -1.0, NAN, INFINITY))
# ("%", percent of the diagonal) or ("length", in units of the mesh): plain, for JSON.
_SIZES = st.one_of(st.tuples(st.just("%"), _PERCENTAGES), st.tuples(st.just("length"), _LENGTHS))
_GAINS = _of(
    (1.0, 0.0, 0.05, 0.5, 2.0, 10.0, 1e-30, 1e-60, 1e6, 1e30, -0.0),
    (1e39, -1e-9, -1.0, NAN, INFINITY),
)
# Those of a parameter, whichever filters have it, or else of its kind.
_BY_NAME = {
    "transfer_function": _of(
        ("20%:1, 5%:2, 1%:0.1", "6e:0.5", "1/(1 + w^4)", "w < 1", "1 + exp(-l/f)", "0"),
        ("", ":", "5%", "1 - w", "q", "5%:1,5%:2", "0*log(-w)", "w/0", "(" * 500, "1e999"),
    ),
    "band_width": _of((1.0, 2.0, 0.3, 1e-6, 60.0, 1e30), (1e-60, 0.0, -1.0, NAN)),
    "order": _of((2, 1, 8, 64), (0, 65, -1, LARGEST_INTEGER)),
    "power": _of((1.0, 0.5, 0.1, 1e-9), (1e-60, 0.0, -0.1, 1.000001, 2.0, NAN)),
    "steps": _of((0, 1, 2, 3, 10, 20), (-1, -LARGEST_INTEGER)),
    "passes": _of((0, 1, 2, 3), (-1, 10, 1000)),
    "conformal_share": _of((1.0, 0.5, 0.1, 1e-9, 1e-60, 0.0), (-0.1, 1.000001, 2.0, NAN)),
    "crease_angle": _of((0.0, 30.0, 60.0, 90.0, 180.0, 1e-30), (-1.0, 180.1, NAN, INFINITY)),
    "strength": _of((1.0, 0.5, 3.0, 0.0, 1e-30, 1e30), (-1.0, NAN, INFINITY)),
    "mode": _of((1, 0, 2, 4), (19, -1, LARGEST_INTEGER)),
}
_BY_KIND = {
    "bool": st.booleans(),
    "length": _SIZES,
    "float": _GAINS,
    "int": _of((5, 2, 3, 20, 49, 100), (1, 0, -1, 10_000, LARGEST_INTEGER)),
}


def _values_of(parameter: dict[str, Any]) -> st.SearchStrategy[Any]:
    if parameter["kind"] == "choice":
        count = len(parameter["choices"])
        return _of(tuple(range(count)), (-1, count))
    name = parameter["name"]
    return _BY_NAME[name] if name in _BY_NAME else _BY_KIND[parameter["kind"]]


PARAMETERS: dict[str, dict[str, st.SearchStrategy[Any]]] = {
    one["python_name"]: {each["name"]: _values_of(each) for each in one["parameters"]}
    for one in filters()
}


@st.composite
def calls(draw: st.DrawFn) -> tuple[str, dict[str, Any]]:
    """Draw the name of a filter and some of its parameters; half of the calls are the first's."""
    names = tuple(PARAMETERS)
    name = draw(st.sampled_from((*names[:1] * 3, *names[1:])))
    # One at a time: with all of them drawn, hardly a call would be valid.
    chosen = draw(st.lists(st.sampled_from(tuple(PARAMETERS[name])), max_size=5, unique=True))
    return name, {parameter: draw(PARAMETERS[name][parameter]) for parameter in chosen}


def for_pymeshlab(parameters: dict[str, Any]) -> dict[str, Any]:
    """Turn the sizes among the parameters into pymeshlab's types."""
    kinds = {"%": pymeshlab.PercentageValue, "length": pymeshlab.PureValue}
    return {
        name: kinds[value[0]](value[1]) if isinstance(value, tuple | list) else value
        for name, value in parameters.items()
    }
