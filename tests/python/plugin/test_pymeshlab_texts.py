"""What pymeshlab says of wrong arguments names the parameter, and classes that exist."""

from __future__ import annotations

import re
from typing import Any

import meshlab_spectral
import numpy as np
import pymeshlab
import pytest
import pyvista
from helpers import mesh_set_of
from meshlab_spectral.plugin.loading import FILTERS

_SPHERE = pyvista.Icosphere(nsub=1)
# By the type of a parameter's default.
WRONG: dict[type, list[Any]] = {
    int: ["a", 2.5, None, 2**40],
    float: ["a", None],
    str: [3, None],
    bool: [],  # pymeshlab takes any object for true or false
}


@pytest.fixture
def mesh_set() -> Any:
    meshlab_spectral.load()
    return mesh_set_of(np.array(_SPHERE.points), np.array(_SPHERE.regular_faces))


@pytest.mark.parametrize("name", FILTERS.values())
def test_wrong_types_name_their_parameter(name: str, mesh_set: Any) -> None:
    for parameter, default in mesh_set.filter_parameter_values(name).items():
        is_size = isinstance(default, pymeshlab.PercentageValue | pymeshlab.PureValue)
        for wrong in [2.0, "2%", None] if is_size else WRONG[type(default)]:
            with pytest.raises(
                Exception, match=rf"^{parameter}\b.*: (must be|choose|Enum)"
            ) as refused:
                getattr(mesh_set, name)(**{parameter: wrong})
            for named in re.findall(r"pymeshlab\.(\w+)", str(refused.value)):
                assert hasattr(pymeshlab, named)


def test_choices_are_counted_right(mesh_set: Any) -> None:
    name = FILTERS["Spectral Filter (Fractional)"]
    for number in range(5):  # the last one is custom
        getattr(mesh_set, name)(filter_type=number)
    with pytest.raises(pymeshlab.InvalidEnumException, match="filter_type = 5: choose 0 to 4"):
        getattr(mesh_set, name)(filter_type=5)
