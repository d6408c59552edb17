"""Mistakes in a MeshLab script are named, by the package and by the plugin itself."""

from __future__ import annotations

from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pymeshlab
import pytest
from helpers import FILTER, mesh_set_of
from meshlab_spectral.errors import FilterError, OptionError
from meshlab_spectral.files.script import apply_script
from meshlab_spectral.plugin.failed_calls import keep_failed
from meshlab_spectral.plugin.mesh_sets import call_filter

ENUMERATIONS = {
    "filter_type": 5,
    "response": 3,
    "basis_update": 3,
    "spectrum": 2,
    "laplacian": 3,
    "boundary": 2,
    "weight": 2,
}
WRONG = [
    ("steps", "RichInt", "2.5", "steps is not a RichInt"),
    ("steps", "RichInt", "4294967296", "steps = 4294967296: must be an integer"),
    ("steps", "RichFloat", "2", "steps = 2.0: must be an integer"),
    ("steps", "RichFloat", "nan", "steps = nan: must be an integer"),
    ("steps", "RichString", "ten", "steps = ten: must be an integer"),
    ("pass_gain", "RichString", "x", "pass_gain = x: must be a number"),
    ("pass_gain", "RichFloat", "nan", "pass_gain = nan"),
    ("pass_gain", "RichFloat", "1e300", "pass_gain = inf"),
    ("filter_type", "RichEnum", "5", "filter_type = 5: choose 0 to 4"),
    ("filter_type", "RichEnum", "-1", "filter_type = -1: choose 0 to 4"),
    ("filter_type", "RichString", "lowpass", "filter_type = lowpass.*low-pass"),
    ("feature_size", "RichFloat", "0.3", "feature_size: must be a percentage or a length"),
    ("feature_size", "RichPercentage", "inf", "feature_size = inf"),
    ("reinject_residual", "RichBool", "yes", "reinject_residual is not a RichBool"),
    ("no_such", "RichInt", "1", "no_such not found"),
]


@pytest.fixture
def tetrahedron() -> pymeshlab.MeshSet:
    return mesh_set_of(
        [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
    )


@pytest.mark.parametrize(("name", "kind", "value", "named"), WRONG)
def test_a_wrong_parameter_is_named(
    name: str, kind: str, value: str, named: str, tetrahedron: pymeshlab.MeshSet
) -> None:
    parameter = f'<Param name="{name}" type="{kind}" value="{value}"/>'
    text = (
        f'<FilterScript><filter name="Spectral Filter (Fractional)">{parameter}</filter>'
        "</FilterScript>"
    )
    with pytest.raises(FilterError, match=named) as error:
        apply_script(tetrahedron, text)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("parameters", "named"),
    [
        ({"steps": "ten"}, "steps = ten: must be an integer"),
        ({"steps": 10**24, "pass_gain": None}, "steps = 1000.*; pass_gain = None: must be a num"),
        ({"feature_size": None}, "feature_size = None: must be a number"),
        ({"filter_type": 99}, "filter_type = 99: choose 0 to 4"),
    ],
)
def test_a_wrong_type_is_named(
    parameters: dict[str, Any], named: str, tetrahedron: pymeshlab.MeshSet
) -> None:
    with pytest.raises(FilterError, match=named):
        call_filter(tetrahedron, FILTER, parameters)


@pytest.mark.parametrize("name", ENUMERATIONS)
@pytest.mark.parametrize("beyond", [-1, "end", 99])
def test_the_plugin_itself_refuses_an_unknown_choice(
    beyond: int | str, name: str, tetrahedron: pymeshlab.MeshSet, tmp_path: Path
) -> None:
    value = ENUMERATIONS[name] if beyond == "end" else beyond
    path = tmp_path / "script.mlx"
    tetrahedron.apply_filter(FILTER, steps=1)
    tetrahedron.save_filter_script(str(path))
    script = ElementTree.parse(path)
    for parameter in script.iter("Param"):
        if parameter.get("name") == name:
            parameter.set("value", str(value))
    path.write_text("<!DOCTYPE FilterScript>\n" + ElementTree.tostring(script.getroot(), "unicode"))
    keep_failed(tetrahedron)
    tetrahedron.clear_filter_script()
    tetrahedron.load_filter_script(str(path))
    with pytest.raises(pymeshlab.PyMeshLabException, match=rf"{name} = {value}: choose 0 \("):
        tetrahedron.apply_filter_script()


def test_a_deep_script_is_refused(tetrahedron: pymeshlab.MeshSet) -> None:
    deep = 5000 * "<a>" + 5000 * "</a>"
    with pytest.raises(OptionError, match="nested"):
        apply_script(tetrahedron, f'<FilterScript><filter name="x">{deep}</filter></FilterScript>')
