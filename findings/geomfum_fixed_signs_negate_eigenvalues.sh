#!/bin/sh
# geomfum 1.0.0: LaplacianSpectrumFinder(fix_sign=True) returns negative eigenvalues of the Laplacian.
#
# "Whether to have all the first components with positive sign": where an eigenvector is turned over, its
# eigenvalue is multiplied by -1, too. The stiffness is positive semidefinite, so no eigenvalue is below 0.
# Which ones turn depends on the solver's start. Take the absolute values.
#
# Seen: on a unit sphere eigenvalues of about -2 and -6 among those of l (l + 1) = 2 and 6; their absolute values
# are those without fix_sign.
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
from geomfum.laplacian import LaplacianSpectrumFinder
from geomfum.shape import TriangleMesh

mesh = trimesh.creation.icosphere(subdivisions=3)
shape = TriangleMesh(np.array(mesh.vertices), np.array(mesh.faces))
shape.laplacian.find()
plain = LaplacianSpectrumFinder(spectrum_size=36)(shape, as_basis=False)[0]
fixed = LaplacianSpectrumFinder(spectrum_size=36, fix_sign=True)(shape, as_basis=False)[0]
print("plain", np.round(plain[:9], 2), "fixed", np.round(fixed[:9], 2))
assert (plain > -1e-9).all(), "this has changed"
assert (fixed < -1).any(), "this has changed"
assert np.allclose(np.abs(fixed), np.abs(plain), atol=1e-9), "this has changed"
END
