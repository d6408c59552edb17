"""Opening a mesh file, as a document or in blocks, by its extension or its first bytes."""

from __future__ import annotations

import struct
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from meshlab_spectral.errors import UntiledError
from meshlab_spectral.formats.names import (
    FREE_SURFER,
    FREE_SURFER_ENDINGS,
    OTHERS,
    QUADRILATERALS,
    TRIANGLES,
    begin_of,
    ending_of,
)
from meshlab_spectral.formats.table import FORMATS

if TYPE_CHECKING:
    from meshlab_spectral.formats.document import Document
    from meshlab_spectral.formats.rows import MeshRows

READ_ONLY = frozenset(ending for ending, one in FORMATS.items() if not one.is_patched)
PATCHED = (frozenset(FORMATS) - READ_ONLY) | FREE_SURFER_ENDINGS


def format_of(path: Path) -> str | None:
    """Return the format as which `open_document` reads a file: an extension, or FREE_SURFER.

    None if it does not know it.
    """
    ending = ending_of(path.name).lower()
    if ending in FORMATS:
        return ending
    is_one = ending in FREE_SURFER_ENDINGS or begin_of(path) in (
        TRIANGLES,
        QUADRILATERALS,
        OTHERS,
    )
    return FREE_SURFER if is_one else None


def open_rows(path: Path) -> MeshRows:
    """Open a binary file in blocks; raise UntiledError if that is not possible in its format."""
    known = FORMATS.get(path.suffix[1:].lower())
    if known is None or not known.in_rows:
        names = " and ".join(one.name for one in FORMATS.values() if one.in_rows)
        raise UntiledError(
            f"only {names} can be read in parts: convert {path.name} to binary PLY first"
        )
    try:
        rows: MeshRows = _module(known.in_rows).open_rows(path)
    except (ValueError, LookupError, TypeError, OSError, struct.error) as error:
        raise UntiledError(f"{path.name} cannot be read in parts ({error})") from error
    return rows


def open_document(path: Path) -> Document:
    """Read a mesh file of one of the formats that `format_of` tells.

    Raises MeshFileError when it is damaged, or holds something that cannot be read, and
    MissingPackageError when its format needs the extra "formats", which is not installed.
    """
    known = FORMATS.get(ending_of(path.name).lower())
    document: Document = _module(known.module if known else "brain").read(path)
    return document


def _module(name: str) -> Any:
    """Import a module late: some need packages of an extra."""
    return import_module(f"meshlab_spectral.formats.{name}")
