#!/bin/sh
# geomfum 1.0.0: heat and wave kernel signatures lose eigenvalues of shapes that are measured in small units.
#
# "Nonzero" eigenvalues are those above 1e-3, whatever the unit of length, and eigenvalues are 1 / length^2: of a
# head or a statue in millimetres the first ones, which say the most, count as zero. The signatures' default times
# and energies begin after them, and the wave kernel gives them the weight 0. Scale to unit area first.
#
# Seen: of the first 16 eigenvalues of an ellipsoid one is zero: 15 are left at size 1, 10 at size 60; the wave
# kernel signature at one vertex differs by .45 of its largest value.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps \
  geomfum==1.0.0 gsops==0.1.0 pyfmaps==1.3.1 potpourri3d==1.4.0 robust_laplacian==1.1.0 trimesh==5.2.0 \
  networkx==3.6.1 tqdm==4.70.1 meshio==5.3.5 rich==15.0.0 scikit-learn==1.9.1 joblib==1.6.0 cloudpickle==3.1.3 narwhals==2.29.0 \
  threadpoolctl==3.8.0 numpy==2.4.6 scipy==1.17.1
cd "$folder"
venv/bin/python - <<'END'
import numpy as np
import trimesh
from geomfum.descriptor.spectral import WaveKernelSignature
from geomfum.shape import TriangleMesh

counts, eigenvalues, signatures = [], [], []
for radius in (1, 60):
    mesh = trimesh.creation.icosphere(subdivisions=3, radius=radius)
    shape = TriangleMesh(np.array(mesh.vertices) * (1, 1.2, 1.5), np.array(mesh.faces))
    shape.laplacian.find_spectrum(spectrum_size=16, set_as_basis=True)
    eigenvalues.append(shape.basis.vals * radius**2)
    counts.append(len(shape.basis.nonzero_vals))
    signature = WaveKernelSignature(scale=True, n_domain=5)(shape)
    signatures.append(signature / np.abs(signature).max())
print("nonzero of 16:", counts, "signatures differ by", np.abs(signatures[0] - signatures[1]).max())
assert np.allclose(*eigenvalues, atol=1e-6), "this has changed"
assert counts[0] == 15 and counts[1] < 12, "this has changed"
assert np.abs(signatures[0] - signatures[1]).max() > 0.1, "this has changed"
END
