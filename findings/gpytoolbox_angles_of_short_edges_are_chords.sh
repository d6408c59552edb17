#!/bin/sh
# gpytoolbox 0.3.8: angles and angle defects of triangles whose edges are shorter than 1.2e-4 are wrong.
#
# "A different, more stable formula for small angles", by default, is used where the opposite *side* is short: its
# squared length below 1.5e-8, in whatever unit. The formula returns the chord, 2 sin(angle / 2), which is the angle
# only if that is small: 60 degrees become 57.3. What is summed around a vertex no longer makes 2 pi, so that a scan in
# metres, with edges of a tenth of a millimetre, is curved everywhere. Scale first, or use_small_angle_approx=False.
#
# Seen: a sphere's sum of angle defects, 4 pi: 1.000 of it at radius .01 and .003, 60 times as much at .001; 1.000
# without the approximation; corners of an even triangle 1.0472, and 1 with sides of 1e-4.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
  gpytoolbox==0.3.8 trimesh==5.2.0 numpy==2.4.6 scipy==1.17.1
cd "$folder"
venv/bin/python - <<'END'
import gpytoolbox
import numpy as np
import trimesh

seen = {}
for radius in (0.01, 0.003, 0.001):
    sphere = trimesh.creation.icosphere(subdivisions=4, radius=radius)
    vertices, faces = np.array(sphere.vertices), np.array(sphere.faces)
    seen[radius] = [
        gpytoolbox.angle_defect(vertices, faces, use_small_angle_approx=is_used).sum() / (4 * np.pi)
        for is_used in (True, False)
    ]
triangle = np.array([[0, 0], [1, 0], [0.5, np.sqrt(0.75)]])
one, small = (gpytoolbox.tip_angles(side * triangle, np.array([[0, 1, 2]])) for side in (1, 1e-4))
print(seen, one, small)
assert all(abs(right - 1) < 1e-6 for _, right in seen.values()), "this has changed"
assert abs(seen[0.003][0] - 1) < 1e-6 and 50 < seen[0.001][0] < 70, "this has changed"
assert np.allclose(one, np.pi / 3) and np.allclose(small, 1), "this has changed"
END
