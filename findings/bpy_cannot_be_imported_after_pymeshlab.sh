#!/bin/sh
# bpy 5.0.1 (Blender as a module) cannot be imported after pymeshlab 2025.7.post1; before it, it can.
#
# Both wheels bring an Embree of their own, of two versions and one name (libembree4.so.4). The first that is
# loaded serves both; pymeshlab's lacks a function that Blender needs, Blender's has all. The error names a symbol,
# and neither package. Import bpy first, or in a process of its own.
#
# Seen: ImportError, undefined symbol rtcGetSceneTraversable; no error in the other order.
# Needs: python3.11 (bpy 5.0 takes no other) with venv, a package index; Linux on x86-64, 1.5 GB of disk.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3.11 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check bpy==5.0.1 pymeshlab==2025.7.post1
cd "$folder"
venv/bin/python -c "import bpy, pymeshlab"
if venv/bin/python -c "import pymeshlab, bpy" 2> error; then
  echo "this has changed: no error" >&2
  exit 1
fi
tail -n 1 error
grep -q "ImportError: .*undefined symbol: rtcGetSceneTraversable" error
