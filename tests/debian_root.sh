#!/usr/bin/env bash
# Makes a bare Debian system in a folder, to chroot into, with what this machine's network needs:
# mirror, apt settings, certificates, name servers.
#
# usage: debian_root.sh SUITE FOLDER PACKAGES
#
#   SUITE     such as bookworm
#   FOLDER    new or empty
#   PACKAGES  to have beside the most necessary ones, with commas between them
#
# Needs root; debootstrap is installed when it is missing.
set -euo pipefail

[ $# -eq 3 ] || { echo "usage: $0 SUITE FOLDER PACKAGES" >&2; exit 2; }
suite=$1 root=$2 packages=$3
[ "$(id -u)" -eq 0 ] || { echo "$0: needs root, for debootstrap and chroot" >&2; exit 2; }
here=$(dirname "$0")
"$here/../plugin/cmake/install_debian_packages.sh" "$here/debian_packages.txt"
mirror=$("$here/../plugin/cmake/debian_mirror.sh")

# A suite younger than this machine's debootstrap is made as the unstable one is.
recipe=/usr/share/debootstrap/scripts/$suite
[ -e "$recipe" ] || recipe=/usr/share/debootstrap/scripts/sid
log=$(debootstrap --variant=minbase --include="$packages" "$suite" "$root" "$mirror" "$recipe" 2>&1) || {
    tail -n 20 <<<"$log" >&2
    exit 1
}

# Of apt's settings only those about fetching: the others may call programs that are not there.
cp -L /etc/resolv.conf /etc/hosts "$root/etc/"
for file in /etc/apt/apt.conf.d/*; do
    if grep -q '^Acquire::' "$file" && ! grep -q 'Invoke' "$file"; then
        cp "$file" "$root/etc/apt/apt.conf.d/"
    fi
done
cp -r /usr/local/share/ca-certificates/. "$root/usr/local/share/ca-certificates/"
chroot "$root" update-ca-certificates >/dev/null 2>&1
