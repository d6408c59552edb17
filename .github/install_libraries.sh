#!/usr/bin/env bash
# Installs what the core and the plugin are built with on GitHub's Windows and macOS: libraries from
# source, Qt 5 and GLEW from packages, MeshLab's sources. Prints the environment that CMake and pip
# then need, in lines of NAME=VALUE.
#
# usage: install_libraries.sh FOLDER >>"$GITHUB_ENV"
set -euo pipefail
cmake_folder=$(dirname "$0")/../plugin/cmake
exec 3>&1 1>&2

mkdir -p "$1"
folder=$(cd "$1" && { pwd -W 2>/dev/null || pwd; })  # Windows: C:/..., as every program understands it

install() {  # repository, tag, options of CMake
    local name repository=$1 tag=$2
    name=$(basename "$1")
    shift 2
    git clone --quiet --depth 1 --branch "$tag" "$repository" "$folder/$name"
    cmake -S "$folder/$name" -B "$folder/$name.build" -DCMAKE_BUILD_TYPE=Release \
        -DCMAKE_INSTALL_PREFIX="$folder" -DCMAKE_PREFIX_PATH="$folder" \
        -DBUILD_TESTING=OFF -DBUILD_SHARED_LIBS=OFF -DCMAKE_POSITION_INDEPENDENT_CODE=ON \
        -DCMAKE_POLICY_VERSION_MINIMUM=3.5 "$@"
    cmake --build "$folder/$name.build" --config Release --target install --parallel 4
}
install https://gitlab.com/libeigen/eigen 3.4.0
install https://github.com/yixuan/spectra v1.0.1
install https://github.com/beltoforion/muparser v2.3.4 -DENABLE_SAMPLES=OFF -DENABLE_OPENMP=OFF
install https://github.com/google/googletest v1.14.0 -DBUILD_GMOCK=OFF -Dgtest_force_shared_crt=ON

# Qt no newer than that of pymeshlab's wheels. MeshLab wants GLEW's headers alone.
case $(uname -s)-$(uname -m) in
    Darwin-arm64)
        brew install --quiet qt@5 glew
        prefixes=$folder:$(brew --prefix qt@5):$(brew --prefix) ;;
    Darwin-*)
        brew install --quiet glew
        pip install aqtinstall==3.2.1
        aqt install-qt mac desktop 5.15.2 clang_64 --outputdir "$folder/qt"
        prefixes=$folder:$folder/qt/5.15.2/clang_64:$(brew --prefix) ;;
    *)
        vcpkg install glew:x64-windows
        pip install aqtinstall==3.2.1
        aqt install-qt windows desktop 5.15.2 win64_msvc2019_64 --outputdir "$folder/qt"
        glew=$(cygpath -m "$VCPKG_INSTALLATION_ROOT")/installed/x64-windows
        prefixes="$folder;$folder/qt/5.15.2/msvc2019_64;$glew" ;;
esac
git clone --quiet --depth 1 --recursive --shallow-submodules --branch MeshLab-2025.07 \
    https://github.com/cnr-isti-vclab/meshlab "$folder/meshlab"
options=-DMESHLAB_SOURCE_DIR=$folder/meshlab
if [ "${OS:-}" = Windows_NT ]; then
    CMAKE_PREFIX_PATH=$prefixes "$cmake_folder/build_float_library.sh" "$folder/meshlab" "$folder/float"
    options="$options -DMESHLAB_FLOAT_LIBRARY_DIR=$folder/float"
fi

echo "CMAKE_PREFIX_PATH=$prefixes" >&3
echo "CMAKE_ARGS=$options" >&3
