"""Geometry Spectrum in MeshLab's log: a size to try, a chart, and one diagnosis of noise."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from fractional import load
from meshlab import MeshLab

MENU = ("Quality Measure and Computations", "Geometry Spectrum")
DENOISE = ("Smoothing, Fairing and Deformation", "Spectral Denoise")
BAR = "\N{FULL BLOCK}"


def test_the_log_names_a_size_charts_the_octaves_and_finds_the_noise_that_denoise_finds(
    install: Callable[[], None], start: Callable[[Path], MeshLab], noisy_bunny: Path
) -> None:
    install()
    meshlab = start(noisy_bunny)
    dialog = meshlab.open_filter(*MENU)
    log = dialog.apply()
    dialog.close()

    report = load(noisy_bunny).apply_filter("get_geometry_spectrum")
    percent = 100 / report["diagonal"]
    size = report["noise_feature_size"]
    assert f"to smooth, try feature size {size:.4g} ({percent * size:.3g} %)" in log

    rows = re.findall(rf"({BAR}+) (\S+) at (\S+) \(", log)
    amplitudes, sizes = report["octave_amplitudes"], report["octave_feature_sizes"]
    assert [float(row[1]) for row in rows] == pytest.approx(list(amplitudes), rel=0.005)
    assert [float(row[2]) for row in rows] == pytest.approx(list(sizes), rel=0.005)
    # Twelve cells at the largest, three less for each factor of ten: nowhere off by a cell.
    cells = np.maximum(1, 12 + 3 * np.log10(amplitudes / amplitudes.max()))
    assert np.abs(np.array([len(row[0]) for row in rows]) - cells).max() <= 0.51

    (noise,) = re.findall(r"(white noise: height [^:]+): Spectral Denoise removes it", log)
    dialog = meshlab.open_filter(*DENOISE)
    assert f"Spectral Denoise: {noise}: removed" in dialog.apply()
    dialog.close()
