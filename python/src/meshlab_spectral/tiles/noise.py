"""Noise of a mesh in tiles: measured in some of them, and removed from all alike."""

from __future__ import annotations

from statistics import median
from typing import Any

from meshlab_spectral.errors import UntiledError
from meshlab_spectral.filters.options import DenoiseOptions

# How far denoising reaches, in mean edges: beyond, what is cut off turns no normal by a tenth of a
# degree (tests/python/tiles/test_denoise.py).
REACH = 32.0
# Measured in different tiles, the height of noise that is alike differs by less than this factor.
_ALIKE = 1.5
# What has methods of its own, by "noise_kind".
_OF_THE_WHOLE = {"voxels": "steps of voxels", "scan_lines": "scan lines"}


def given_noise(options: DenoiseOptions, diagonal: float, mean_edge: float) -> dict[str, float]:
    """Return the "noise_height" and "noise_size" that are given, as lengths; 0: to be measured."""
    sizes = options.sizes(diagonal, mean_edge, diagonal)
    return {name: sizes[name] or 0.0 for name in ("noise_height", "noise_size")}


def measured_noise(
    reports: list[dict[str, Any]], options: DenoiseOptions, mean_edge: float
) -> dict[str, float]:
    """Return the noise of a mesh, given the reports of tiles that have measured it.

    Raises UntiledError unless it is alike in all of them.
    """
    searched = [one for one in reports if one.get("noise_searched") or one.get("rounds")]
    noisy = [one for one in searched if one["rounds"]]
    if not noisy:
        return {"noise_height": 0.0, "noise_size": 0.0}
    heights = [one["noise_height"] / options.strength for one in noisy]
    if options.noise_height.automatic:
        kinds = {one["noise_kind"] for one in noisy}
        if found := sorted(kinds & _OF_THE_WHOLE.keys()):
            raise UntiledError(f"{_OF_THE_WHOLE[found[0]]} need the whole mesh")
        if len(noisy) < len(searched) or "local" in kinds or max(heights) > _ALIKE * min(heights):
            raise UntiledError(
                "its noise differs from place to place, which tiles cannot measure: give "
                "noise_height, if one is right everywhere"
            )
    # Up to a mean edge, noise is independent at every vertex.
    size = max(mean_edge, median(one["noise_size"] for one in noisy))
    return {"noise_height": median(heights), "noise_size": size}
