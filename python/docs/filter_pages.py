"""Sphinx: the directives `filter`, `filter-list` and `warning-list`: what the filters tell of."""

from __future__ import annotations

import html
import re
from collections.abc import Iterable, Iterator
from typing import Any

from docutils import nodes
from meshlab_spectral import _core
from meshlab_spectral.warned import KINDS
from plugin_facts import MEANINGS, Filter, Parameter, filters
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective


def rst_of(text: str) -> str:
    """Convert HTML help to reStructuredText: bold, italics, links and paragraphs."""
    text = re.sub(r"</?small>", "", text)
    paragraphs = []
    for paragraph in re.split(r"(?:<br>)+", text):
        plain = re.sub(r"([*`|_\\])", r"\\\1", html.unescape(paragraph))
        # Within a word, bold and italics need an escaped space, which is not shown.
        plain = re.sub(r"<b>(.+?)</b>", r"\\ **\1**\\ ", plain)
        plain = re.sub(r"<i>(.+?)</i>", r"\\ *\1*\\ ", plain)
        plain = re.sub(r'<a href="(.+?)">(.+?)</a>', _link, plain)
        paragraphs.append(plain.strip())
    return "\n\n".join(paragraphs)


def _link(found: re.Match[str]) -> str:
    address = found[1].replace("\\", "")  # nothing is escaped there
    return f"`{found[2]} <{address}>`__"


def _table(header: tuple[str, ...], rows: Iterable[tuple[str, ...]], widths: str) -> Iterator[str]:
    yield from (".. list-table::", "   :header-rows: 1", f"   :widths: {widths}", "")
    for row in (header, *rows):
        for column, cell in enumerate(row):
            yield f"   {' ' if column else '*'} - {cell}"
    yield ""


def _heading(text: str, line: str) -> tuple[str, ...]:
    return (text, line * len(text), "")


def _default(parameter: Parameter) -> str:
    is_text = parameter.type == "RichString"
    return f"``{parameter.default}``" if is_text else parameter.default


def _description(described: Filter) -> str:
    menus = " and ".join(f":menuselection:`Filters --> {menu}`" for menu in described.menus)
    where = (f":In MeshLab: {menus}", f":In Python: ``MeshSet.{described.python_name}()``")
    return "\n".join((*where, "", rst_of(described.help)))


def _parameters(described: Filter) -> Iterator[str]:
    name = described.python_name
    yield from _heading("Parameters", "-")
    rows = (
        (f":ref:`{each.name} <{name}.{each.name}>`", each.values, _default(each))
        for each in described.parameters
    )
    yield from _table(("Name", "Values", "Default"), rows, "30 40 30")
    for each in described.parameters:
        yield from (f".. _{name}.{each.name}:", "")
        yield from _heading(f"``{each.name}``", "~")
        where = "; behind the arrow of the dialog" if each.is_advanced else ""
        facts = f"{each.values}; default: {_default(each)}{where}"
        yield from (f"**{each.label}**: {facts}", "", rst_of(each.help), "")


def _report(described: Filter) -> Iterator[str]:
    yield from _heading("Report", "-")
    yield from ("The dictionary that the method returns; lengths are in the units of the mesh.", "")
    rows = (
        (f"``{entry}``", kind, re.sub(r"`(.+?)`", r"``\1``", MEANINGS[entry]))
        for entry, kind in sorted(described.report.items())
    )
    yield from _table(("Entry", "Value", "Meaning"), rows, "34 16 50")


class FilterDirective(SphinxDirective):
    """`.. filter:: PYTHON_NAME`; its content goes between the description and the parameters."""

    required_arguments = 1
    has_content = True

    def run(self) -> list[nodes.Node]:
        """Write the page of the filter but for its title."""
        name = self.arguments[0]
        if name not in filters():
            raise self.error(f"the plugin has no filter {name}: {', '.join(filters())}")
        described = filters()[name]
        sections = "\n".join((*_parameters(described), *_report(described)))
        return [
            *self.parse_text_to_nodes(_description(described)),
            *self.parse_content_to_nodes(),
            *self.parse_text_to_nodes(sections, allow_section_headings=True),
        ]


class FilterListDirective(SphinxDirective):
    """`.. filter-list::`: every filter with its menu, and a link to its page."""

    def run(self) -> list[nodes.Node]:
        """Write the table."""
        rows = (
            (f":doc:`{each.name} </filters/{name}>`", ", ".join(each.menus), f"``{name}``")
            for name, each in filters().items()
        )
        header = ("Filter", "Submenu of Filters", "Python")
        return self.parse_text_to_nodes("\n".join(_table(header, rows, "30 35 35")))


class WarningListDirective(SphinxDirective):
    """`.. warning-list::`: the codes of all warnings, and what they are about."""

    def run(self) -> list[nodes.Node]:
        """Write the table."""
        kinds = {**_core.warning_kinds(), **KINDS}
        rows = ((f"``{code}``", meaning) for code, meaning in kinds.items())
        return self.parse_text_to_nodes("\n".join(_table(("Code", "About"), rows, "30 70")))


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the directives."""
    app.add_directive("filter", FilterDirective)
    app.add_directive("filter-list", FilterListDirective)
    app.add_directive("warning-list", WarningListDirective)
    return {"parallel_read_safe": True}
