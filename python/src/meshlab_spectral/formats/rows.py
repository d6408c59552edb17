"""Mesh files in blocks of rows, on demand: nothing of them stays in memory."""

from __future__ import annotations

import mmap
import shutil
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.formats.document import Array, Indices

CHUNK = 1 << 18  # rows that are handled at once
_COPIED = 1 << 22  # bytes
Rows = np.ndarray[Any, Any]
# Which of the points from a number to another have new values, counted from the first, and these.
Between = Callable[[int, int], tuple[Indices, Array]]


@dataclass(kw_only=True)
class MeshRows(ABC):
    """A mesh file: points, and triangles of their numbers.

    In a PLY file the points are the vertices, in an STL file the corners of all facets: those at
    one position are one vertex.
    """

    path: Path  # the file
    # How many points and faces there are.
    points: int
    faces: int
    # The rows that hold the points, and their byte offset.
    block: Rows
    begin: int
    # What `columns` has: "positions", "normals", "quality".
    kinds: frozenset[str] = frozenset({"positions"})
    flags: tuple[bool, bool] = (False, False)  # whether points, and faces, may be selected
    is_single: bool = True  # whether coordinates are single precision
    is_joined_by_position: ClassVar[bool] = False

    @property
    def vertices(self) -> int:
        """The number of vertices, estimated where they are joined by position."""
        return self.points

    @abstractmethod
    def columns(self, numbers: Indices | slice, kind: str = "positions") -> Array:
        """Return what points have, k x 3, or k x 1 of quality: column by column in memory."""

    @abstractmethod
    def triangles(self, begin: int, end: int) -> Indices:
        """Return the points of triangles, k x 3; raise MeshFileError where they are none."""

    def selected(self, numbers: Indices | slice) -> NDArray[np.bool_]:
        """Return which points are selected, if `flags` has some."""
        raise NotImplementedError

    def selected_faces(self, begin: int, end: int) -> NDArray[np.bool_]:
        """Return which triangles are selected, if `flags` has some."""
        raise NotImplementedError

    @abstractmethod
    def written(
        self, begin: int, end: int, moved: Between, normals: Between, is_wide: bool
    ) -> Rows:
        """Return rows of the block with new positions, and normals."""

    def widened_header(self, is_wide: bool) -> tuple[bytes, int]:
        """Return the begin of the file, with coordinates declared as double if `is_wide`.

        And how many bytes of the file it stands for.
        """
        return b"", 0

    def gathered(self, numbers: Indices, kind: str = "positions") -> Array:
        """Return columns of many points, a chunk at a time."""
        table = np.empty((len(numbers), 1 if kind == "quality" else 3))
        for i, j in chunks(len(numbers)):
            table[i:j] = self.columns(numbers[i:j], kind)
            self.forget()
        return table

    def corners_of(self, F: Indices) -> list[Array]:
        """Return the positions of the first, second and third corners of triangles."""
        return [self.columns(F[:, k]) for k in range(3)]

    def save(
        self,
        target: Path,
        moved: Between,
        normals: Between,
        is_wide: bool,
        on_progress: Callable[[float], object],
    ) -> None:
        """Write the file with new positions, as doubles if `is_wide`, and normals."""
        header, replaced = self.widened_header(is_wide)
        with self.path.open("rb") as source, target.open("wb") as file:
            file.write(header)
            source.seek(replaced)
            for i, j in chunks(self.begin - replaced, _COPIED):
                file.write(source.read(j - i))
            for i, j in chunks(len(self.block)):
                on_progress(i / len(self.block))
                file.write(self.written(i, j, moved, normals, is_wide).tobytes())
                self.forget()
            source.seek(self.begin + self.block.nbytes)
            shutil.copyfileobj(source, file, _COPIED)

    def forget(self) -> None:
        """Give the pages of the file back: they would count as memory of this process."""
        forget(self.block)


def forget(rows: Any) -> None:
    """Give the pages of a memory map back."""
    owner = rows
    while owner is not None and not hasattr(owner, "madvise"):
        owner = getattr(owner, "_mmap", None) or getattr(owner, "base", None)
    if owner is not None and hasattr(mmap, "MADV_DONTNEED"):
        owner.madvise(mmap.MADV_DONTNEED)


def chunks(count: int, size: int = CHUNK) -> Iterator[tuple[int, int]]:
    """Yield the begin and the end of consecutive chunks of rows."""
    return ((i, min(i + size, count)) for i in range(0, count, size))
