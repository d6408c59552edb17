#!/bin/sh
# plyfile 1.1.5: in a big-endian file, numbers that stand beside a list in a row are written little-endian.
#
# An element of numbers alone is written in the order of the header, and so are a list and its length; a number in
# a row that has a list, too, such as the quality of a face, keeps the order of the array that it came from, which
# is the machine's. plyfile itself and every other reader then read another number. Give the array a big-endian
# dtype, or write little-endian files.
#
# Seen: a face's quality of 1.5, in a file with byte_order=">", is read as 6.9e-41; with "<" as 1.5.
# Needs: python3 with venv, a package index; a little-endian machine.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check plyfile==1.1.5 numpy==2.4.6
cd "$folder"
venv/bin/python - <<'END'
import io
import struct

import numpy as np
from plyfile import PlyData, PlyElement

corners = np.array([0, 1, 2], dtype="i4")
faces = np.empty(1, dtype=[("vertex_indices", object), ("quality", "f4")])
faces["vertex_indices"][0] = corners
faces["quality"] = 1.5
element = PlyElement.describe(
    faces, "face", len_types={"vertex_indices": "u1"}, val_types={"vertex_indices": "i4"}
)
same = {}
for order in "<>":
    stream = io.BytesIO()
    PlyData([element], byte_order=order).write(stream)
    row = stream.getvalue().split(b"end_header\n", 1)[1]
    same[order] = row == struct.pack(f"{order}B3if", 3, *corners, 1.5)
    stream.seek(0)
    read = PlyData.read(stream)["face"]
    print(order, "quality 1.5 is read as", read["quality"][0], "corners as", read["vertex_indices"][0])
    assert list(read["vertex_indices"][0]) == [0, 1, 2], "this has changed"
assert same == {"<": True, ">": False}, "this has changed"
END
