"""Names for what users want, and the options that do it."""

from __future__ import annotations

from typing import Literal, get_args

Preset = Literal["smooth", "remove-details", "sharpen", "enhance", "caricature", "extract-details"]

# Values as on the command line. Sizes are left to the user where the wish contains one.
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
assert get_args(Preset) == tuple(PRESETS)
