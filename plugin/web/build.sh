#!/bin/sh
# Compiles the module spectral of JavaScript, with Emscripten.
#
# usage: build.sh FOLDER [OPTIONS OF CMAKE]    into FOLDER/module
#
# Eigen and Spectra are those of Debian, muParser is compiled from its sources.
set -eu

[ $# -ge 1 ] || { sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//p}' "$0" >&2; exit 2; }
command -v emcc >/dev/null || {
    echo "$0: no emcc here; \`make web INSTALL=ON\` installs Emscripten, from Debian" >&2
    exit 1
}
mkdir -p "$1"
folder=$(cd "$1" && pwd)
shift
project=$(cd "$(dirname "$0")/../.." && pwd)
root=$(cd "$(dirname "$(readlink -f "$(command -v emcc)")")" && pwd)
toolchain=$root/cmake/Modules/Platform/Emscripten.cmake
# Where Debian has its packages for JavaScript, for a Node that is not Debian's.
export NODE_PATH="/usr/share/nodejs${NODE_PATH:+:$NODE_PATH}"

exceptions='-fwasm-exceptions -msimd128'
"$project/plugin/cmake/static_muparser.sh" "$folder/installed" --toolchain "$toolchain" \
    -DCMAKE_CXX_FLAGS="$exceptions"
# Spectra alone: next to it in /usr/include are the headers of this machine's C library.
ln -sfn /usr/include/Spectra "$folder/installed/include/Spectra"
cmake -S "$project" -B "$folder/project" -G Ninja --toolchain "$toolchain" \
    -DCMAKE_BUILD_TYPE=Release -DSPECTRAL_BUILD_WEB=ON -DSPECTRAL_BUILD_PLUGIN=OFF \
    -DSPECTRAL_BUILD_TESTS=OFF -DSPECTRAL_WARNINGS_AS_ERRORS=ON \
    -Dmuparser_DIR="$folder/installed/lib/cmake/muparser" \
    -DSpectra_INCLUDE_DIR="$folder/installed/include" -DEigen3_DIR=/usr/share/eigen3/cmake "$@"
cmake --build "$folder/project" --target spectral
mkdir -p "$folder/module"
cp "$folder"/project/plugin/web/spectral.* "$folder/module"
