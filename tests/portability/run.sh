#!/bin/sh
# Builds the core and its tests for another compiler, standard library, processor or system, on
# Debian 12, and runs the tests.
#
# usage: run.sh TARGET [OPTIONS OF CTEST]
#
#   baseline      GCC, without kernels for AVX2
#   eigen5        GCC, with Eigen and Spectra of Debian testing, which has 5.0 and 1.2
#   clang         Clang with libc++
#   mingw         for Windows, by GCC; the tests run under Wine
#   aarch64       for ARM, by GCC; the tests run under QEMU, which takes long: -R chooses some
#   macos_arm64   for macOS, by Zig: compiled and linked, but nothing here can run the tests
#   macos_x86_64  the same for Intel
#
# Everything goes to build/portability. GoogleTest and muParser are compiled for the target, too,
# from the sources in Debian. What is missing on this machine is installed.
set -eu

here=$(cd "$(dirname "$0")" && pwd)
if [ $# -eq 0 ] || [ ! -f "$here/packages/$1.txt" ]; then
    sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//p}' "$0" >&2
    exit 2
fi
target=$1
shift
project=$(cd "$here/../.." && pwd)
folder=$project/build/portability/$target
toolchain=$here/$target.cmake
mkdir -p "$folder"

"$project/plugin/cmake/install_debian_packages.sh" "$project/plugin/cmake/debian_packages.txt"
"$project/plugin/cmake/install_debian_packages.sh" "$here/packages/$target.txt"

build() {  # source folder, build folder, options of CMake
    source=$1 binary=$2
    shift 2
    cmake -S "$source" -B "$binary" -G Ninja -DCMAKE_BUILD_TYPE=Release "$@"
    cmake --build "$binary"
}

build_project() {  # options of CMake
    # With this Python real meshes are tested, too.
    python=$project/.venv/bin/python
    [ -x "$python" ] || python=$(command -v python3)
    build "$project" "$folder/project" -DSPECTRAL_BUILD_PLUGIN=OFF \
        -DSPECTRAL_WARNINGS_AS_ERRORS=ON -DPython3_EXECUTABLE="$python" "$@"
}

# Compiles the libraries for the target, and writes where they are to $installed.
build_libraries() {
    installed=$folder/installed
    "$project/plugin/cmake/static_muparser.sh" "$installed" --toolchain "$toolchain"
    build /usr/src/googletest "$folder/googletest" --toolchain "$toolchain" \
        -DCMAKE_INSTALL_PREFIX="$installed" -DBUILD_GMOCK=OFF
    cmake --install "$folder/googletest"
    # Spectra alone: next to it in /usr/include are the headers of this machine's C library.
    ln -sfn /usr/include/Spectra "$installed/include/Spectra"
}

# Unpacks packages of Debian testing to $folder/testing; the machine's apt set-up stays as it is.
unpack_from_testing() {  # packages
    packages=$*
    rm -rf "$folder/apt" "$folder/testing"
    mkdir -p "$folder/apt/lists/partial"
    keys=/usr/share/keyrings/debian-archive-keyring.gpg
    mirror=$("$project/plugin/cmake/debian_mirror.sh")
    echo "deb [signed-by=$keys] $mirror testing main" >"$folder/apt/sources.list"
    set -- -o "Dir::Etc::SourceList=$folder/apt/sources.list" -o Dir::Etc::SourceParts=/dev/null \
        -o "Dir::State::Lists=$folder/apt/lists" -o APT::Sandbox::User=root \
        -o Dir::Cache::pkgcache= -o Dir::Cache::srcpkgcache= -qq
    apt-get "$@" update
    # shellcheck disable=SC2086  # the list is meant to be split
    (cd "$folder/apt" && apt-get "$@" download $packages)
    for file in "$folder"/apt/*.deb; do
        dpkg-deb --extract "$file" "$folder/testing"
    done
}

case $target in
    baseline) build_project -DSPECTRAL_AVX2=OFF ;;
    eigen5)
        unpack_from_testing libeigen3-dev libspectra-dev
        # GCC 12 takes packets in Eigen's inner products for uninitialized: no errors by warnings.
        build_project -DSPECTRAL_WARNINGS_AS_ERRORS=OFF \
            -DEigen3_DIR="$folder/testing/usr/share/eigen3/cmake" \
            -DSpectra_INCLUDE_DIR="$folder/testing/usr/include" ;;
    *)
        case $target in
            macos_*)
                [ -d "$folder/venv" ] || python3 -m venv "$folder/venv"
                "$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
                    --require-hashes --only-binary :all: --requirement "$here/zig.txt"
                PATH=$PATH:$(dirname "$("$folder/venv/bin/python" \
                    -c 'import ziglang; print(ziglang.__file__)')") ;;
        esac
        build_libraries
        build_project --toolchain "$toolchain" -DCMAKE_PREFIX_PATH="$installed" \
            -DSpectra_INCLUDE_DIR="$installed/include" -DEigen3_DIR=/usr/share/eigen3/cmake ;;
esac

case $target in
    macos_*) exit ;;
    mingw)
        export WINEPREFIX="$folder/wine" WINEDEBUG=-all
        # A server that keeps running between the tests; it must not keep this script's output open.
        /usr/lib/wine/wine64 wineboot --init >"$folder/wine.log" 2>&1 </dev/null
        /usr/lib/wine/wineserver64 --persistent >>"$folder/wine.log" 2>&1 </dev/null || true
        trap '/usr/lib/wine/wineserver64 --kill || true' EXIT ;;
esac
ctest --test-dir "$folder/project" --output-on-failure --no-tests=error --parallel "$(nproc)" "$@"
