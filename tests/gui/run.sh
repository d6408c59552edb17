#!/usr/bin/env bash
# Tests the plugin in the real MeshLab 2025.07: Debian's, in a Debian system of its own, on a
# virtual screen. That system is made at the first run, and kept; later runs need no network.
#
# usage: run.sh [ARGUMENTS OF PYTEST]
#        run.sh --make-root    that system alone
#
# MESHLAB_SPECTRAL_GUI_ROOT names the system's folder (1 GB), by default in /var/cache.
# Needs Linux and root, or sudo: for debootstrap, chroot and mount.
set -euo pipefail
cd "$(dirname "$0")/../.."

[ "$(uname -s)" = Linux ] || { echo "$0: only on Linux: it runs Debian's MeshLab" >&2; exit 2; }
root=${MESHLAB_SPECTRAL_GUI_ROOT:-/var/cache/meshlab-spectral/gui-root}
if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || {
        echo "$0: needs root or sudo, to make a Debian system and to run MeshLab in it" >&2
        exit 2
    }
    exec sudo env MESHLAB_SPECTRAL_GUI_ROOT="$root" "$0" "$@"
fi

plugin/cmake/install_debian_packages.sh tests/debian_packages.txt
command -v debootstrap >/dev/null || { echo "$0: needs debootstrap" >&2; exit 2; }

. tests/children.sh
mount_point=''
finish() {
    end_child
    [ -z "$mount_point" ] || rmdir "$mount_point"
    # Give the files to sudo's caller, who could not delete them otherwise.
    if [ -n "${SUDO_UID:-}" ]; then chown -R "$SUDO_UID:$SUDO_GID" build/gui screenshots; fi
}
trap finish EXIT
mkdir -p build/gui
run_child TERM tests/gui/make_root.sh "$root"
[ "${1:-}" != --make-root ] || exit 0

# A process more than processors: on two of them two wait a third of the time, for windows.
# The paths of sockets must be short, so the system is mounted at a short one. No network, and the
# system's folder cannot be written to. What the tests write is in memory.
mount_point=$(mktemp -d /tmp/gui.XXXXXX)
export MESHLAB_SPECTRAL_GUI_ROOT=$mount_point PYTHONDONTWRITEBYTECODE=1
in_namespaces --net --ipc bash -euo pipefail -c '
    at=$MESHLAB_SPECTRAL_GUI_ROOT
    mount --bind "$0" "$at"
    mount -o remount,bind,ro "$at"
    mount -t proc proc "$at/proc"
    mount -t tmpfs -o mode=1777 tmpfs "$at/dev/shm"
    mount -t tmpfs -o mode=1777 tmpfs "$at/tmp"
    .venv/bin/python -m pytest -c python/pyproject.toml --rootdir . -p no:cacheprovider \
        --numprocesses $(($(nproc) + 1)) --dist worksteal "${@:-tests/gui}"' "$root" "$@"
