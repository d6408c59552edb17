#!/bin/sh
# Fetches the upstream sources of a Debian source package into a folder, once.
#
# usage: fetch_debian_source.sh FOLDER SUITE PACKAGE=VERSION ARCHIVE SHA256
#
# They come through apt, but without touching the machine's own apt set-up: the mirror is the one that
# the machine already uses (debian_mirror.sh), the lists go to a private folder.
set -eu

[ $# -eq 5 ] || { echo "usage: $0 FOLDER SUITE PACKAGE=VERSION ARCHIVE SHA256" >&2; exit 2; }
folder=$1 suite=$2 package=$3 archive=$4 sha256=$5
[ ! -f "$folder/.complete" ] || exit 0
command -v apt-get >/dev/null || {
    echo "$0: no apt-get here: this is no Debian system." >&2; exit 1; }

mkdir -p "$(dirname "$folder")"
# Absolute, as apt takes a relative path to be one below its own folders.
work=$(mktemp -d "$(cd "$(dirname "$folder")" && pwd)/debian-source.XXXXXX")
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM

mirror=$("$(dirname "$0")/debian_mirror.sh")
mkdir -p "$work/lists/partial" "$work/tree"
# Trusted by the hash below: Ubuntu has no keys of Debian's.
echo "deb-src [trusted=yes] $mirror $suite main" > "$work/sources.list"
(
    cd "$work"
    # No package caches: they would be the machine's, which a user who is not root cannot write.
    set -- -o "Dir::Etc::SourceList=$work/sources.list" -o Dir::Etc::SourceParts=/dev/null \
           -o "Dir::State::Lists=$work/lists" -o APT::Sandbox::User=root \
           -o Dir::Cache::pkgcache= -o Dir::Cache::srcpkgcache= -qq
    apt-get "$@" update
    # --tar-only: the .dsc and the packaging are missing on some mirrors, and not needed.
    apt-get "$@" source --download-only --tar-only "$package"
)
echo "$sha256  $work/$archive" | sha256sum --check --quiet
tar -xf "$work/$archive" -C "$work/tree" --strip-components=1
touch "$work/tree/.complete"
rm -rf "$folder"
mv "$work/tree" "$folder"
