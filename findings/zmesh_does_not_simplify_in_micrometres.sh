#!/bin/sh
# zmesh 1.15.0: of voxels smaller than a tenth of a unit, no triangle is removed, whatever the reduction and the error.
#
# Mesher.get(reduction_factor, max_error) has thresholds of its own in units of length: volumes in micrometres or in
# millimetres, as most formats of microscopy and medicine state them, stay as large as they were, without a message. In
# nanometres they shrink; voxels of 1 and of 40 already differ by more than a factor of two with the default error of
# "at most one voxel". simplify_fqmr, of the same package, reaches the number down to .001 (not at 1000). Mesh in
# nanometres, and divide the vertices afterwards.
#
# Seen: a ball of 12 voxels in radius, 5,288 triangles, a tenth of them (528) asked for: 528 left for voxels of 40,
# 1,230 for 1 (528 with max_error = 1e9), 4,868 for .1, and all for .05 and .004, also with 1e9.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check zmesh==1.15.0 numpy==2.4.6
cd "$folder"
venv/bin/python - <<'END'
import numpy as np
import zmesh

ball = (np.square(np.mgrid[-20:21, -20:21, -20:21]).sum(axis=0) <= 144).astype(np.uint32)


def triangles(voxel, **options):
    mesher = zmesh.Mesher((voxel,) * 3)
    mesher.mesh(ball)
    return len(mesher.get(1, **options).faces)


whole = triangles(1)
default, large = {}, {}
for voxel in (40, 1, 0.1, 0.05, 0.004):
    default[voxel] = triangles(voxel, reduction_factor=10, max_error=None)
    large[voxel] = triangles(voxel, reduction_factor=10, max_error=1e9)
    print(f"voxels of {voxel}: {whole} triangles, {default[voxel]} left, {large[voxel]} with max_error=1e9")
mesher = zmesh.Mesher((0.004,) * 3)
mesher.mesh(ball)
assert len(zmesh.simplify_fqmr(mesher.get(1, reduction_factor=0), whole // 10).faces) < whole / 9
assert large[40] == large[1] and large[1] < whole / 9
assert default[1] > 2 * default[40], "this has changed"
assert default[0.05] == default[0.004] == large[0.05] == large[0.004] == whole, "this has changed"
END
