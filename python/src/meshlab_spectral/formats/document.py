"""Mesh files whose coordinates can be replaced: the common interface of all formats."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from shutil import copyfile
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.errors import MeshFileError
from meshlab_spectral.formats.causes import unreadable
from meshlab_spectral.formats.side_files import copy_side_files, is_outside
from meshlab_spectral.warned import Warned

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Part:
    """A mesh of a file, as placed in its scene."""

    name: str  # its name in the file; "" if it has none
    vertices: Array  # n x 3, in the units of the file, with the transforms of its scene applied
    faces: Indices  # m x 3 vertex indices; polygons are split into triangles
    # n numbers that MeshLab would read as the vertex quality; None if there are none.
    quality: Array | None = None
    # n booleans, the vertices that MeshLab would show as selected and those of selected faces; None
    # if nothing is selected.
    selected: NDArray[np.bool_] | None = None
    # 4 x 4 transforms of the vertices to where the scene has the mesh again.
    copies: tuple[Array, ...] = ()
    is_shown: bool = True  # whether it is in the scene that the file shows first
    unit: str = ""  # what a length is; "" if the file does not say so

    @property
    def flags(self) -> NDArray[np.bool_]:
        """Which of the n vertices are selected."""
        return np.zeros(len(self.vertices), bool) if self.selected is None else self.selected


def joined(parts: Sequence[Part]) -> tuple[Array, Indices]:
    """Return several meshes as one."""
    begins = np.cumsum([0, *(len(part.vertices) for part in parts)])
    faces = [part.faces + begin for part, begin in zip(parts, begins, strict=False)]
    return np.vstack([part.vertices for part in parts]), np.vstack(faces)


def split(rows: NDArray[Any], parts: Sequence[Part]) -> list[NDArray[Any]]:
    """Return the rows of each part, of those of all their vertices."""
    return np.split(rows, np.cumsum([len(part.vertices) for part in parts])[:-1])


@dataclass
class Document(ABC):
    """A mesh file that has been read."""

    path: Path  # the file
    parts: list[Part]  # its meshes, at least one
    # What it holds besides coordinates and triangles, in the user's terms ("colours", "texture
    # coordinates"), for the warning about what another format loses.
    contents: list[str] = field(default_factory=list)
    warnings: list[Warned] = field(default_factory=list)  # problems noticed while reading
    # Corners of the largest polygon; 3 where it does not matter.
    largest_face: int = field(default=3, kw_only=True)

    def side_files(self) -> Iterable[str]:
        """Return the names of files that it refers to, such as textures, relative to its folder."""
        return ()

    def is_harmless(self) -> bool:
        """Whether MeshLab may read the file: it would open whatever that names.

        And divide polygons in a time that is the square of their corners: 8 s for one of 2,000.
        """
        if self.largest_face > _MOST_CORNERS:
            return False
        return not any(is_outside(self.path, name) for name in self.side_files())

    def save(self, target: Path, moved: Sequence[Array]) -> list[Warned]:
        """Write the file with new coordinates, in its own format.

        Unchanged coordinates keep their bytes. Normals follow the new shape. Side files that it
        refers to by relative paths are copied next to `target`, unless they are already there.
        `moved` are the new vertices of each part, n x 3, as placed in the scene. Returns warnings
        about what could not be updated, or is written with too few digits. Raises OSError when
        `target` cannot be written.
        """
        pairs = zip(self.parts, moved, strict=True)
        if all(np.array_equal(part.vertices, new) for part, new in pairs) and self.keeps(target):
            copyfile(self.path, target)
            return copy_side_files(self.path, target, self.side_files())
        return self.write(target, moved)

    def keeps(self, target: Path) -> bool:
        """Whether the bytes of the file can have the name of `target`."""
        return True

    @abstractmethod
    def write(self, target: Path, moved: Sequence[Array]) -> list[Warned]:
        """Do what `save` does, of which some vertex has moved."""


_MOST_CORNERS = 500
# The largest coordinate that the filters accept: MeshLab keeps lengths in single precision.
_LARGEST = 1e37


def checked_part(
    path: Path, vertices: Array, faces: Indices, name: str = "", quality: Array | None = None
) -> Part:
    """Return a part; raise MeshFileError as `check_vertices` and `check_indices` do."""
    check_vertices(path, vertices)
    check_indices(path, faces, len(vertices))
    return Part(name, vertices, faces, quality)


def check_vertices(path: Path, vertices: Array) -> None:
    """Raise MeshFileError for the first vertex with non-finite or too large coordinates, if any."""
    lost = ~(np.abs(vertices) <= _LARGEST).all(axis=1)
    if lost.any():
        first = int(np.argmax(lost))
        x, y, z = vertices[first]
        raise MeshFileError(
            f"{path}: vertex {first} is at {x:g} {y:g} {z:g}, which is not finite or too large: "
            "correct it, or delete that vertex with its faces",
            "bad_values",
        )


def check_indices(path: Path, faces: Indices, vertices: int) -> None:
    """Raise MeshFileError for the first face that refers to a missing vertex, if any."""
    wrong = ((faces < 0) | (faces >= vertices)).any(axis=1)
    if wrong.any():
        first = int(np.argmax(wrong))
        raise unreadable(
            path, f"face {first} has the corners {faces[first].tolist()}, of {vertices} vertices"
        )
