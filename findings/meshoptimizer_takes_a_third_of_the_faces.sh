#!/bin/sh
# meshoptimizer 0.2.30a0 (Python): of faces that are given as an array of n x 3, a third is taken.
#
# The number of indices is by default len(indices), which is n, so that encoding, simplification and every optimizer
# see the first n / 3 triangles, without a message; all are there in a flat array. Positions may have n x 3, and their
# number is then right. "numpy array of index data" is all that the documentation says. Pass faces.ravel().
#
# Seen: a grid of 180 triangles: encode_index_buffer keeps 60, and simplify, which may remove none, returns 60, too;
# 180 from the flat array, by both.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check meshoptimizer==0.2.30a0 numpy==2.4.6
cd "$folder"
venv/bin/python - <<'END'
import meshoptimizer
import numpy as np

x, y = (grid.ravel() for grid in np.meshgrid(np.arange(10), np.arange(11), indexing="ij"))
positions = np.c_[x, y, np.sin(x) * np.cos(y)].astype(np.float32)
index = np.arange(110).reshape(10, 11)
a, b, c, d = (part.ravel() for part in (index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]))
faces = np.r_[np.c_[a, b, c], np.c_[a, c, d]].astype(np.uint32)


def encoded(indices, count):
    data = meshoptimizer.encode_index_buffer(indices)
    return meshoptimizer.decode_index_buffer(count, 4, data).reshape(-1, 3)


def simplified(indices):
    result = np.zeros(faces.size, np.uint32)
    return meshoptimizer.simplify(result, indices, positions, target_index_count=faces.size, target_error=0.0) // 3


seen = {"encoded": (len(encoded(faces, 180)), len(encoded(faces.ravel(), 540))),
        "simplified": (simplified(faces), simplified(faces.ravel()))}
print(len(faces), "triangles; as n x 3, flat:", seen)
assert seen == {"encoded": (60, 180), "simplified": (60, 180)}, "this has changed"
END
