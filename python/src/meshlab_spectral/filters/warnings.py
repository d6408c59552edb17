"""What a user should know about a result that fell short."""

from __future__ import annotations

import math
from typing import Any


def report_warnings(report: dict[str, Any]) -> list[str]:
    """Say what a user should know about a result that fell short; empty when nothing did."""
    warnings = []
    if not report["accuracy_reached"]:
        warnings.append(
            f"the evaluation is only accurate to about {report['error_estimate']:.1e}, relative to "
            "the shape's size: the filter is too steep for spectrum = full. Choose a stop gain of "
            "0.05 instead of 0, a lower order, a wider band, or fewer steps"
        )
    if not report["tolerance_reached"]:
        warnings.append(
            f"the tolerance was not reached on {report['singular_part']:.2%} of the surface, where "
            f"the estimated error is {report['step_error']:.2g} and more: parts of it shrink away. "
            "Choose a smaller feature size, or the conformal update where it is not"
        )
    if not report.get("cutoff_reached", True):
        ends = 2.0 * math.pi / math.sqrt(report["eigenvalues"][-1])
        warnings.append(
            f"the {len(report['eigenvalues'])} harmonics end at features of {ends:.4g}, above the "
            f"feature size of {report['feature_size']:.4g}: details between the two are not told "
            "from all finer ones. Choose a larger feature size, a larger basis, or the full "
            "spectrum"
        )
    if report["fixed_vertices"] and report["max_displacement"] == 0:
        warnings.append(
            "nothing moved: every vertex lies on the boundary, which is fixed. Choose boundary "
            "free; where the triangles of the mesh are not connected, apply 'Merge Close "
            "Vertices' first"
        )
    return warnings
