#!/bin/sh
# nibabel 5.4.2 cannot read surfaces in FreeSurfer's format that cat-surf 1.1.6 (CAT-Surface, of CAT12) writes.
#
# The magic number is followed by a comment, which most writers end by an empty line, and CAT by one newline. nibabel
# reads two lines, the second of which then lasts until a byte of the numbers happens to be 10: it fails, on a count
# from the middle of the data. Insert a newline, or write GIFTI.
#
# Seen: ValueError, cannot reshape an array; with a second newline the 162 vertices and 320 faces.
# Needs: python3 with venv, a package index; Linux on x86-64.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
  cat-surf==1.1.6 nibabel==5.4.2 trimesh==5.2.0 numpy==2.4.6 scipy==1.17.1
cd "$folder"
venv/bin/python - <<'END'
from pathlib import Path

import cat_surf
import nibabel.freesurfer
import numpy as np
import trimesh

sphere = trimesh.creation.icosphere(subdivisions=2, radius=50)
vertices, faces = np.array(sphere.vertices), np.array(sphere.faces, dtype=np.int32)
cat_surf.write_surface("lh.white", vertices, faces)
data = Path("lh.white").read_bytes()
print(data[:32])
Path("lh.mended").write_bytes(data.replace(b"\n", b"\n\n", 1))
mended = nibabel.freesurfer.read_geometry("lh.mended")
assert np.allclose(mended[0], vertices) and (mended[1] == faces).all(), "this has changed"
try:
    nibabel.freesurfer.read_geometry("lh.white")
    error = None
except ValueError as raised:
    error = raised
print(error)
assert error is not None, "this has changed"
END
