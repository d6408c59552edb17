#!/bin/sh
# cat-surf 1.1.6: "mean curvature averaged over 3 mm" follows the length of the edges, not the radius.
#
# surf_curvature with its type 0 gives an angle between neighbours: where edges are longer than 3 mm, their length
# divided by the radius, in degrees. Remeshed surfaces, and those of other units, get other values; types 4, 9 and 10
# are curvatures, in 1 / mm. smoothed_curvatures takes the same angle and then stretches each surface to 0 to 1, which
# neither its documentation nor a message says: round-off on a sphere fills the whole range, and values of two brains
# cannot be compared. Use type 4.
#
# Seen: spheres of radius 50, where all values of a sphere should be equal: type 0 gives 18.2, 10.0 and 5.5 for 162,
# 642 and 2,562 vertices, and 10.0 for a radius of 1000, too; type 4 gives .0200 and .0010. smoothed_curvatures: 0 to 1.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
  cat-surf==1.1.6 trimesh==5.2.0 numpy==2.4.6 scipy==1.17.1
cd "$folder"
venv/bin/python - <<'END'
import cat_surf
import numpy as np
import trimesh


def sphere(radius, subdivisions):
    mesh = trimesh.creation.icosphere(subdivisions=subdivisions)
    return radius * np.array(mesh.vertices), mesh.faces.astype(np.int32)


seen = {}
for radius, subdivisions in ((50, 2), (50, 3), (50, 4), (1000, 3)):
    mesh = sphere(radius, subdivisions)
    angle = cat_surf.surf_curvature(*mesh, 0)
    curvature = cat_surf.surf_curvature(*mesh, 4)
    seen[radius, len(angle)] = angle.mean()
    print(f"radius {radius}, {len(angle)} vertices: type 0 {angle.mean():.2f}, type 4 {curvature.mean():.5f}")
    assert np.isclose(curvature.mean(), 1 / radius, rtol=0.01)
assert seen[50, 162] > 1.7 * seen[50, 642] > 1.7 * 1.7 * seen[50, 2562], "this has changed"
assert np.isclose(seen[1000, 642], seen[50, 642], rtol=0.01), "this has changed"
smoothed = cat_surf.smoothed_curvatures(*sphere(50, 3), 0, 0)
print(f"smoothed_curvatures of a sphere: {smoothed.min():.2f} to {smoothed.max():.2f}")
assert smoothed.min() == 0 and smoothed.max() == 1 and smoothed.std() > 0.2, "this has changed"
END
