"""Workarounds for what pymeshlab does wrong after a filter has thrown.

pymeshlab 2025.7 keeps writing to the log of the MeshSet in which a filter last threw
(cnr-isti-vclab/PyMeshLab#384), even after that MeshSet is destroyed: the next load would crash. It
is therefore kept alive until another one takes its place. pymeshlab also replaces the
KeyboardInterrupt that has stopped a filter of this plugin with an exception of its own. Of wrong
arguments it names classes that it does not have (Percentage, AbsoluteValue), counts one choice too
many, and names no parameter whose value it cannot convert.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Callable
from typing import Any

from meshlab_spectral.other_words import instead_of

_PLAIN_SIZE = re.compile(r"Parameter (\w+): must be a pymeshlab\.Percentage")
_RANGE = re.compile(r"Must be a value between 0 and (\d+)")
_NOT_CONVERTED = re.compile("Unable to cast Python instance|incompatible function arguments")
_UNKNOWN = re.compile(r"Parameter (\w+) not found")
_PERCENT, _PERCENT_VALUE = "'2%' or '6e'", "pymeshlab.PercentageValue(2)"
_TOO_LARGE = 2**31
_STOPPED = "Details: cancelled"
_last_failed: Any = None


def keep_failed(mesh_set: Any) -> None:
    """Keep alive the MeshSet in which a filter has failed, instead of the previous one."""
    global _last_failed
    _last_failed = mesh_set


def is_interrupt(error: Exception) -> bool:
    """Whether a signal stopped the filter; nothing else cancels a filter called from Python."""
    return str(error).rstrip().endswith(_STOPPED)


def kept_when_failed(name: str, method: Callable[..., Any]) -> Callable[..., Any]:
    """Wrap a filter, a method of MeshSet, so that its MeshSet is kept alive when it throws.

    What pymeshlab says of wrong arguments is put right, in an exception of the same type.
    """

    @functools.wraps(method)
    def keeping(mesh_set: Any, *arguments: Any, **parameters: Any) -> Any:
        try:
            return method(mesh_set, *arguments, **parameters)
        except Exception as error:
            keep_failed(mesh_set)
            if is_interrupt(error):
                raise KeyboardInterrupt from None
            text = corrected(mesh_set, name, parameters, error)
            if text != str(error):
                raise type(error)(text) from None
            raise

    return keeping


def corrected(mesh_set: Any, name: str, parameters: dict[str, Any], error: Exception) -> str:
    """Return the text of an error that the filter `name` has thrown for these arguments."""
    text = str(error)
    if found := _PLAIN_SIZE.match(text):
        return (
            f"{found[1]}: must be a percentage or a length, pymeshlab.PercentageValue or "
            "pymeshlab.PureValue (RichPercentage in a script)"
        )
    if (unknown := _UNKNOWN.match(text)) and (instead := instead_of(unknown[1])):
        return f"{name} has no {unknown[1]}: {instead.replace(_PERCENT, _PERCENT_VALUE)}"
    if text.startswith("Enum "):
        return _no_such_choice(parameters, text)
    if _NOT_CONVERTED.search(text):
        return _wrong_types(parameters, mesh_set.filter_parameter_values(name)) or text
    return text


def _no_such_choice(parameters: dict[str, Any], reason: str) -> str:
    """Add the parameter to pymeshlab's message, and correct its range."""
    named = [
        name
        for name, value in parameters.items()
        if reason.startswith((f"Enum {value} not valid", f"Enum '{value}' not found"))
    ]
    found = _RANGE.search(reason)
    choices = f"choose 0 to {int(found[1]) - 1}" if found else reason
    return f"{' or '.join(named)} = {parameters[named[0]]}: {choices}" if named else reason


def _wrong_types(parameters: dict[str, Any], defaults: dict[str, Any]) -> str:
    """Name the parameters whose types are not those of their defaults; pymeshlab does not."""
    kinds = {bool: "true or false", int: "an integer of 32 bits", float: "a number", str: "a text"}
    wrong = [
        f"{name} = {value}: must be {kinds.get(type(defaults[name]), 'of another type')}"
        for name, value in parameters.items()
        if name in defaults and not _fits(value, type(defaults[name]))
    ]
    return "; ".join(wrong)


def _fits(value: Any, wanted: type) -> bool:
    if wanted is int:
        return isinstance(value, int) and abs(value) < _TOO_LARGE
    if wanted is float:
        return value is not None and not isinstance(value, str)
    return isinstance(value, wanted)
