"""Spectral Denoise: degrees by kind of noise, clean meshes bit for bit, heights as measured."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Iterator
from functools import partial

import meshlab_spectral
import numpy as np
from bench_denoise import ESTIMATED, GROUPS, CleanRow, Pair, clean_rows, noise_of
from denoising_methods import METHODS
from meshlab_spectral.filters.arrays import mean_edge

from promises.meshes import loaded
from promises.record import (
    Absent,
    Found,
    Promise,
    at_least,
    at_most,
    exactly,
    largest,
    promise,
    shared,
)

# Degrees to the normals of the truth, as the tables of README.md and tests/benchmarks/README.md
# round them.
BY_KIND: dict[str, tuple[tuple[str, ...], float]] = {
    "smooth shapes, noise of 0.2 to 0.3 edges (4)": (GROUPS["smooth shapes"], 6.85),
    "machine parts, noise of 0.3 to 0.4 edges (3)": (GROUPS["machine parts"], 3.35),
    "synthetic, noise of 0.1 to 0.3 edges (25)": (GROUPS["synthetic"], 2.05),
    "noise in all directions": (("TGV_Block",), 1.95),
    "impulses at all vertices": (("nicolo_i6",), 5.45),
    "spikes at a fifth of the vertices": (("pierrot_i3",), 4.25),
    "a Kinect scan": (("kinect_Cone",), 8.55),
    "a depth camera, simulated": (("depth_igea",), 9.65),
    "segmentation, 64 voxels, of a head": (("stair64x1_igea",), 9.05),
    "segmentation, 64 voxels, of a machine part": (("stair64x1_fandisk",), 8.35),
    "segmentation, slices three times as thick": (("stair96x3_fandisk",), 8.45),
}
SMOOTH_NOISE = "corr2_bunny"
# Largest relative error of the estimates in the table of tests/benchmarks/README.md.
HEIGHTS = {0.1: 0.125, 0.2: 0.0375, 0.4: 0.095}


def promises() -> Iterator[Promise]:
    yield from degrees_by_kind()
    yield from smooth_noise()
    yield from not_behind_taubin()
    yield from clean_meshes()
    yield from estimates()


def degrees_by_kind() -> Iterator[Promise]:
    """Mean angles to the truth, of the tables in README.md and tests/benchmarks/README.md."""
    for kind, (names, bound) in BY_KIND.items():
        yield promise(f"degrees: {kind}", at_most(bound), partial(mean_degrees, names))


def smooth_noise() -> Iterator[Promise]:
    """Smooth ripples may be real shape: kept, unless height and size are set (README.md)."""
    yield promise(
        "vertices moved by default: smooth noise over two edges", exactly(0), moved_of_smooth
    )
    yield promise(
        "degrees with noise_height 0.15e, noise_size 2e: smooth noise over two edges",
        at_most(6.15),
        partial(degrees, SMOOTH_NOISE, noise_height="0.15e", noise_size="2e"),
    )


def not_behind_taubin() -> Iterator[Promise]:
    """No pair is more than 0.3 degrees behind Taubin's best (tests/benchmarks/README.md)."""
    yield promise("degrees behind Taubin smoothing at its best", at_most(0.3), behind_taubin)


def clean_meshes() -> Iterator[Promise]:
    """ "No vertex moves"; with a little noise, none is worse (tests/benchmarks/README.md).

    97: CAD tessellations, scans, clean halves, decimated meshes; fewer would promise less.
    """
    yield promise("meshes without noise, asked", at_least(97), lambda: len(clean()))
    yield promise("meshes without noise that move", exactly(0), clean_meshes_that_move)
    yield promise(
        "clean meshes with noise of 0.05 edges, worse than before", exactly(0), clean_meshes_worse
    )


def estimates() -> Iterator[Promise]:
    """White noise of known height is measured as in the table of tests/benchmarks/README.md."""
    for height, bound in HEIGHTS.items():
        yield promise(
            f"relative error of the height, white noise of {height} edges (8)",
            at_most(bound),
            partial(error_of_estimates, height),
        )


@functools.cache
def pair(name: str) -> Pair:
    shared(f"denoise/{name}_noisy.ply")
    return Pair(shared("denoise"), name)


@functools.cache
def degrees(name: str, **options: str) -> float:
    """Mean angle to the truth after Spectral Denoise."""
    X, _ = meshlab_spectral.denoise_mesh(pair(name).V, pair(name).F, **options)
    return pair(name).angle(X)


def present(names: Iterable[str]) -> list[str]:
    """Return the names of pairs that are there; not every synthetic shape has all three heights."""
    found = [name for name in names if (shared("denoise") / f"{name}_noisy.ply").exists()]
    if not found:
        raise Absent(f"denoise/{next(iter(names))}_noisy.ply")
    return found


def mean_degrees(names: tuple[str, ...]) -> Found:
    found = [degrees(name) for name in present(names)]
    return Found(float(np.mean(found)), f"mean of {len(found)}" * (len(found) > 1))


def moved_of_smooth() -> int:
    one = pair(SMOOTH_NOISE)
    X, _ = meshlab_spectral.denoise_mesh(one.V, one.F)
    return int(np.any(X != one.V, axis=1).sum())


def behind_taubin() -> Found:
    smoothing, steps = METHODS["Taubin"]
    names = present([name for names, _ in BY_KIND.values() for name in names])

    def best(one: Pair) -> float:
        return min(one.angle(smoothing(one.V, one.F, count)) for count in steps)

    return largest((name, degrees(name) - best(pair(name))) for name in names)


@functools.cache
def clean() -> list[CleanRow]:
    for folder in ("cad", "data", "denoise"):
        shared(folder)
    return list(clean_rows([]))


def clean_meshes_that_move() -> Found:
    moved = [row.name for row in clean() if row.moved > 0]
    return Found(len(moved), ", ".join(moved))


def clean_meshes_worse() -> Found:
    worse = [row.name for row in clean() if row.after > row.before]
    return Found(len(worse), ", ".join(worse))


def error_of_estimates(height: float) -> Found:
    return largest((name, error_of_estimate(name, height)) for name in ESTIMATED)


def error_of_estimate(name: str, height: float) -> float:
    V, F = loaded(f"data/{name}")
    noise = noise_of("white", height, V, F)
    _, report = meshlab_spectral.denoise_mesh(V + noise, F)
    edge = mean_edge(V, F)
    return abs(report["estimated_noise_height"] / (height * edge) - 1)
