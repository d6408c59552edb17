"""A promise: its name, its bound, and how its value is found."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import NamedTuple

import numpy as np

SHARED = Path(__file__).resolve().parents[4] / "shared"


class Absent(Exception):  # noqa: N818  (no error: a promise on that mesh is not asked)
    """A mesh is not there."""


class Bound(NamedTuple):
    """The least and the largest value that keep a promise."""

    low: float
    high: float

    def __str__(self) -> str:
        if self.low == self.high:
            return f"{self.high:g}"
        if np.isfinite(self).all():
            return f"{self.low:g} to {self.high:g}"
        return f"<= {self.high:g}" if self.low == -float("inf") else f">= {self.low:g}"


class Found(NamedTuple):
    """A value, and where it was found: the worst of several meshes."""

    value: float
    where: str = ""


class Promise(NamedTuple):
    """One row of the table; `ask` measures, and raises Absent where a mesh is missing."""

    name: str
    bound: Bound
    ask: Callable[[], float | Found]
    is_large: bool = False


promise = Promise


def at_most(value: float) -> Bound:
    return Bound(-float("inf"), value)


def at_least(value: float) -> Bound:
    return Bound(value, float("inf"))


def between(low: float, high: float) -> Bound:
    return Bound(low, high)


def exactly(value: float) -> Bound:
    return Bound(value, value)


def largest(found: Iterable[tuple[str, float]]) -> Found:
    """Return the largest of named values."""
    where, value = max(found, key=lambda one: one[1])
    return Found(value, where)


def shared(name: str) -> Path:
    """Return the path of a file in ../shared next to the repository."""
    path = SHARED / name
    if not path.exists():
        raise Absent(name)
    return path
