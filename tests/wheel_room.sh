#!/usr/bin/env bash
# Tries the wheel that `make wheel` has built where nothing was installed before: in a bare Debian with
# Python and the run-time libraries of pymeshlab, in an empty environment.
#
# usage: wheel_room.sh [SUITE]    bookworm (default), trixie, testing ...
#
# Needs root.
set -euo pipefail

suite=${1:-bookworm}
project=$(cd "$(dirname "$0")/.." && pwd)
wheel=$(echo "$project"/build/wheel/meshlab_spectral-*-manylinux_*.whl)
[ -f "$wheel" ] || { echo "$0: no wheel: run \`make wheel\`" >&2; exit 2; }
root=$(mktemp -d)
chmod 755 "$root"
trap 'rm -rf --one-file-system "$root"' EXIT
trap 'exit 130' INT TERM

libraries=$(sed -n '/^# Run-time/,$s/^\([a-z0-9-]*\) .*/\1/p' "$project/plugin/cmake/debian_packages.txt")
"$project/tests/debian_root.sh" "$suite" "$root" "ca-certificates,python3-venv,$(paste -sd, <<<"$libraries")"
for file in /etc/pip.conf ~/.pip/pip.conf ~/.config/pip/pip.conf; do
    [ ! -f "$file" ] || cp "$file" "$root/etc/pip.conf"
done
cp "$wheel" "$project/tests/portability/try_wheel.py" "$root/root"
cat >"$root/root/try.sh" <<'END'
set -eu
cd /root
. /etc/os-release && echo "$PRETTY_NAME, $(python3 --version), $(ldd --version | sed -n 1p)"
python3 -m venv venv
venv/bin/pip install --quiet --quiet --disable-pip-version-check "$(ls meshlab_spectral-*.whl)[meshlab]"
PATH=$PWD/venv/bin:$PATH
python try_wheel.py
meshlab-spectral install
meshlab-spectral install --uninstall
END
# In namespaces of its own, so that the mount and remaining processes vanish however it ends.
unshare --mount --pid --fork --kill-child bash -c \
    'mount --bind "$1" "$1" && mount -t proc proc "$1/proc" && exec chroot "$1" bash /root/try.sh' - "$root"
echo "=== the wheel works in $suite"
