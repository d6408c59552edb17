"""Transfer functions that several tests compare with the reference's."""

from __future__ import annotations

from typing import Any

import spectral_reference as reference

TRANSFER_NAMES = ("filter_type", "response", "order", "band_width", "pass_gain", "stop_gain")

# Options that do something plain to see in every octave that these meshes can carry.
TYPES: dict[str, dict[str, Any]] = {
    "low-pass": {"filter_type": "low-pass"},
    "low-pass that keeps a part": {"filter_type": "low-pass", "stop_gain": 0.25},
    "high-pass": {"filter_type": "high-pass"},
    "sharpening": {"filter_type": "high-pass", "stop_gain": 1.0, "pass_gain": 2.0},
    "band-pass": {"filter_type": "band-pass", "band_width": 1.5},
    "enhancement": {"filter_type": "band-pass", "stop_gain": 1.0, "pass_gain": 2.5},
    "band-stop": {"filter_type": "band-stop"},
}
RESPONSES: dict[str, dict[str, Any]] = {
    "gaussian": {"response": "gaussian"},
    "butterworth 1": {"response": "butterworth", "order": 1},
    "butterworth 2": {"response": "butterworth", "order": 2},
    "butterworth 4": {"response": "butterworth", "order": 4},
}


def gain_of(options: dict[str, Any], report: dict[str, Any]) -> reference.Gain:
    """Take the feature size from the report: as a parameter it went through a 32-bit float."""
    transfer = {name: options[name] for name in TRANSFER_NAMES if name in options}
    transfer.setdefault("filter_type", "low-pass")
    return reference.transfer_function(feature_size=report["feature_size"], **transfer)
