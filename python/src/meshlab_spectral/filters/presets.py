"""Presets: names for common tasks, and the options for them."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf
from typing import Literal, get_args

Preset = Literal["smooth", "remove-details", "sharpen", "enhance", "caricature", "extract-details"]

# Values as on the command line.
PRESETS: dict[Preset, dict[str, str]] = {
    # The default size: about the finest waves that the mesh can represent.
    "smooth": {"filter_type": "low-pass", "feature_size": "auto"},
    "remove-details": {"filter_type": "low-pass", "feature_size": "5%"},
    "sharpen": {
        "filter_type": "high-pass",
        "feature_size": "3%",
        "stop_gain": "1",
        "pass_gain": "2",
    },
    "enhance": {
        "filter_type": "band-pass",
        "feature_size": "8%",
        "stop_gain": "1",
        "pass_gain": "2.5",
    },
    "caricature": {
        "filter_type": "band-pass",
        "feature_size": "25%",
        "band_width": "1.5",
        "stop_gain": "1",
        "pass_gain": "2",
    },
    "extract-details": {"filter_type": "low-pass", "feature_size": "5%", "result": "details"},
}
# Sizes of the equalizer's sliders in mean edges, from coarse to fine, as in MeshLab.
EQUALIZER_EDGES = (96, 48, 24, 12, 6, 3)


def equalizer_points(gains: Sequence[float]) -> str:
    """Return the transfer function of an equalizer's sliders, as points for the filter.

    `gains` has a gain >= 0 for each of `EQUALIZER_EDGES`; larger details keep their height. Raises
    ValueError when their number differs, or one is negative or not finite.
    """
    if len(gains) != len(EQUALIZER_EDGES) or not all(0 <= gain < inf for gain in gains):
        raise ValueError(f"give {len(EQUALIZER_EDGES)} gains from 0 on, such as 1,1,2,1,0.5,0")
    points = zip((2 * EQUALIZER_EDGES[0], *EQUALIZER_EDGES), (1.0, *gains), strict=True)
    return ", ".join(f"{edges}e:{gain:g}" for edges, gain in points)


assert get_args(Preset) == tuple(PRESETS)
