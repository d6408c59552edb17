#!/bin/sh
# pymeshlab 2025.7.post1: saving a mesh as 3MF sets the locale of the whole process to "C".
#
# Every text file that Python then opens without an encoding is read as ASCII: a script that saves a 3MF
# file and reads a UTF-8 one afterwards fails with UnicodeDecodeError. Saving PLY, OBJ, OFF or STL leaves
# the locale alone.
#
# Seen: UTF-8 before, ANSI_X3.4-1968 after 3mf.    Needs: python3 with venv, a package index, a UTF-8 locale.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check pymeshlab==2025.7.post1 numpy==2.4.6
cd "$folder"
LC_ALL=C.UTF-8 PYTHONUTF8=0 venv/bin/python - <<'END'
import locale

import pymeshlab

meshes = pymeshlab.MeshSet()
meshes.create_sphere(subdiv=2)
seen = {"before": locale.getpreferredencoding(False)}
for ending in ("ply", "obj", "off", "stl", "3mf"):
    meshes.save_current_mesh(f"sphere.{ending}")
    seen[ending] = locale.getpreferredencoding(False)
print(seen)
expected = dict.fromkeys(["before", "ply", "obj", "off", "stl"], "UTF-8") | {"3mf": "ANSI_X3.4-1968"}
assert seen == expected, "this has changed"
END
