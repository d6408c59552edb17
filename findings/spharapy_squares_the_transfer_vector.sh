#!/bin/sh
# spharapy 1.3.0: SpharaFilter multiplies by the square of the transfer vector that it is given.
#
# Its `specification` is a diagonal transfer vector (spharapy.spectral_filters makes some, by their amplitude at
# the cutoff), but the filter matrix has it on both sides of the basis. So a vector of 0.5 leaves a quarter, a
# Butterworth low-pass of -6 dB at a harmonic leaves -12 dB of it, and a low-pass and its high-pass,
# H and 1 - H, do not add up to the input. Vectors of 0 and 1 alone are as one expects. To get H, pass its root.
#
# Seen: .25 of every signal, in all three modes; .2512 of a harmonic at the cutoff of a -6 dB Butterworth filter.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check spharapy==1.3.0 numpy==2.4.6 scipy==1.17.1
cd "$folder"
venv/bin/python - <<'END'
import numpy as np
from spharapy import spectral_filters
from spharapy.spharabasis import SpharaBasis
from spharapy.spharafilter import SpharaFilter
from spharapy.trimesh import TriMesh

# A torus of 24 x 12 vertices.
u, v = np.meshgrid(np.arange(24), np.arange(12), indexing="ij")
a, b = 2 * np.pi * u.ravel() / 24, 2 * np.pi * v.ravel() / 12
vertices = np.column_stack([(3 + np.cos(b)) * np.cos(a), (3 + np.cos(b)) * np.sin(a), np.sin(b)])
index = lambda i, j: (i % 24) * 12 + j % 12
i, j = u.ravel(), v.ravel()
corners = index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)
faces = np.vstack([np.column_stack([corners[k] for k in t]) for t in ((0, 1, 2), (0, 2, 3))])
mesh = TriMesh(faces.tolist(), vertices.tolist())
signal = np.random.default_rng(1).normal(size=(1, len(vertices)))

for mode in ("unit", "inv_euclidean", "fem"):
    half = SpharaFilter(mesh, mode=mode, specification=np.full(len(vertices), 0.5)).filter(signal)
    left = half / signal
    print(f"{mode}: a vector of .5 leaves {left.min():.6f} to {left.max():.6f}")
    assert np.allclose(left, 0.25), "this has changed"

basis, eigenvalues = SpharaBasis(mesh, "fem").basis()
at = 40
H = spectral_filters.transfer_func_butterworth_lowpass(eigenvalues, eigenvalues[at], 4, dB=-6.0)
print(f"H = {H[at]:.4f} at harmonic {at}")
harmonic = basis[:, at]
low = SpharaFilter(mesh, mode="fem", specification=H).filter(harmonic[None])[0]
high = SpharaFilter(mesh, mode="fem", specification=1 - H).filter(harmonic[None])[0]
kept = low @ harmonic / (harmonic @ harmonic)
both = (low + high) @ harmonic / (harmonic @ harmonic)
print(f"left of it: {kept:.4f}; low-pass plus high-pass: {both:.4f}")
assert np.isclose(kept, H[at] ** 2, rtol=1e-3), "this has changed"
assert np.isclose(both, H[at] ** 2 + (1 - H[at]) ** 2, rtol=1e-3), "this has changed"
END
