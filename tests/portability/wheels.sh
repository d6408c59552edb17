#!/bin/sh
# Checks that pymeshlab's wheels for Windows and macOS are enough to link the plugin to: that CMake
# finds MeshLab's core library in them, and that it has every symbol that the plugin needs of it.
#
# usage: wheels.sh    after `make build`; downloads 170 MB, once, into build/portability
set -eu

project=$(cd "$(dirname "$0")/../.." && pwd)
plugin=$project/build/plugin/meshlab/libfilter_spectral.so
python=$project/.venv/bin/python
folder=$project/build/portability/wheels
"$project/plugin/cmake/install_debian_packages.sh" "$project/tests/portability/packages/wheels.txt"
mkdir -p "$folder"

requirement=$folder/requirement.txt
sed -n '/^pymeshlab==/,/[^\\]$/p' "$project/python/requirements.txt" >"$requirement"
for wheel in macos_arm64:macosx_11_0_arm64 macos_x86_64:macosx_11_0_x86_64 windows:win_amd64; do
    name=${wheel%%:*} platform=${wheel#*:}
    [ ! -d "$folder/$name" ] || continue
    "$python" -m pip download --quiet --disable-pip-version-check --require-hashes --no-deps \
        --only-binary :all: --platform "$platform" --python-version 3.11 \
        --requirement "$requirement" --dest "$folder"
    unzip -q "$folder"/pymeshlab-*"$platform".whl -d "$folder/unpacked"
    mv "$folder/unpacked"/*.data/purelib/pymeshlab "$folder/$name"
    rm -r "$folder/unpacked"
done
ln -sfn "$("$python" -c 'import importlib.util as u; print(u.find_spec("pymeshlab").origin[:-12])')" \
    "$folder/linux"

cmake "-DWHEELS=$folder" -P "$project/tests/portability/find_library.cmake"

# Names as in the source, without the namespaces by which standard libraries tell versions apart.
demangled() { c++filt | sed 's/std::__cxx11::/std::/g; s/std::__1::/std::/g' | LC_ALL=C sort -u; }
elf_symbols() { nm -D "$1" "$2" | awk '{ sub(/@.*/, "", $NF); print $NF }' | demangled; }
elf_symbols --defined-only "$folder/linux/lib/libmeshlab-common.so" >"$folder/linux.txt"
elf_symbols --undefined-only "$plugin" | LC_ALL=C comm -12 - "$folder/linux.txt" >"$folder/needed.txt"
[ -s "$folder/needed.txt" ] || { echo "$0: $plugin needs nothing of MeshLab?" >&2; exit 1; }

status=0
for system in macos_arm64 macos_x86_64; do
    llvm-nm --defined-only --extern-only "$folder/$system/Frameworks/libmeshlab-common.dylib" |
        awk '{ print substr($NF, 2) }' | demangled >"$folder/$system.txt"
    LC_ALL=C comm -23 "$folder/needed.txt" "$folder/$system.txt" >"$folder/missing.txt"
    sed "s/^/$system lacks /" "$folder/missing.txt"
    [ ! -s "$folder/missing.txt" ] || status=1
done
# Microsoft's names spell types differently: functions are compared by name alone. A class's
# typeinfo is not a symbol there, but comes with each object file.
llvm-nm "$folder/windows/meshlab-common.lib" 2>/dev/null | awk '{ print $NF }' | grep '^?' |
    llvm-undname >"$folder/windows.txt" 2>/dev/null || true  # it does not know some of Qt's templates
grep -v '^typeinfo for ' "$folder/needed.txt" | sed 's/(.*//' | sort -u >"$folder/functions.txt"
while read -r function; do
    grep -qF "$function(" "$folder/windows.txt" || { echo "windows lacks $function"; status=1; }
done <"$folder/functions.txt"
[ "$status" -ne 0 ] ||
    echo "$(wc -l <"$folder/needed.txt") symbols of MeshLab's core library, in every wheel"
exit "$status"
