#!/bin/sh
# Builds muParser as a static library, from the sources in Debian, once: for libraries that run where no
# libmuparser.so is installed, or beside another one.
#
# usage: static_muparser.sh FOLDER [OPTIONS OF CMAKE]    installs it into FOLDER
set -eu

[ $# -ge 1 ] || { sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//p}' "$0" >&2; exit 2; }
folder=$1
shift
[ ! -f "$folder/lib/libmuparser.a" ] || exit 0
here=$(cd "$(dirname "$0")" && pwd)
source=$here/../../build/muparser-source
"$here/fetch_debian_source.sh" "$source" bookworm muparser=2.3.3-0.1 muparser_2.3.3.orig.tar.gz \
    91d26d8274ae9cd9c776ee58250aeddc6b574f369eafd03b25045b858a2b8177
cmake -S "$source" -B "$folder.build" -G Ninja -DCMAKE_BUILD_TYPE=Release \
    -DCMAKE_INSTALL_PREFIX="$folder" -DCMAKE_INSTALL_LIBDIR=lib -DBUILD_SHARED_LIBS=OFF \
    -DCMAKE_POSITION_INDEPENDENT_CODE=ON -DBUILD_TESTING=OFF -DENABLE_SAMPLES=OFF \
    -DENABLE_OPENMP=OFF "$@"
cmake --build "$folder.build"
cmake --install "$folder.build"
