#!/usr/bin/env bash
# Builds MeshLab's core library in single precision. Only Windows needs it, where a plugin for
# MeshLab's usual program is linked to an import library that no package has; built in the same way,
# it has the same names.
#
# usage: build_float_library.sh SOURCE FOLDER    SOURCE: a checkout of MeshLab 2025.07 with submodules
#
# Afterwards build the plugin with -DMESHLAB_FLOAT_LIBRARY_DIR=FOLDER.
set -euo pipefail

[ $# -eq 2 ] || { sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//p}' "$0" >&2; exit 2; }
cmake -S "$1" -B "$2.build" -DCMAKE_BUILD_TYPE=Release -DMESHLAB_BUILD_MINI=ON \
    -DMESHLAB_BUILD_WITH_DOUBLE_SCALAR=OFF -DMESHLAB_ALLOW_OPTIONAL_EXTERNAL_LIBRARIES=OFF
cmake --build "$2.build" --config Release --target meshlab-common --parallel 4
mkdir -p "$2"
# With Visual Studio, in a folder named Release.
find "$2.build" \( -name 'meshlab-common.lib' -o -name 'libmeshlab-common.*' \) -exec cp {} "$2" \;
ls "$2"
