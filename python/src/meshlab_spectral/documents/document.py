"""A mesh file whose coordinates can be replaced: what all formats have in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.errors import MeshFileError

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Part:
    """A mesh of a file, of the size and shape that it has where it is placed.

    Attributes
    ----------
    name
        Its name in the file; "" where there is none.
    vertices
        n x 3, placed: in the units of the file, with the transforms of its scene applied.
    faces
        m x 3 indices of vertices; polygons are split into triangles.
    quality
        n numbers that MeshLab would read as the vertex quality; None if there are none.
    selected
        n booleans, the vertices that MeshLab would show as selected and those of selected faces;
        None if the format holds no selection.
    """

    name: str
    vertices: Array
    faces: Indices
    quality: Array | None = None
    selected: NDArray[np.bool_] | None = None


@dataclass
class Document(ABC):
    """A mesh file that has been read.

    Attributes
    ----------
    path
        The file.
    parts
        Its meshes, at least one.
    contents
        What it holds beside coordinates and triangles, in a user's words ("colours", "texture
        coordinates"), for the warning of what another format cannot hold.
    warnings
        What was noticed on reading, and may be told.
    """

    path: Path
    parts: list[Part]
    contents: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    @abstractmethod
    def save(self, target: Path, moved: Sequence[Array]) -> list[str]:
        """Write the file with other coordinates, in its own format.

        Coordinates that have not moved keep their bytes. Normals follow the new shape.

        Parameters
        ----------
        target
            The file to write; side files that it refers to by relative paths are copied beside it,
            unless they are there.
        moved
            For each part its vertices, n x 3, placed.

        Returns
        -------
        list of str
            Warnings: what could not follow, or is held with too few digits.

        Raises
        ------
        OSError
            When `target` cannot be written.
        """


def unreadable(path: Path, reason: object) -> MeshFileError:
    """Return the error for a damaged file, with what is wrong in it and where."""
    told = " ".join(str(reason).split())
    return MeshFileError(
        f"{path} cannot be read as a mesh ({told}): it is damaged or cut off; copy it anew, or "
        "export it again from the program that made it"
    )


def unsupported(path: Path, what: str, remedy: str) -> MeshFileError:
    """Return the error for a sound file with something in it that this package does not know."""
    return MeshFileError(f"{path} {what}, which meshlab-spectral does not read: {remedy}")


# The largest coordinate that the filters take: MeshLab keeps lengths in single precision.
_LARGEST = 1e37


def checked_part(
    path: Path, vertices: Array, faces: Indices, name: str = "", quality: Array | None = None
) -> Part:
    """Return a part; raise MeshFileError as `check_vertices` and `check_indices`."""
    check_vertices(path, vertices)
    check_indices(path, faces, len(vertices))
    return Part(name, vertices, faces, quality)


def check_vertices(path: Path, vertices: Array) -> None:
    """Raise MeshFileError, which names the first, when coordinates are not finite or too large."""
    lost = ~(np.abs(vertices) <= _LARGEST).all(axis=1)
    if lost.any():
        first = int(np.argmax(lost))
        x, y, z = vertices[first]
        raise MeshFileError(
            f"{path}: vertex {first} is at {x:g} {y:g} {z:g}, which is not finite or too large: "
            "correct it, or open and save the file in MeshLab, which deletes such vertices with "
            "their faces"
        )


def check_indices(path: Path, faces: Indices, vertices: int) -> None:
    """Raise MeshFileError, which names the first, when a face refers to no vertex."""
    wrong = ((faces < 0) | (faces >= vertices)).any(axis=1)
    if wrong.any():
        first = int(np.argmax(wrong))
        raise unreadable(
            path, f"face {first} has the corners {faces[first].tolist()}, of {vertices} vertices"
        )
