"""Sphinx: signatures as they are written, and the tables of options with the help of fields."""

from __future__ import annotations

import inspect
import re
from dataclasses import fields
from typing import Any

from meshlab_spectral.filters.option_types import Options
from sphinx.application import Sphinx


def keep_signature(
    app: Sphinx, what: str, name: str, obj: Any, options: Any, signature: str, returns: str
) -> tuple[str, str] | None:
    """Keep the names of types: autodoc would write out what ArrayLike stands for."""
    if what != "function":
        return None
    # Annotations are strings, as they are not evaluated.
    text = re.sub(r"(: |-> )'([^']*)'", r"\1\2", str(inspect.signature(obj)))
    written, _, result = text.rpartition(" -> ")
    return written, result


def shorten_arrays(
    app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]
) -> None:
    """Call an array an array: napoleon writes out what NDArray stands for."""
    for number, line in enumerate(lines):
        lines[number] = re.sub(r"numpy\.ndarray\[.*?\]\]", "array", line)


def keep_descriptions(
    app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]
) -> None:
    """Keep napoleon from reading "Length; 0: none" as a type and what it is for."""
    if what == "attribute" and lines:
        lines[0] = f": {lines[0]}"


def list_fields(
    app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]
) -> None:
    """Add the fields to the docstring of a table of options."""
    if not isinstance(obj, type) or not issubclass(obj, Options):
        return
    lines += ["", ".. rubric:: Fields", ""]
    defaults = obj().as_dict()
    for one in fields(obj):
        text = help_of(one).replace(r"\|", "")  # about other options
        lines += [f"``{one.name} = {defaults[one.name]!r}``", f"   {text}", ""]


def help_of(field: Any) -> str:
    """Return the help of a field of a table of options, in which nothing is markup."""
    return re.sub(r"([*`|_\\])", r"\\\1", field.metadata["help"])


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the hooks of autodoc."""
    app.connect("autodoc-process-signature", keep_signature)
    app.connect("autodoc-process-docstring", keep_descriptions, priority=400)
    app.connect("autodoc-process-docstring", shorten_arrays)
    app.connect("autodoc-process-docstring", list_fields)
    return {"parallel_read_safe": True}
