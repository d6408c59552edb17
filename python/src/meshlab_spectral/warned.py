"""Warnings: texts, each with a code that says what it is about, whatever numbers it has."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from itertools import zip_longest
from typing import Any

# Of files and of Python's own; those of the filters are `_core.warning_kinds`.
KINDS = {
    "added_normals": "a file gets normals that it did not have",
    "beyond_rim": "part of a surface is left out of a comparison",
    "cut_file": "a file ends early, and may be incomplete",
    "double_precision": "coordinates are written in double precision, as single rounds too much",
    "format_loss": "the output's format cannot hold all that the input has",
    "kept_in_file": "what depends on the coordinates stays as it is in the file",
    "labels": "integers that may be labels are averaged",
    "parted_meshes": "meshes part that had vertices in common",
    "placement": "a mesh is placed several times, or with a scale of 0",
    "rounded": "the output's format rounds too much for what the filter does",
    "side_file": "a file that belongs to the mesh is not copied as it is",
    "skeleton": "a mesh is measured without its pose",
    "subdivided": "the cage of a subdivision surface is filtered",
    "uncompressed": "a file is written without its compression",
    "unequal_sizes": "two meshes may have different units",
}


class Warned(str):
    """The text of a warning; programs compare its code instead."""

    code: str

    def __new__(cls, code: str, text: str) -> Warned:  # noqa: D102
        self = super().__new__(cls, text)
        self.code = code
        return self

    def __getnewargs__(self) -> tuple[str, str]:  # type: ignore[override]
        return self.code, str(self)

    @property
    def kind(self) -> tuple[str, str]:
        """Code and text without numbers: a code has several, such as one for each unused option."""
        return self.code, re.sub(r"\d[\d.e+-]*", "0", self)

    def of(self, name: str) -> Warned:
        """Return the warning with the name of what it is about, if any."""
        return Warned(self.code, f"{name}: {self}") if name else self


def warned(report: Mapping[str, Any]) -> list[Warned]:
    """Return the warnings of a report, which may have come as JSON."""
    texts, codes = report.get("warnings", []), report.get("warning_codes", [])
    return [Warned(code, text) for text, code in zip_longest(texts, codes, fillvalue="")]


def with_warnings(report: Mapping[str, Any], warnings: Iterable[Warned]) -> dict[str, Any]:
    """Return a report with these warnings instead of its own, and with their codes."""
    every = list(warnings)
    codes = [one.code for one in every]
    return {**report, "warnings": every, "warning_codes": codes}
