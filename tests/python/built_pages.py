"""The built reference pages: their titles, ids, pictures and links, read from the HTML."""

from __future__ import annotations

from html.parser import HTMLParser
from pathlib import Path


class Page(HTMLParser):
    """One page.

    Attributes
    ----------
    title, text
        Text of its heading; all text except code.
    ids
        Targets of `#...`.
    links
        Targets of its anchors.
    files
        What a browser loads to show it.
    pictures
        The files shown in figures.
    """

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.path = path
        self.title = self.text = ""
        self.ids: set[str] = set()
        self.links: list[str] = []
        self.files: list[str] = []
        self.pictures: list[str] = []
        self._open: list[str] = []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {name: value or "" for name, value in attrs}
        if "id" in given:
            self.ids.add(given["id"])
        if "href" in given:
            is_loaded = tag == "link" and "stylesheet" in given.get("rel", "")
            (self.files if is_loaded else self.links).append(given["href"])
        if "src" in given:
            self.files.append(given["src"])
            if "figure" in self._open:
                self.pictures.append(given["src"])
        if tag in ("h1", "figure", "a", "pre", "script", "style"):
            self._open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if tag in self._open:
            self._open.remove(tag)

    def handle_data(self, data: str) -> None:
        if {"pre", "script", "style"} & set(self._open):
            return
        self.text += data
        if "h1" in self._open and "a" not in self._open:
            self.title += data


class Site:
    """All pages below a folder, by their paths from there."""

    def __init__(self, folder: Path) -> None:
        self.pages = {
            str(path.relative_to(folder)): Page(path) for path in sorted(folder.rglob("*.html"))
        }
