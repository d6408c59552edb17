"""Keyword options are known before a call: to `help`, to notebooks and to type checkers."""

from __future__ import annotations

import inspect
import re
from dataclasses import fields
from typing import Any, get_args, get_type_hints

import jedi
import meshlab_spectral
import pytest
from meshlab_spectral import DenoiseOptions, FilterOptions
from meshlab_spectral.batch.settings import BatchKeywords, Settings
from meshlab_spectral.filters.denoise import DenoiseKeywords
from meshlab_spectral.filters.option_types import Length
from meshlab_spectral.filters.options import FilterKeywords

TABLES: list[tuple[list[type[Any]], Any]] = [
    ([FilterOptions], FilterKeywords),
    ([DenoiseOptions], DenoiseKeywords),
    ([Settings, FilterOptions], BatchKeywords),
]


@pytest.mark.parametrize(("tables", "keywords"), TABLES)
def test_keywords_are_the_fields_of_the_tables(tables: list[type[Any]], keywords: Any) -> None:
    types = {name: kind for table in tables for name, kind in get_type_hints(table).items()}
    keyword_types = get_type_hints(keywords)
    assert set(keyword_types) == {one.name for table in tables for one in fields(table)}
    for name, kind in keyword_types.items():
        assert kind in (types[name], str | types[name]) or Length in get_args(kind)


@pytest.mark.parametrize(
    "name", ["filter_mesh", "denoise_mesh", "filter_scalars", "filter_colors", "filter_files"]
)
def test_help_lists_every_option_with_default_and_range(name: str) -> None:
    function = getattr(meshlab_spectral, name)
    document = inspect.getdoc(function) or ""
    parameters = inspect.signature(function).parameters
    assert "named" not in parameters
    assert "**named" not in document
    assert "--" not in re.sub("-{3,}", "", document.partition("Raises\n")[0])
    for parameter in parameters:
        assert re.search(rf"^(\w+, )*{parameter}(, \w+)*\n    ", document, re.MULTILINE)
    assert all(len(line) <= 100 for line in document.splitlines())
    assert parameters["boundary"].default == "free"
    assert "Range: 'free', 'fixed'." in document


@pytest.mark.parametrize(
    ("call", "completions"),
    [
        ("filter_mesh(V, F, fea", ["feature_size="]),
        ("filter_mesh(V, F, weigh", ["weight=", "weights="]),
        ("denoise_mesh(V, F, stre", ["strength="]),
        ("filter_scalars(V, F, q, band", ["band_width="]),
        ("filter_files(inputs, output, over", ["overwrite="]),
    ],
)
def test_a_notebook_completes_option_names(call: str, completions: list[str]) -> None:
    found = jedi.Interpreter(call, [vars(meshlab_spectral), meshlab_spectral_names()]).complete()
    assert sorted(one.name for one in found) == completions


def meshlab_spectral_names() -> dict[str, Any]:
    return {name: getattr(meshlab_spectral, name) for name in meshlab_spectral.__all__}
