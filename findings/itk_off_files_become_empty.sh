#!/bin/sh
# itk 5.4.7: an OFF file with a blank line below the word OFF, as meshio writes it, is read as an empty mesh; and an
# OFF file that ITK writes as binary cannot be read by anyone.
#
# The format allows comments and blank lines. meshio 5.3.5 writes one of each before the numbers of vertices and
# faces: ITK takes the blank line for the numbers and returns a mesh of nothing, without an error. MeshFileWriter,
# with SetFileTypeAsBINARY, writes neither the word BINARY nor the numbers, and fewer bytes than the points need.
# Remove blank lines and comments first; write OFF as text, or another format as binary.
#
# Seen: of 42 vertices and 80 faces 0 and 0 from meshio's file, 42 and 80 by trimesh and without the blank line; the
# binary file has 454 bytes, 1784 are needed, and ITK itself reads 0 and 0.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
  itk-io==5.4.7 meshio==5.3.5 trimesh==5.2.0 numpy==2.4.6
cd "$folder"
venv/bin/python - <<'END'
from pathlib import Path

import itk
import meshio
import trimesh


def counts(path):
    mesh = itk.meshread(path)
    return mesh.GetNumberOfPoints(), mesh.GetNumberOfCells()


sphere = trimesh.creation.icosphere(subdivisions=1)
meshio.write("meshio.off", meshio.Mesh(sphere.vertices, [("triangle", sphere.faces)]))
lines = Path("meshio.off").read_text().splitlines(keepends=True)
Path("filled.off").write_text("".join(line for line in lines if line.strip()))
peer = trimesh.load("meshio.off", process=False)
seen = counts("meshio.off"), counts("filled.off"), (len(peer.vertices), len(peer.faces))
print("meshio's file begins with", lines[:4], "- itk, without its blank line, trimesh:", *seen)
assert seen == ((0, 0), (42, 80), (42, 80)), "this has changed"

mesh = itk.meshread("filled.off")
writer = itk.MeshFileWriter[type(mesh)].New(Input=mesh, FileName="binary.off")
writer.SetFileTypeAsBINARY()
writer.Update()
data = Path("binary.off").read_bytes()
needed = 42 * 3 * 4 + 80 * 4 * 4
print("binary:", len(data), "bytes of", needed, data[:12], "- itk:", *counts("binary.off"))
assert len(data) < 42 * 3 * 4 and b"BINARY" not in data, "this has changed"
assert counts("binary.off") == (0, 0), "this has changed"
END
