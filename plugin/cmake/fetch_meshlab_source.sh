#!/bin/sh
# Fetches the sources of MeshLab 2025.07 (headers and vcglib) into a folder, once, from Debian's
# source package.
#
# usage: fetch_meshlab_source.sh FOLDER
set -eu

[ $# -eq 1 ] || { echo "usage: $0 FOLDER" >&2; exit 2; }
exec "$(dirname "$0")/fetch_debian_source.sh" "$1" forky 'meshlab=2025.07~dfsg-4' \
    'meshlab_2025.07~dfsg.orig.tar.xz' \
    'd22c98d362f2a284e481af8dbfc272b2222f5b9c67b3cf8bec57d1c3161886f4'
