"""Names of mesh files: their extensions, and surfaces of FreeSurfer, whose names have none.

And names in mesh files, as texts show them.
"""

from __future__ import annotations

from pathlib import Path

# FreeSurfer names a surface by what it is, such as lh.pial or lh.pial.T1: it is known by its first
# bytes. These endings are searched for in folders by name, too.
FREE_SURFER = "freesurfer"
TRIANGLES = b"\xff\xff\xfe"
QUADRILATERALS = b"\xff\xff\xfd"
OTHERS = b"\xff\xff\xff"  # quadrilaterals in an old layout, or values such as curvature
FREE_SURFER_ENDINGS = frozenset({"inflated", "pial", "smoothwm", "sphere", "white"})


def ending_of(name: str) -> str:
    """Return the extension of a file name, in its original case and without the dot."""
    stem, dot, ending = name.rpartition(".")
    if ending.lower() == "gz" and stem.lower().endswith(".gii"):
        return name[-len("gii.gz") :]
    return ending if stem and dot else ""


def is_free_surfer(path: Path) -> bool:
    """Whether a file begins as a surface of FreeSurfer; false if it cannot be read."""
    return begin_of(path) in (TRIANGLES, QUADRILATERALS)


def begin_of(path: Path) -> bytes:
    """Return the first three bytes of a file; none if it cannot be read."""
    try:
        if not path.is_file():  # reading a pipe might never end
            return b""
        with path.open("rb") as file:
            return file.read(len(TRIANGLES))
    except OSError:
        return b""


def shown(name: object, longest: int = 100) -> str:
    """Return what a file calls something for a text: in one line of so many characters at most."""
    text = visible(str(name))
    return text if len(text) <= longest else f"{text[: longest - 3]}..."


def visible(text: str) -> str:
    """Escape what a terminal would not print but obey, such as control characters."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)
