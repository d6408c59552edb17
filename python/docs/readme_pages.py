"""Sphinx: sections of the READMEs within the pages, since a text stands once.

A page in Markdown has a line `{readme} FILE, HEADING`, with the file's path from the top folder.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx

ROOT = Path(__file__).parents[2]
# What the READMEs link to that is a page here; of other files in the repository the name stays.
PAGES = {
    "#install": "installing.md",
    "docs/formats.md": "formats.md",
    "docs/inputs.md": "inputs.md",
    "guides/tiles.md": "guides/tiles.md",
    "guides/texture.md": "guides/texture.md",
    "guides/troubleshooting.md": "guides/troubleshooting.md",
}


def section(file: str, heading: str) -> str:
    """Return the text below a heading of a README, up to the next heading of its level."""
    text = (ROOT / file).read_text(encoding="utf-8")
    found = re.search(
        rf"^## {re.escape(heading)}\n(.*?)(?=^## |\Z)", text, re.DOTALL | re.MULTILINE
    )
    if not found:
        raise ValueError(f"{file} has no section {heading}")
    return re.sub(r"\[([^\]]+)\]\((?!https:)([^)]+)\)", _link, found[1])


def _link(link: re.Match[str]) -> str:
    text, target = link.groups()
    page = next((page for end, page in PAGES.items() if target.endswith(end)), None)
    return f"[{text}]({page})" if page else text


def fill_in(app: Sphinx, docname: str, content: list[str]) -> None:
    """Put the sections in their places."""
    content[0] = re.sub(
        r"^\{readme\} (\S+), (.+)$",
        lambda line: section(*line.groups()),
        content[0],
        flags=re.MULTILINE,
    )


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the hook."""
    app.connect("source-read", fill_in)
    return {"parallel_read_safe": True}
