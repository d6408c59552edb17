"""Signatures of points from the harmonics of a surface: the heat kernel's and the wave kernel's.

``W phi_i = lambda_i D phi_i``, the phi_i orthonormal with D. Both signatures are weighted sums of
phi_i(x)^2, which neither signs nor the choice of a basis for a repeated eigenvalue change.

J. Sun, M. Ovsjanikov, L. Guibas: A Concise and Provably Informative Multi-Scale Signature Based on
Heat Diffusion, SGP 2009. M. Aubry, U. Schlickewei, D. Cremers: The Wave Kernel Signature: A Quantum
Mechanical Approach to Shape Analysis, ICCV Workshops 2011.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Standard deviation of an energy distribution, in distances of adjacent energies (Aubry et al.).
_DEVIATION = 7
# Distance of the outermost energies from the ends of the spectrum, in standard deviations.
_MARGIN = 2


def heat_times(lam: Array, count: int) -> Array:
    """Sample times from fine to coarse, as Sun et al. do.

    Parameters
    ----------
    lam
        Eigenvalues, ascending; at least one is positive.
    count
        Number of times.

    Returns
    -------
    array
        `count` times in geometric progression, length^2. At the first one the last harmonic has
        faded to 1e-4, at the last one all but the constants.
    """
    positive = lam[lam > 0]
    # 4 ln 10 / lambda_k <= t <= 4 ln 10 / lambda_2
    return np.geomspace(4 * np.log(10) / positive[-1], 4 * np.log(10) / positive[0], count)


def heat_kernel(lam: Array, Phi: Array, t: Array) -> Array:
    """Compute how much of a unit of heat is still at its vertex, per area, after each time.

    Parameters
    ----------
    lam, Phi
        k eigenvalues, n x k harmonics.
    t
        T times, >= 0, length^2.

    Returns
    -------
    array
        n x T values, >= 0, 1 / length^2.
    """
    # h_t(x) = k_t(x, x) = sum_i exp(-lambda_i t) phi_i(x)^2
    signature: Array = Phi**2 @ np.exp(-np.outer(lam, t))
    return signature


def wave_energies(lam: Array, count: int) -> tuple[Array, float]:
    """Sample logarithmic energies evenly over a spectrum, as Aubry et al. do.

    With delta the distance of adjacent energies, ``sigma = 7 delta``; the first and the last energy
    are 2 sigma within the spectrum, so that every distribution lies mostly inside.

    Parameters
    ----------
    lam
        Eigenvalues, ascending; at least two different ones are positive.
    count
        Number of energies, >= 1.

    Returns
    -------
    tuple of array and float
        `count` energies e, logarithms of eigenvalues, and sigma > 0.
    """
    log_lam = np.log(lam[lam > 0])
    first, last = log_lam[0], log_lam[-1]
    # last - first = (count - 1) delta + 2 * 2 sigma
    delta = (last - first) / (count - 1 + 2 * _MARGIN * _DEVIATION)
    sigma = _DEVIATION * delta
    # log lambda_2 + 2 sigma <= e <= log lambda_k - 2 sigma
    e = first + _MARGIN * sigma + delta * np.arange(count)
    return e, float(sigma)


def wave_kernel(lam: Array, Phi: Array, e: Array, sigma: float) -> Array:
    """Compute how likely a particle is at each vertex, per area, for each distribution of energy.

    Parameters
    ----------
    lam, Phi
        k eigenvalues, n x k harmonics; constants, which have no logarithmic energy, are left out.
    e, sigma
        T logarithmic energies, and the standard deviation of the distributions around them.

    Returns
    -------
    array
        n x T values, >= 0, 1 / length^2; each column integrates to 1 over the surface.
    """
    waves = lam > 0
    # (e - log lambda_i)^2 / (2 sigma^2)
    exponent = (np.log(lam[waves])[:, None] - e) ** 2 / (2 * sigma**2)
    # C_e cancels a common factor: without it all weights of an energy in a gap would underflow.
    f_e = np.exp(exponent.min(axis=0) - exponent)
    # C_e = 1 / sum_i exp(-(e - log lambda_i)^2 / (2 sigma^2))
    C_e = 1 / f_e.sum(axis=0)
    # WKS(x, e) = C_e sum_i phi_i(x)^2 exp(-(e - log lambda_i)^2 / (2 sigma^2))
    signature: Array = Phi[:, waves] ** 2 @ (C_e * f_e)
    return signature
