"""`surface_texture` without an L-filter: every parameter of the standard against closed forms."""

from __future__ import annotations

from statistics import NormalDist
from typing import Any

import numpy as np
import pytest
from meshlab_spectral import surface_texture
from numpy.typing import NDArray
from shapes import quads

Array = NDArray[np.float64]

PERIODS, PER_PERIOD, ALONG = 8, 41, 96
AMPLITUDE = 3e-4
ACROSS = PERIODS * PER_PERIOD
ZONE = 0.9  # of the unit sphere: the part of its axis that it covers

PHASE = (np.arange(41_000) + 0.5) / 41_000


def bars(width: int) -> Any:
    """Two levels of the mean 0 and a distance of 2: bars of so many vertices of a period."""
    share = width / PER_PERIOD
    return lambda x: np.where(np.abs((x + 0.5) % 1 - 0.5) < share / 2, 2 - 2 * share, -2 * share)


# Of each signal: its height over the phase, even, and the root mean square of its slope in it; 0
# for flanks of one cell. Waves are oblique, and so meet the vertices at all phases; at the corners
# of ramps, cells are flatter, in the mean of their squares by two thirds.
SIGNALS: dict[str, tuple[Any, float]] = {
    "sinusoid": (lambda x: np.cos(2 * np.pi * x), np.sqrt(2) * np.pi),
    "ramps": (
        lambda x: 1 - 4 * np.abs((x + 0.5) % 1 - 0.5),
        4 * np.sqrt(1 - 2 / PER_PERIOD * 2 / 3),
    ),
    "steps": (bars(21), 0.0),
    "grating": (bars(13), 0.0),
    "noise": (None, 0.0),
}


def quantiles(signal: str, count: int) -> Array:
    """Heights that ever more of the area exceeds, of an amplitude of 1."""
    if signal == "noise":
        shares = (np.arange(count) + 0.5) / count
        return np.array([NormalDist().inv_cdf(p) for p in shares])[::-1]
    heights: Array = np.sort(SIGNALS[signal][0](PHASE))[::-1]
    return heights


def of_distribution(z: Array) -> dict[str, float]:
    """The parameters of heights of equal areas, descending, by their definitions."""
    Sq = np.sqrt((z**2).mean())
    curve = z[np.minimum((np.linspace(0, 1, 1001) * len(z)).astype(int), len(z) - 1)]
    first = int(np.argmin(curve[:-400] - curve[400:]))  # of the flattest 40 %
    ratio = np.linspace(0, 1, 1001)[first : first + 401]
    slope, top = np.polyfit(ratio, curve[first : first + 401], 1)
    bottom, peaks, valleys = top + slope, z > top + 1e-9, z < top + slope - 1e-9
    return {
        "Sa": np.abs(z).mean(),
        "Sq": Sq,
        "Sp": z[0],
        "Sv": -z[-1],
        "Sz": z[0] - z[-1],
        "Ssk": (z**3).mean() / Sq**3,
        "Sku": (z**4).mean() / Sq**4,
        "Sk": -slope,
        "Spk": 2 * (z[peaks] - top).mean() if peaks.any() else 0.0,
        "Svk": 2 * (bottom - z[valleys]).mean() if valleys.any() else 0.0,
        "Smr1": peaks.mean(),
        "Smr2": 1 - valleys.mean(),
    }


def mesh_of(form: str, h: Array) -> tuple[Array, NDArray[Any]]:
    """Heights over a plane or a zone of a sphere, by rows, or around a cylinder."""
    rows = np.arange(ACROSS + 1)[:, None] / ACROSS
    columns = np.arange(h.shape[1])[None, :] / ALONG
    if form == "plane":
        parts = rows * PERIODS, columns * PERIODS, AMPLITUDE * h
    elif form == "cylinder":
        r, angle = 1 + AMPLITUDE * h, 2 * np.pi * rows
        parts = r * np.cos(angle), r * np.sin(angle), columns * 2
    else:
        r, angle, t = 1 + AMPLITUDE * h, 2 * np.pi * columns, ZONE * (1 - 2 * rows)
        s = np.sqrt(1 - t**2)
        parts = r * s * np.cos(angle), r * s * np.sin(angle), r * t
    i = np.arange(h.size).reshape(h.shape)
    if form == "cylinder":  # the last row is the first one, and so is the last column of a sphere
        i[-1] = i[0]
    elif form == "sphere":
        i[:, -1] = i[:, 0]
    return np.stack(np.broadcast_arrays(*parts), axis=-1).reshape(-1, 3), quads(i)


