"""What tiles cannot be; apart from the work itself, since NumPy takes long to import."""

from __future__ import annotations

from meshlab_spectral.errors import MeshFileError

MOST_TILES = 4096


class UntiledError(MeshFileError):
    """A file or a filter cannot be handled in tiles; the message says why, and what to do."""
