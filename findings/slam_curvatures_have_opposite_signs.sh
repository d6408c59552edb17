#!/bin/sh
# brain-slam 0.1.3: two functions for principal curvatures have opposite signs.
#
# Where faces point outwards, curvature_fit is negative on a gyrus, which is convex, and curvatures_and_derivatives
# positive. Neither documentation has a sign. The first sorts by value, the second by absolute value, as n x 2 and as 2
# x n. depth_potential_function computes its mean curvature by the second; given that of the first, depths are turned
# over, and sulci are gyri. Nothing warns. Take minus the first.
#
# Seen: curvature times radius of icospheres of radius .01, 1 and 100: -1.02 and -1.02 by curvature_fit, 1.00 and 1.00
# by curvatures_and_derivatives; depths of an ellipsoid by one and by the other have the correlation -1.00.
# Needs: python3.12 (or later) with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3.12 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
  brain-slam==0.1.3 trimesh==5.2.0 numpy==2.4.6 scipy==1.17.1
cd "$folder"
venv/bin/python -W ignore - >log <<'END'
import sys

import numpy as np
import trimesh
from slam.curvature import curvature_fit, curvatures_and_derivatives
from slam.sulcal_depth import depth_potential_function

sphere = trimesh.creation.icosphere(subdivisions=3)
for radius in (0.01, 1, 100):
    mesh = trimesh.Trimesh(sphere.vertices * radius, sphere.faces, process=False)
    fit = curvature_fit(mesh)[0].mean(axis=0) * radius
    derived = curvatures_and_derivatives(mesh)[0].mean(axis=1) * radius
    print(radius, fit.round(3), derived.round(3), file=sys.stderr)
    assert np.abs(fit + 1).max() < 0.05 and np.abs(derived - 1).max() < 0.05, "this has changed"

mesh = trimesh.Trimesh(sphere.vertices * [1, 2, 3], sphere.faces, process=False)
means = curvature_fit(mesh)[0].mean(axis=1), curvatures_and_derivatives(mesh)[0].mean(axis=0)
depths = [depth_potential_function(mesh, curvature=mean)[0] for mean in means]
correlation = np.corrcoef(*depths)[0, 1]
print("depths:", correlation, file=sys.stderr)
assert correlation < -0.95, "this has changed"
END
