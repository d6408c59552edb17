"""The report of a run in tiles, made from those of its tiles."""

from __future__ import annotations

import math
from collections import Counter
from statistics import median
from typing import Any

from meshlab_spectral.warned import Warned, warned, with_warnings

_LARGEST = (
    "step_error",
    "error_estimate",
    "thin_part_factor",
    "passes",
    "steps",
    "factorizations",
    "solves",
    "products",
)
_ALIKE = ("feature_size", "cutoff_frequency")
# Of denoising.
_NOISE = ("noise_height", "noise_size", "mean_edge")


def mean_share(name: str, reports: list[dict[str, Any]]) -> float:
    """Return the mean of a share over the tiles, by the areas that are their own."""
    area = math.fsum(one["own_area_before"] for one in reports)
    sums = math.fsum(one.get(name, 0.0) * one["own_area_before"] for one in reports)
    return sums / area if area else 0.0


def combined(
    filter_name: str, reports: list[dict[str, Any]]
) -> tuple[dict[str, Any], tuple[float, float, float]]:
    """Combine the reports of all tiles of a filter, named as its table.

    Returns the report of the surface, which lacks what only the whole could tell, such as its
    components; and root mean squares of the rounding to single precision and of the displacement,
    over the vertices that move, and the largest coordinate.
    """
    ran = [one for one in reports if one["ran"]]

    def total(name: str) -> float:
        return math.fsum(one.get(name, 0) for one in reports)

    area, moved = total("own_area_before"), max(1.0, total("moved"))
    report: dict[str, Any]
    if filter_name == "denoise":
        report = {name: median(one[name] for one in ran) if ran else 0.0 for name in _NOISE}
        report["rounds"] = max((one["rounds"] for one in ran), default=0)
        told = Counter(one["summary"] for one in ran)
        report["summary"] = told.most_common(1)[0][0] if told else "nothing changed"
    else:
        report = {name: ran[0][name] if ran else 0.0 for name in _ALIKE}
        report |= {name: max((one[name] for one in ran), default=0) for name in _LARGEST}
        report["accuracy_reached"] = all(one["accuracy_reached"] for one in ran)
        report["singular_part"] = mean_share("singular_part", reports)
    report |= {
        "area_before": area,
        "area_after": total("own_area_after"),
        "max_displacement": max(one["largest"] for one in reports),
        "rms_displacement": math.sqrt(total("squares") / area) if area else 0.0,
        "limited_share": mean_share("limited_share", reports),
    }
    precision = (
        math.sqrt(total("rounding_squares") / moved),
        math.sqrt(total("moved_squares") / moved),
        max(one["largest_coordinate"] for one in reports),
    )
    return with_warnings(report, _warnings(ran)), precision


def _warnings(reports: list[dict[str, Any]]) -> list[Warned]:
    """Return each kind of warning once, although its numbers differ from tile to tile."""
    kinds: dict[tuple[str, str], list[Warned]] = {}
    for one in reports:
        for kind, warning in {each.kind: each for each in warned(one)}.items():
            kinds.setdefault(kind, []).append(warning)
    return [
        first
        if len({first, *others}) == 1 and 1 + len(others) == len(reports)
        else Warned(first.code, f"{first} (in {1 + len(others)} of {len(reports)} tiles)")
        for first, *others in kinds.values()
    ]
