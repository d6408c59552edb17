#!/usr/bin/env bash
# Runs tests of the module _core, or the C++ tests, with AddressSanitizer and
# UndefinedBehaviorSanitizer, or with ThreadSanitizer, beside the built package (`make build` builds
# it): each kind takes five minutes of building and a few of tests.
#
# usage: sanitizers.sh [address|thread] [cpp|TESTS]
#
#   cpp     the C++ tests, by ctest
#   TESTS   of pytest instead of the usual ones, such as tests/python/tiles; the processes that they
#           start are checked, too
#
# Left out of AddressSanitizer's run: the tests of memory, which it needs itself, and those that only
# compare bits with pymeshlab or start commands, which it does not see.
set -euo pipefail
cd "$(dirname "$0")/.."

kind=${1:-address}
shift || true
case $kind in
    address)
        export ASAN_OPTIONS=detect_leaks=0:alloc_dealloc_mismatch=0
        export UBSAN_OPTIONS=print_stacktrace=1
        flags='-fsanitize=address,undefined -fno-sanitize=vptr -fno-sanitize-recover=undefined'
        tests=(tests/python/core tests/python/formats
            -k 'not mesh_set and not command and not same_bits and not memory')
        library=libasan.so ;;
    thread)
        export TSAN_OPTIONS=ignore_noninstrumented_modules=1:report_signal_unsafe=0:exitcode=66
        flags=-fsanitize=thread
        tests=(tests/python/core/test_faces_agree.py -k 'threads and module or number_of_threads')
        library=libtsan.so ;;
    *) sed -n '2,/^set /{s/^# \{0,1\}//p}' "$0" >&2; exit 2 ;;
esac
[ $# -eq 0 ] || tests=("$@")

build=build/sanitize-$kind
cmake -S . -B "$build" -G Ninja -DCMAKE_CXX_FLAGS_RELEASE="-O1 -g1 -DNDEBUG" \
    -DSPECTRAL_BUILD_PLUGIN=OFF -DSPECTRAL_BUILD_PYTHON=ON \
    -Dmuparser_DIR="$PWD/build/muparser/lib/cmake/muparser" \
    -DPython_EXECUTABLE="$PWD/.venv/bin/python" \
    -DCMAKE_CXX_FLAGS="$flags -fno-omit-frame-pointer" \
    -DCMAKE_EXE_LINKER_FLAGS="$flags" -DCMAKE_MODULE_LINKER_FLAGS="$flags"
if [ "${tests[*]}" = cpp ]; then
    cmake --build "$build"
    exec ctest --test-dir "$build" --output-on-failure --no-tests=error
fi
cmake --build "$build" --target _core

# The installed package with another module, before the one in .venv.
packages=$PWD/$build/packages
rm -rf "$packages" && mkdir "$packages"
cp -r "$(.venv/bin/python -c 'import meshlab_spectral as m; print(m.__path__[0])')" "$packages"
rm "$packages"/meshlab_spectral/_core*
find "$build/plugin" -name '_core*.so' -exec cp {} "$packages/meshlab_spectral" \;

export PYTHONPATH=$packages
LD_PRELOAD="$(c++ -print-file-name=$library):$(c++ -print-file-name=libstdc++.so.6)" \
    .venv/bin/python -m pytest -p no:cacheprovider -c python/pyproject.toml --rootdir . "${tests[@]}"
