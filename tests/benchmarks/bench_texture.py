"""Surface texture of height maps against surfalize, as a table.

usage: bench_texture.py [--cells N]

Maps are mirrored, so that their ends weigh the same in both programs: surfalize counts pixels,
this package areas, of which an end has half. A row is a map and a filter: the parameters of the
standard by us, and their largest difference to surfalize's, relative but of the skewness. Filtered
maps are compared where no end is within a cutoff; surfalize samples the Gaussian to four standard
deviations. The last rows are maps as they are, with ends, against the integrals over the square.
"""

from __future__ import annotations

import argparse
from typing import Any

import numpy as np
import surfalize
from meshlab_spectral import SurfaceTexture, surface_texture
from numpy.typing import NDArray
from rich.box import MARKDOWN
from rich.console import Console
from rich.table import Table
from scipy.ndimage import gaussian_filter

Array = NDArray[np.float64]

PARAMETERS = ("Sa", "Sq", "Ssk", "Sku", "Sz", "Sdr")
STEP = 0.1
WAVINESS, NOISE = 2.5, 0.5


def maps(cells: int) -> dict[str, Array]:
    """Heights on a square of so many cells."""
    rng = np.random.default_rng(3)
    x = STEP * np.arange(cells + 1)
    x, y = np.meshgrid(x, x, indexing="ij")
    rough = gaussian_filter(rng.standard_normal(x.shape), 3)
    rough /= rough.std()
    return {
        "crossing waves": 0.01 * (np.cos(2 * x + 1.7 * y) + 0.5 * np.cos(3.6 * x - 1.3 * y)),
        "random": 0.02 * rough,
        "pits": -0.02 * np.maximum(0, rough - 0.5) ** 2,
        "peaks": 0.005 * np.exp(rough),
        "steps": 0.02 * np.round(1.5 * rough),
    }


def mesh_of(z: Array) -> tuple[Array, NDArray[Any]]:
    n, m = z.shape
    x, y = np.meshgrid(STEP * np.arange(n), STEP * np.arange(m), indexing="ij")
    i = np.arange(n * m).reshape(n, m)
    a, b, c, d = (k.ravel() for k in (i[:-1, :-1], i[1:, :-1], i[1:, 1:], i[:-1, 1:]))
    F = np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    return np.column_stack([x.ravel(), y.ravel(), z.ravel()]), F


def of_surfalize(surface: surfalize.Surface) -> list[float]:
    values = {name: float(getattr(surface, name)()) for name in PARAMETERS}
    return [*(values[name] for name in PARAMETERS[:-1]), values["Sdr"] / 100]


def of_mesh(texture: SurfaceTexture) -> list[float]:
    return [getattr(texture, name) for name in PARAMETERS]


def differences(ours: list[float], theirs: list[float]) -> list[float]:
    scales = [1.0 if name == "Ssk" else abs(b) for name, b in zip(PARAMETERS, theirs, strict=True)]
    return [abs(a - b) / scale for a, b, scale in zip(ours, theirs, scales, strict=True)]


def whole(z: Array) -> tuple[list[float], list[float]]:
    """Parameters of a mirrored map: a period of it has each pixel once."""
    texture = surface_texture(*mesh_of(z), waviness="100%", form="plane", crease_angle=180)
    period = surfalize.Surface(z[:-1, :-1] - z[:-1, :-1].mean(), STEP, STEP)
    theirs = of_surfalize(period)
    theirs[-1] = of_surfalize(surfalize.Surface(z, STEP, STEP))[-1]  # by cells: all of them
    return of_mesh(texture), theirs


def filtered(z: Array, waviness: float, noise: float) -> tuple[list[float], list[float]]:
    """Parameters inside of a filtered map: all that is further from its ends than the cutoff."""
    inside = int(np.ceil(waviness / STEP + 1e-9)) + 1
    part = np.zeros(z.shape, dtype=bool)
    part[inside:-inside, inside:-inside] = True
    texture = surface_texture(
        *mesh_of(z),
        waviness=waviness,
        noise=noise or "auto",
        form="plane",
        crease_angle=180,
    )
    surface = surfalize.Surface(z, STEP, STEP)
    if noise:
        surface = surface.filter("lowpass", noise, endeffect_mode="mirror")
    surface = surface.filter("highpass", waviness, endeffect_mode="mirror")
    n = z.shape[0] - 2 * inside
    ours = surfalize.Surface(texture.height[part.ravel()].reshape(n, n), STEP, STEP)
    theirs = surfalize.Surface(surface.data[inside:-inside, inside:-inside], STEP, STEP)
    return of_surfalize(ours), of_surfalize(theirs)


def with_ends(cells: int) -> tuple[list[float], list[float], list[float]]:
    """Parameters of x^4 less its line over the unit square: ours, surfalize's, integrals."""
    x = np.arange(cells + 1) / cells
    shape = np.polynomial.Polynomial([0.2, -0.8, 0, 0, 1])
    size = cells * STEP
    z = np.broadcast_to(1e-3 * size * shape(x)[:, None], (cells + 1, cells + 1))
    texture = surface_texture(*mesh_of(z), waviness="100%", form="plane", crease_angle=180)
    theirs = of_surfalize(surfalize.Surface(z, STEP, STEP).level())
    fine = np.abs(shape((np.arange(10**6) + 0.5) / 10**6))
    squares, cubes, fourths = ((shape**power).integ()(1) for power in (2, 3, 4))
    exact = [
        1e-3 * size * fine.mean(),
        1e-3 * size * squares**0.5,
        cubes / squares**1.5,
        fourths / squares**2,
        1e-3 * size * np.ptp(shape(np.arange(10**6 + 1) / 10**6)),
        5e-7 * (shape.deriv() ** 2).integ()(1),
    ]
    return of_mesh(texture), theirs, exact


def main() -> None:
    parser = argparse.ArgumentParser(
        usage=__doc__.split("\n\n")[1].removeprefix("usage: "), description=__doc__
    )
    parser.add_argument("--cells", type=int, default=160, help="of a side, before mirroring (160)")
    cells = parser.parse_args().cells
    table = Table(box=MARKDOWN)
    for title in ("map", "filter", *PARAMETERS, *(f"d{name}" for name in PARAMETERS)):
        table.add_column(title, no_wrap=True)

    def add(name: str, kind: str, ours: list[float], theirs: list[float]) -> None:
        table.add_row(
            name,
            kind,
            *(f"{value:.4g}" for value in ours),
            *(f"{value:.0e}" for value in differences(ours, theirs)),
        )

    for name, z in maps(cells).items():
        mirrored = np.pad(z, (0, cells), mode="reflect")
        add(name, "none", *whole(mirrored))
        add(name, "L", *filtered(mirrored, WAVINESS, 0.0))
        add(name, "S, L", *filtered(mirrored, WAVINESS, NOISE))
    for count in (cells, 4 * cells):
        ours, theirs, exact = with_ends(count)
        add(f"{count} cells with ends: ours", "exact", ours, exact)
        add(f"{count} cells with ends: surfalize", "exact", theirs, exact)
    Console(width=200).print(table)


if __name__ == "__main__":
    main()
