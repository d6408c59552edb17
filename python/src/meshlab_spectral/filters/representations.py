"""What notebooks and consoles show of a result: a line or a table, never screens of numbers."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import fields
from html import escape
from typing import Any

import numpy as np

# Lists up to this length are shown whole.
_SHORT = 6


class Report(dict[str, Any]):
    """A report, a dict: printed, its long lists are given by their lengths and ranges."""

    def __repr__(self) -> str:
        return "{" + ", ".join(f"{name!r}: {brief(value)}" for name, value in self.items()) + "}"

    def _repr_html_(self) -> str:
        return table((name, brief(value)) for name, value in self.items())


def brief(value: Any) -> str:
    """Return a short text for a value of a report or a result."""
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, Mapping):
        return repr(Report(value))
    if isinstance(value, np.ndarray | list | tuple):
        if len(value) <= _SHORT and np.ndim(value) < 2:
            return "[" + ", ".join(map(brief, np.asarray(value).tolist())) + "]"
        numbers = np.asarray(value)
        shape = " x ".join(map(str, numbers.shape))
        if not np.issubdtype(numbers.dtype, np.number):
            return f"<{shape} entries>"
        return f"<{shape} numbers, {brief(float(numbers.min()))} to {brief(float(numbers.max()))}>"
    return repr(value)


def line(result: Any) -> str:
    """Return the representation of a dataclass in which arrays are short."""
    values = (f"{field.name}={brief(getattr(result, field.name))}" for field in fields(result))
    return f"{type(result).__name__}({', '.join(values)})"


def table(rows: Iterable[tuple[str, ...]], header: tuple[str, ...] = ()) -> str:
    """Return an HTML table."""
    body = [f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in rows]
    if header:
        body.insert(0, f"<tr>{''.join(f'<th>{escape(cell)}</th>' for cell in header)}</tr>")
    return f"<table>{''.join(body)}</table>"
