#!/bin/sh
# point-cloud-utils 0.34.0: laplacian_smooth_mesh(use_cotan_weights=True) returns a mesh of another size.
#
# After every step the mesh is divided by the square root of its area, around its centroid: the result has unit area,
# whatever the unit of length. Nothing says so, and the scale is not returned; with the default weights the size is
# kept. Scale the result back; step_size, an area, is of the scaled mesh after the first step.
#
# Seen: spheres of radius .001, 1 and 50 around (3, 0, 0), one step: radius .2828, about the square root of 1 / (4 pi),
# of all three; with the default weights .001, .996 and 49.8.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
  point-cloud-utils==0.34.0 trimesh==5.2.0 numpy==2.4.6 scipy==1.17.1
cd "$folder"
venv/bin/python - <<'END'
import numpy as np
import point_cloud_utils
import trimesh

seen = {}
for radius in (0.001, 1, 50):
    sphere = trimesh.creation.icosphere(subdivisions=3, radius=radius).apply_translation((3, 0, 0))
    vertices, faces = np.array(sphere.vertices), np.array(sphere.faces)
    for is_cotan in (False, True):
        smooth = point_cloud_utils.laplacian_smooth_mesh(vertices, faces, 1, use_cotan_weights=is_cotan)
        area = trimesh.Trimesh(smooth, faces).area
        seen[radius, is_cotan] = area, np.linalg.norm(smooth - (3, 0, 0), axis=1).mean()
print({key: np.round(value, 4).tolist() for key, value in seen.items()})
for (radius, is_cotan), (area, found) in seen.items():
    if is_cotan:
        assert abs(area - 1) < 0.01 and abs(found - 0.2828) < 0.001, "this has changed"
    else:
        assert abs(found / radius - 1) < 0.01, "this has changed"
END
