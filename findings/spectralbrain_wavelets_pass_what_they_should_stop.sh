#!/bin/sh
# spectralbrain 0.1.0: sgw_transform, wavelets by a Chebyshev series, lets the constant through on fine meshes.
#
# A wavelet is a band-pass, g(x) = x exp(-x), x being scale times eigenvalue: 0 for a constant. The series has 30
# terms, whatever the mesh, over all eigenvalues, the largest of which goes with 1 / edge^2; coarse wavelets, of the
# size of the shape, are at the lowest thousandth of them, and are not resolved. Every subdivision makes it worse: a
# cortex has a hundred thousand vertices. Nothing warns. Give chebyshev_order, in proportion to the number of edges
# across the shape, or take sgw_descriptor, by eigenvectors.
#
# Seen: spheres of 642 and 2,562 vertices, scale 2 / lowest eigenvalue, whose gain is 2 exp(-2) = .271: gains of .30
# and .17 at it, and of .07 and .24 for a constant; .271 and 0 for both by chebyshev_order=300.
# Needs: python3.12 (or 3.11) with venv, a package index; 1 GB of disk.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3.12 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
  spectralbrain==0.1.0 trimesh==5.2.0 numpy==2.4.6 scipy==1.17.1
cd "$folder"
venv/bin/python - <<'END'
import numpy as np
import trimesh
from spectralbrain.core.meshes import BrainMesh
from spectralbrain.spectral.lbo.wavelets import sgw_transform


def gains(subdivisions, order):
    """The wavelet's gain at a constant, and at z, an eigenfunction of the lowest eigenvalue."""
    sphere = trimesh.creation.icosphere(subdivisions=subdivisions)
    mesh = BrainMesh(np.array(sphere.vertices), np.array(sphere.faces))
    stiffness, mass = mesh.compute_laplacian(method="cotangent")
    z = mesh.vertices[:, 2]
    scale = 2 * (z @ (mass @ z)) / (z @ (stiffness @ z))
    signals = np.c_[np.ones(len(z)), z]
    result = sgw_transform(stiffness, np.array([scale]), signal=signals, mass=mass, chebyshev_order=order)[0]
    return (result * signals).sum(axis=0) / (signals**2).sum(axis=0)


seen = {(n, order): gains(n, order) for n in (3, 4) for order in (30, 300)}
for (subdivisions, order), (constant, z) in seen.items():
    print(f"{10 * 4**subdivisions + 2} vertices, order {order}: constant {constant:.3f}, z {z:.3f}")
for subdivisions in (3, 4):
    assert np.abs(seen[subdivisions, 300] - [0, 2 * np.exp(-2)]).max() < 1e-3
assert seen[4, 30][0] > 0.2 and seen[4, 30][1] < 0.2, "this has changed"
assert 0.02 < seen[3, 30][0] < seen[4, 30][0], "this has changed"
END
