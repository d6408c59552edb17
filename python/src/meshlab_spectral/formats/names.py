"""Names of mesh files: their extensions, and surfaces of FreeSurfer, whose names have none.

And names in mesh files, as texts show them.
"""

from __future__ import annotations

import gzip
import zlib
from pathlib import Path

# FreeSurfer names a surface by what it is, such as lh.pial or lh.pial.T1: it is known by its first
# bytes. These endings are searched for in folders by name, too.
FREE_SURFER = "freesurfer"
_INTENT, _POINTS = b"NIFTI_INTENT_", b"NIFTI_INTENT_POINTSET"
_BLOCK, _MOST, _TIMES = 1 << 20, 64 << 20, 40  # of bytes; as in budget.py
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


def holds_values(path: Path) -> bool:
    """Whether a file is GIFTI without a surface: values or labels at its vertices."""
    ending = ending_of(path.name).lower()
    if ending not in ("gii", "gii.gz"):
        return False
    has_values, tail, left = False, b"", _MOST + _TIMES * path.stat().st_size
    try:
        with (gzip.open if ending == "gii.gz" else open)(path, "rb") as file:
            while (block := file.read(_BLOCK)) and left > 0:
                if _POINTS in tail + block:
                    return False
                has_values |= _INTENT in tail + block
                tail, left = block[-len(_POINTS) :], left - len(block)
    except (OSError, EOFError, zlib.error):  # its job reports it
        return False
    return has_values


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
