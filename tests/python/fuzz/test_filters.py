"""Any mesh, any filter, any parameters: a result or an error that helps, and nothing in between.

`worker.py` has the contract. `make fuzz-python` tries other examples, and more of them.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from fuzz.judge import Judge
from fuzz.meshes import Description, descriptions
from fuzz.parameters import PARAMETERS, calls
from fuzz.runs import as_many_as
from hypothesis import event, example, given
from meshlab_spectral.plugin.loading import FILTER_NAME, FILTERS


@pytest.fixture(scope="module")
def judge() -> Iterator[Judge]:
    judge = Judge()
    yield judge
    judge.end()


def test_every_filter_is_called() -> None:
    assert PARAMETERS.keys() == set(FILTERS.values())


EMPTIED = {
    "shape": ("triangle",),
    "changes": [],
    "exponent": 0,
    "offset": 0.0,
    "spoiled": "",
    "where": 0,
    "polygons": False,
    "deleted": "everything",
    "transform": "",
    "selected": "",
}


@as_many_as(150)
@given(descriptions(), calls())
@example(EMPTIED, (FILTER_NAME, {"filter_type": 4}))  # was measured before it was checked
def test_a_filter_gives_a_finite_result_or_an_error_and_an_unchanged_mesh(
    judge: Judge, mesh: Description, call: tuple[str, dict[str, Any]]
) -> None:
    name, parameters = call
    verdict = judge({"mesh": mesh, "filter": name, "parameters": parameters})
    event(f"{name}: {verdict['outcome']}")
    assert verdict["failures"] == [], verdict
