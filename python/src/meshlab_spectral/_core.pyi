# plugin/python/module.cpp
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

Progress = Callable[[str, float], object]

def filters() -> list[dict[str, Any]]: ...
def apply(
    name: str,
    vertices: NDArray[np.float64],
    faces: NDArray[np.int32],
    options: Mapping[str, bool | int | float | str],
    *,
    selected: NDArray[np.bool_] | None = None,
    values: NDArray[np.float64] | None = None,
    gain: NDArray[np.float64] | None = None,
    progress: Progress | None = None,
    threads: int = 0,
) -> dict[str, Any]: ...
def gains(
    options: Mapping[str, bool | int | float | str],
    diagonal: float,
    mean_edge: float,
    frequencies: NDArray[np.float64],
) -> NDArray[np.float64]: ...
def laplacian(
    vertices: NDArray[np.float64],
    faces: NDArray[np.int32],
    kind: int,
    *,
    progress: Progress | None = None,
    threads: int = 0,
) -> tuple[
    NDArray[np.float64],
    NDArray[np.int32],
    NDArray[np.int32],
    NDArray[np.float64],
    NDArray[np.int64],
]: ...
def set_memory_limit(limit: float) -> None: ...
