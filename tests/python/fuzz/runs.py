"""The number of examples: a few fixed ones, or as many as MESHLAB_SPECTRAL_FUZZ says."""

from __future__ import annotations

import os

from hypothesis import HealthCheck, settings

VARIABLE = "MESHLAB_SPECTRAL_FUZZ"


def as_many_as(examples: int, share: float = 1) -> settings:
    """Return the settings of a test: `examples`, or that share of the number in the environment."""
    asked = os.environ.get(VARIABLE)
    return settings(
        max_examples=max(1, int(share * int(asked))) if asked else examples,
        derandomize=not asked,
        database=None,
        deadline=None,
        print_blob=True,
        suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
    )
