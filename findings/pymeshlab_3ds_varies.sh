#!/bin/sh
# pymeshlab 2025.7.post1: the same mesh saved as .3ds gives files of different sizes from process to process.
#
# A tetrahedron without colours and materials comes with a varying list of faces with a material, or without one;
# the vertices and faces are right. Once, such a file could not be loaded again ("Malformed file"). Other formats
# give the same bytes each time.
#
# Seen, 30 processes: 389, 414 and 430 bytes; .ply, .off and .stl one size each.
# Needs: python3 with venv, a package index, libgl1 and libopengl0.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check pymeshlab==2025.7.post1 numpy==2.4.6
cat >"$folder/save.py" <<'END'
import sys

import numpy as np
import pymeshlab

V = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
F = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
mesh_set = pymeshlab.MeshSet(verbose=False)
mesh_set.add_mesh(pymeshlab.Mesh(V, F))
mesh_set.save_current_mesh(sys.argv[1])
END
for ending in 3ds ply off stl; do
    for _ in $(seq 30); do
        "$folder/venv/bin/python" "$folder/save.py" "$folder/mesh.$ending"
        wc -c <"$folder/mesh.$ending"
    done | sort -n | uniq -c >"$folder/$ending"
    echo "$ending, files and bytes:"
    cat "$folder/$ending"
done
[ "$(wc -l <"$folder/3ds")" -gt 1 ] || { echo "this has changed" >&2; exit 1; }
for ending in ply off stl; do
    [ "$(wc -l <"$folder/$ending")" -eq 1 ] || { echo "this has changed: $ending" >&2; exit 1; }
done