def rms_slope(signal: str, form: str) -> float:
    """The root mean square slope of an amplitude of 1, linear between the vertices of a mesh."""
    step, sideways = {
        "plane": (PERIODS / ACROSS, PERIODS / ALONG),
        "cylinder": (2 * np.pi / ACROSS, 2 / ALONG),
        "sphere": (2 * ZONE / ACROSS, 2 * np.pi / ALONG),
    }[form]
    # Means over the zone of the squared sine of the polar angle, and of its inverse.
    sine, inverse = (1 - ZONE**2 / 3, np.arctanh(ZONE) / ZONE) if form == "sphere" else (1.0, 1.0)
    if signal == "noise":
        squared = 2 * (sine / step**2 + inverse / sideways**2)
    elif slope := SIGNALS[signal][1]:
        squared = slope**2 * (sine / (PER_PERIOD * step) ** 2 + inverse / (ALONG * sideways) ** 2)
    else:
        squared = sine * 8 / PER_PERIOD / step**2  # two flanks a period, over twice the amplitude
    return float(np.sqrt(squared))


def heights_of(signal: str) -> Array:
    shape = (ACROSS + 1, ALONG + 1)
    if signal == "noise":
        ordered = quantiles(signal, shape[0] * shape[1])
        return np.random.default_rng(8).permutation(ordered).reshape(shape)
    i, j = np.indices(shape)
    phase = i / PER_PERIOD + j / ALONG if SIGNALS[signal][1] else i / PER_PERIOD
    heights: Array = SIGNALS[signal][0](phase)
    return heights


@pytest.mark.parametrize("form", ["plane", "cylinder", "sphere"])
@pytest.mark.parametrize("signal", SIGNALS)
def test_parameters_are_those_of_the_closed_form(signal: str, form: str) -> None:
    texture = surface_texture(*mesh_of(form, heights_of(signal)), waviness="100%", form=form)
    exact = of_distribution(quantiles(signal, (ACROSS + 1) * (ALONG + 1)))
    measured = {name: getattr(texture, name) for name in exact}
    if SIGNALS[signal][1]:  # the flattest part is at either end: peaks may be valleys
        for parts in (exact, measured):
            parts["both"] = parts.pop("Spk") + parts.pop("Svk")
            parts["outside"] = parts.pop("Smr1") + 1 - parts.pop("Smr2")
    elif signal != "noise" and form != "plane":  # levels differ by what the fit is off
        for name in ("Smr1", "Smr2"):
            del exact[name]
    lengths = {"Sa", "Sq", "Sp", "Sv", "Sz", "Sk", "Spk", "Svk", "both"}
    for name, value in exact.items():
        scale = AMPLITUDE if name in lengths else 1.0
        expected = pytest.approx(value * scale, rel=0.01, abs=0.01 * scale)
        assert measured[name] == expected, name
    slope = AMPLITUDE * rms_slope(signal, form)
    assert texture.Sdq == pytest.approx(slope, rel=0.01)
    assert texture.Sdr == pytest.approx(slope**2 / 2, rel=0.01)
    for c in (-0.5, 0.0, 0.5):
        share = (quantiles(signal, 20_000) >= c).mean()
        assert texture.material_ratio(c * AMPLITUDE) == pytest.approx(share, abs=0.01)
    if form == "plane" and signal == "sinusoid":
        length = 1 / np.hypot(1, 1 / PERIODS)
        assert texture.Sal == pytest.approx(np.arccos(0.2) / (2 * np.pi) * length, rel=0.01)
        assert texture.Str is None  # crests have no end
    if form == "plane" and signal == "noise":
        step, sideways = PERIODS / ACROSS, PERIODS / ALONG
        assert texture.Sal == pytest.approx(0.8 * step, rel=0.01)  # linear between two lags
        assert texture.Str == pytest.approx(step / np.hypot(step, sideways), rel=0.01)
