#!/bin/sh
# amaazetools 0.2.7: the principal curvatures of svipca are wrong, and have no unit.
#
# They follow from the volume S of the shape within a ball of radius r: twice the mean curvature is
# 16 / (3 r) - 8 S / (pi r^4). The code's first term is 16 pi r^3 / 3, as if the division by pi r^4 held for both. Their
# difference takes two eigenvalues of three, and is meant to leave out that of the normal, which it does only where
# that comes last. The volume is right. Nothing warns. Take the mean curvature from S, as below.
#
# Seen: a sphere of radius 1, with a ball of .3: -4.6 and -10.7, where the formula gives 1.02 from the same S; a sphere
# of radius 1000 and a ball of 300: 2e8, twice, for .001.
# Needs: python3 with venv, a package index, and a C++ compiler if there is no wheel for the platform.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
  amaazetools==0.2.7 trimesh==5.2.0 numpy==2.4.6 scipy==1.17.1
cd "$folder"
venv/bin/python - <<'END'
import warnings

import numpy as np
import trimesh
from amaazetools import svi

warnings.simplefilter("ignore")
sphere = trimesh.creation.icosphere(subdivisions=4)
faces = np.array(sphere.faces)
for size in (1.0, 1000.0):
    radius = 0.3 * size
    volume, first, second, *_ = svi.svipca(np.array(sphere.vertices) * size, faces, [radius])
    analytic = np.pi * radius**3 * (2 / 3 - radius / (4 * size))
    mean = (8 / 3 / radius - 4 * volume / (np.pi * radius**4)).mean()
    print(f"volume {volume.mean() / analytic:.3f} of the true one")
    print(f"radius {size:g}: {first.mean():.3g} and {second.mean():.3g}; from the volume {mean:.3g}")
    assert abs(volume.mean() / analytic - 1) < 0.01
    assert abs(mean * size - 1) < 0.3
    if size == 1:
        assert first.mean() < -3 and second.mean() < -8, "this has changed"
    else:
        assert first.mean() > 1e6 and second.mean() > 1e6, "this has changed"
END
