# plugin/python/module.cpp
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

Progress = Callable[[str, float], object]
_Lists = list[tuple[NDArray[np.int64], NDArray[np.float64]]]
_Numbers = tuple[NDArray[np.float64], _Lists, int, int]

def filters() -> list[dict[str, Any]]: ...
def presets() -> list[tuple[str, str, str, dict[str, Any]]]: ...
def length(text: str) -> tuple[float, Literal["", "%", "e"], bool]: ...
def checked(name: str, options: Mapping[str, object]) -> dict[str, Any]: ...
def sizes(
    name: str,
    options: Mapping[str, object],
    diagonal: float,
    mean_edge: float,
    surface_diagonal: float,
) -> dict[str, float | None]: ...
def warning_kinds() -> dict[str, str]: ...
def apply(
    name: str,
    vertices: NDArray[np.float64],
    faces: NDArray[np.int32],
    options: Mapping[str, bool | int | float | str],
    *,
    selected: NDArray[np.bool_] | None = None,
    values: NDArray[np.float64] | None = None,
    gain: NDArray[np.float64] | None = None,
    whole: tuple[float, float, float, bool, NDArray[np.bool_]] | None = None,
    progress: Progress | None = None,
    threads: int = 0,
    more_memory: str = "",
    is_shell: bool = False,
) -> dict[str, Any]: ...
def gains(
    options: Mapping[str, bool | int | float | str],
    feature_size: float,
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
def available_memory() -> float: ...
def joined_vertices(
    vertices: NDArray[np.float64], faces: NDArray[np.int32]
) -> NDArray[np.int64]: ...
def lengths(
    vertices: NDArray[np.float64], faces: NDArray[np.int32]
) -> tuple[float, float, float]: ...
def vertex_areas(
    vertices: NDArray[np.float64], faces: NDArray[np.int32]
) -> NDArray[np.float64]: ...
def text_lines(
    text: bytes,
    begin: int,
    limit: int,
    keywords: Sequence[str],
    comments: bool,
    any_case: bool,
    continued: int,
) -> tuple[NDArray[np.int64], NDArray[np.int32], NDArray[np.uint8]]: ...
def text_numbers(
    text: bytes,
    starts: NDArray[np.int64],
    words: NDArray[np.int32],
    first: int,
    are_lists: Sequence[bool],
    comments: bool,
    continued: int,
    is_whole: bool,
) -> _Numbers: ...
def binary_numbers(
    data: bytes, begin: int, count: int, types: Sequence[tuple[str, str]], big_endian: bool
) -> tuple[_Numbers, int]: ...
def text_corners(
    text: bytes, starts: NDArray[np.int64], words: NDArray[np.int32]
) -> tuple[NDArray[np.int64], int]: ...
def write_patched(
    text: bytes,
    begin: int,
    changes: Sequence[tuple[NDArray[np.int64], int, NDArray[np.float64], NDArray[np.float64], int]],
    write: Callable[[memoryview], object],
) -> None: ...
def xml_elements(
    text: bytes, kinds: Sequence[tuple[str, tuple[str, str, str]]]
) -> tuple[list[tuple[NDArray[np.float64], NDArray[np.int64]]], bytes]: ...
def first_equal_rows(rows: NDArray[np.float64]) -> NDArray[np.int64]: ...
def following_normals(
    before: NDArray[np.float64],
    after: NDArray[np.float64],
    faces: NDArray[np.int64],
    normals: NDArray[np.float64],
    which: NDArray[np.int64],
) -> NDArray[np.float64]: ...
def following_face_normals(
    before: NDArray[np.float64],
    after: NDArray[np.float64],
    faces: NDArray[np.int64],
    normals: NDArray[np.float64],
    owners: NDArray[np.int64],
) -> NDArray[np.float64]: ...
def components(vertices: NDArray[np.float64], faces: NDArray[np.int32]) -> NDArray[np.int32]: ...
def moved_alike(
    vertices: NDArray[np.float64], faces: NDArray[np.int32], displacement: NDArray[np.float64]
) -> NDArray[np.float64]: ...
def evaluated(
    option: str, text: str, examples: str, variables: Sequence[str], values: NDArray[np.float64]
) -> NDArray[np.float64]: ...
