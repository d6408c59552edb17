"""Runs of the core's filters on arrays."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshlab_spectral import _core
from meshlab_spectral.errors import OptionError
from meshlab_spectral.filters.arrays import real_numbers
from meshlab_spectral.filters.progress import Progress, progress_callback
from meshlab_spectral.filters.representations import Report
from meshlab_spectral.plugin import limits
from meshlab_spectral.warned import Warned, with_warnings

Array = NDArray[np.float64]
Gain = Callable[[Array], ArrayLike]

# Set by the command, for its child processes, too: advice then names options as a shell has them.
SHELL = "MESHLAB_SPECTRAL_SHELL"

# The core interpolates a gain's logarithm between samples, here to about 1e-7 of a smooth gain;
# beyond them, where no mesh has details, the gain is constant.
_OCTAVES, _PER_OCTAVE = 16, 128


class TiledSurface(NamedTuple):
    """What the sizes and defaults of a tile refer to, and what it cannot decide by itself."""

    diagonal: float  # of the bounding box
    mean_edge: float
    surface_diagonal: float  # of the bounding box of the triangles
    has_thin_parts: bool  # whether some tile has parts that are thinner than the size
    inner: NDArray[np.bool_]  # n, what is not near where the tile was cut out


@dataclass(frozen=True, eq=False)
class Run:
    """What a filter of the core has returned; None where it has no such result."""

    # Numbers, flags and arrays; "warnings", a list of problems that were not errors; "summary",
    # what a filter that chooses by itself found and did.
    report: dict[str, Any]
    text: str  # the report as lines for a log
    vertices: Array | None = None  # n x 3 new coordinates
    details: Array | None = None  # n x 3 differences, input minus result
    values: Array | None = None  # n x c new values at the vertices
    basis: Array | None = None  # n x k harmonics
    columns: list[dict[str, Any]] | None = None  # for several columns of `values`, a report of each

    @property
    def plain_report(self) -> dict[str, Any]:
        """The report with lists instead of arrays, for JSON; prints in few lines."""
        return Report(plain(self.report))


def run(
    name: str,
    V: Array,
    F: NDArray[np.integer],
    options: Mapping[str, bool | int | float | str],
    *,
    selected: NDArray[np.bool_] | None = None,
    values: Array | None = None,
    gain: Gain | None = None,
    whole: TiledSurface | None = None,
    progress: Progress | bool | None = None,
    threads: int | None = None,
) -> Run:
    """Apply a filter of the core.

    `name` is the filter's in pymeshlab, V and F are as from `mesh_arrays`; parameters that
    `options` lack keep their defaults. `selected` are n booleans, for the option of this name;
    `values` n x k numbers, or n x 3 levels of 0 to 255, to filter or as weights; `gain` stands in
    place of a transfer function; `whole` is the surface that the mesh is a tile of. `progress`,
    called in this thread, and `threads` are as for `filter_mesh`.

    Raises OptionError, MeshError, SolverError or MemoryLimitError, with the reason and what to do;
    Cancelled when `progress` has returned False, and KeyboardInterrupt within 0.5 s of Ctrl-C.
    """
    _core.set_memory_limit(limits.given_memory_limit() or 0)
    with progress_callback(progress) as on_progress:
        result = _core.apply(
            name,
            V,
            F.astype(np.int32, copy=False),
            options,
            selected=selected,
            values=values,
            gain=None if gain is None else _samples(gain),
            whole=whole,
            progress=on_progress,
            threads=thread_count(threads),
            more_memory=limits.memory_remedy(),
            is_shell=SHELL in os.environ,
        )
    report = _reported(result.pop("report"), result.pop("warnings"))
    result["columns"] = [_reported(r, w) for r, w in result.get("columns", [])] or None
    if summary := result.pop("summary"):
        report["summary"] = summary
    return Run(report, **result)


def _reported(report: dict[str, Any], warnings: Iterable[tuple[str, str]]) -> dict[str, Any]:
    return with_warnings(report, [Warned(*one) for one in warnings])


def thread_count(threads: int | None) -> int:
    """Return a number of threads for the core; raise OptionError if it is none above zero."""
    return limits.checked_threads(threads) or limits.threads() or 0


def require_no_type(filter_type: str) -> None:
    """Raise OptionError when a filter type is chosen, which a gain replaces."""
    if filter_type != "low-pass":
        raise OptionError(f"filter_type = {filter_type}: gain replaces it; give one of them")


def plain(report: dict[str, Any]) -> dict[str, Any]:
    """Convert the arrays in a report to lists, for JSON."""
    return {
        name: value.tolist() if hasattr(value, "tolist") else value
        for name, value in report.items()
    }


def _samples(gain: Gain) -> Array:
    """Sample a gain; raise OptionError, which names w, when one is negative or not finite."""
    if not callable(gain):
        raise OptionError(
            f"gain = {gain!r}: pass a function of w; an expression is transfer_function, with "
            "filter_type = custom"
        )
    w = np.exp2(np.arange(-_OCTAVES * _PER_OCTAVE, _OCTAVES * _PER_OCTAVE + 1) / _PER_OCTAVE)
    try:
        returned: Any = np.asarray(gain(w))
    except (TypeError, ValueError):  # a function of one number, such as one with an if
        returned = [gain(one) for one in w]
    gains = real_numbers(returned, "gains")
    if gains.shape not in ((), w.shape):
        raise OptionError(
            f"gain returns shape {gains.shape} for {len(w)} frequencies: return a gain for each"
        )
    gains = np.broadcast_to(gains, w.shape)
    wrong = np.flatnonzero(~(np.isfinite(gains) & (gains >= 0)))
    if wrong.size:
        raise OptionError(
            f"gain({w[wrong[0]]:.3g}) = {gains[wrong[0]]}: must be finite and not negative for "
            "every w > 0, the feature size over the wavelength"
        )
    return np.column_stack([w, gains])
