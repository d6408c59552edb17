"""Types of what `conftest` gives to tests."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

Arrays = tuple[NDArray[Any], NDArray[Any]]  # n x 3 coordinates, m x 3 vertex indices
Decimated = Callable[..., Arrays]
Record = Callable[..., None]
SharedMesh = Callable[[str], Path]
