#!/usr/bin/env bash
# Makes the Debian system in which the GUI tests run the real MeshLab 2025.07; once, then it does
# nothing and needs no network.
#
# usage: make_root.sh FOLDER
#
# FOLDER (1 GB) is made anew when it is of another recipe than this one. Needs root and debootstrap.
set -euo pipefail

[ $# -eq 1 ] || { echo "usage: $0 FOLDER" >&2; exit 2; }
root=$1
here=$(cd "$(dirname "$0")" && pwd)
[ "$(id -u)" -eq 0 ] || { echo "$0: needs root, for debootstrap and chroot" >&2; exit 2; }

recipe=$(cd "$here" && sha256sum make_root.sh root_packages.txt ../debian_root.sh)
if [ "$(cat "$root/.recipe" 2>/dev/null)" = "$recipe" ]; then exit 0; fi

mkdir -p "$(dirname "$root")"
. "$here/../children.sh"
new=$(mktemp -d "$root.XXXXXX")
trap 'end_child; rm -rf --one-file-system "$new"' EXIT
chmod 755 "$new"

echo "=== MeshLab 2025.07 in a Debian system of its own, $root: two minutes, once"
packages=$(sed -e 's/#.*//' "$here/root_packages.txt" | xargs)
export here new packages
in_namespaces bash -euo pipefail -c '
    # The suite that has MeshLab 2025.07.
    "$here/../debian_root.sh" forky "$new" ca-certificates
    mount -t proc proc "$new/proc"
    mount -t tmpfs tmpfs "$new/dev/shm"
    inside() { env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 \
        DEBIAN_FRONTEND=noninteractive chroot "$new" "$@"; }
    inside apt-get -qq update
    # A star in a version is for apt to read, not for the shell.
    set -f
    log=$(inside apt-get -qq install --yes --no-install-recommends $packages 2>&1) || {
        tail -n 20 <<<"$log" >&2
        exit 1
    }
    inside apt-get -qq clean
    rm -rf "$new"/var/lib/apt/lists/*' </dev/null
echo "$recipe" >"$new/.recipe"
rm -rf --one-file-system "$root"
mv "$new" "$root"
