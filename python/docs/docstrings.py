"""Sphinx: signatures as they are written, and the tables of options with the help of fields."""

from __future__ import annotations

import inspect
import re
from dataclasses import fields
from typing import Any, get_args, get_type_hints, is_typeddict

from meshlab_spectral.filters.option_types import Options
from sphinx.application import Sphinx
from sphinx.pycode import ModuleAnalyzer


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


def list_entries(
    app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]
) -> None:
    """Add the entries to the docstring of a report: autodoc does not find those of its bases."""
    if not is_typeddict(obj):
        return
    texts = ModuleAnalyzer.for_module(obj.__module__).find_attr_docs()
    meanings = {entry: " ".join(text).strip() for (_, entry), text in texts.items()}
    lines += ["", ".. rubric:: Entries", ""]
    for entry, kind in sorted(get_type_hints(obj).items()):
        required = "" if entry in obj.__required_keys__ else ", not in every report"
        typed = str(kind) if get_args(kind) else kind.__name__
        lines += [
            f"``{entry}`` ({typed.replace(f'{obj.__module__}.', '')}{required})",
            f"   {meanings[entry]}",
            "",
        ]


def help_of(field: Any) -> str:
    """Return the help of a field of a table of options, in which nothing is markup."""
    return re.sub(r"([*`|_\\])", r"\\\1", field.metadata["help"])


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the hooks of autodoc."""
    app.connect("autodoc-process-signature", keep_signature)
    app.connect("autodoc-process-docstring", shorten_arrays)
    app.connect("autodoc-process-docstring", list_fields)
    app.connect("autodoc-process-docstring", list_entries)
    return {"parallel_read_safe": True}
