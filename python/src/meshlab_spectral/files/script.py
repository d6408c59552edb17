"""MeshLab's filter scripts (.mlx), validated and applied filter by filter."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from meshlab_spectral.errors import FilterError, OptionError
from meshlab_spectral.filters.running import plain
from meshlab_spectral.plugin.failed_calls import keep_failed
from meshlab_spectral.plugin.loading import FILTERS, load
from meshlab_spectral.plugin.mesh_sets import call_filter, reason_of

_HEAD, _FOOT = "<!DOCTYPE FilterScript>\n<FilterScript>\n", "</FilterScript>\n"
# pymeshlab's only message for an unknown filter.
_UNKNOWN_FILTER = "Something really bad happened"


def apply_script(mesh_set: Any, text: str) -> dict[str, Any]:
    """Apply the text of a script to the current mesh of a MeshSet.

    Returns a dict with "filters", a list with the "name" of each filter and, for the plugin's, its
    "report"; pymeshlab returns no reports of other filters in a script.

    Raises OptionError when the text is not a filter script, or an empty one, and FilterError, which
    names the filter, when a filter is unknown or rejects the mesh.
    """
    load()
    done = []
    for number, single in enumerate(_filters(text), start=1):
        name = single.get("name", "")
        try:
            done.append({"name": name} | _apply(mesh_set, name, single))
        except FilterError as error:
            raise FilterError(f"filter {number} of the script, {name}: {error}") from error
    return {"filters": done}


def script_filters(text: str) -> list[str]:
    """Return the names of a script's filters, as in MeshLab's menus.

    Raises OptionError when the text is not a filter script, or an empty one.
    """
    return [single.get("name", "") for single in _filters(text)]


def _filters(text: str) -> list[ElementTree.Element]:
    """Parse the filters of a script; pymeshlab reads garbage as an empty script."""
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        raise OptionError(
            f"the script is not a MeshLab filter script ({error}): save one in MeshLab with "
            "Filters > Show current filter script, or with pymeshlab's save_filter_script"
        ) from error
    if root.tag != "FilterScript":
        raise OptionError(f"the script is not a MeshLab filter script but a <{root.tag}>")
    filters = [element for element in root if element.tag in ("filter", "xmlfilter")]
    if not filters:
        raise OptionError("the script has no filters: it would change nothing")
    try:
        for single in filters:
            ElementTree.tostring(single)
    except RecursionError as error:
        raise OptionError(
            "the script is not a MeshLab filter script: its filters are nested too deeply"
        ) from error
    return filters


def _apply(mesh_set: Any, name: str, single: ElementTree.Element) -> dict[str, Any]:
    import pymeshlab

    if name in FILTERS:
        parameters = dict(_parameter(element) for element in single.findall("Param"))
        return {"report": plain(call_filter(mesh_set, FILTERS[name], parameters))}
    mesh_set.clear_filter_script()
    _load_single(mesh_set, single)
    try:
        mesh_set.apply_filter_script()
    except pymeshlab.PyMeshLabException as error:
        keep_failed(mesh_set)
        reason = reason_of(error)
        if reason.startswith(_UNKNOWN_FILTER):
            reason = "MeshLab cannot run it: check that this version of MeshLab has it"
        raise FilterError(reason) from error
    return {}


def _load_single(mesh_set: Any, single: ElementTree.Element) -> None:
    content = _HEAD + ElementTree.tostring(single, encoding="unicode") + _FOOT
    with tempfile.TemporaryDirectory() as folder:  # Windows cannot read an open temporary file
        file = Path(folder, "script.mlx")
        file.write_text(content, encoding="utf-8")
        mesh_set.load_filter_script(str(file))


def _parameter(element: ElementTree.Element) -> tuple[str, Any]:
    """Convert a parameter to the name and value that pymeshlab takes."""
    name, kind, value = (element.get(key, "") for key in ("name", "type", "value"))
    try:
        return name, _value(kind, value)
    except ValueError:
        raise FilterError(f"its parameter {name} is not a {kind}: {value!r}") from None


def _value(kind: str, text: str) -> Any:
    import pymeshlab

    if kind == "RichBool":
        if text not in ("true", "false"):
            raise ValueError(text)
        return text == "true"
    if kind in ("RichInt", "RichEnum"):
        return int(text)
    if kind in ("RichFloat", "RichDynamicFloat"):
        return float(text)
    if kind in ("RichAbsPerc", "RichPercentage"):
        return pymeshlab.PureValue(float(text))
    return text
