#!/usr/bin/env bash
# Tries the wheel that `make wheel` has built where nothing was installed before, in an empty
# environment: in a bare Debian with Python, then with pymeshlab and its run-time libraries.
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
"$project/tests/debian_root.sh" "$suite" "$root" ca-certificates,python3-venv
for file in /etc/pip.conf ~/.pip/pip.conf ~/.config/pip/pip.conf; do
    [ ! -f "$file" ] || cp "$file" "$root/etc/pip.conf"
done
cp "$wheel" "$project"/tests/portability/try_*.py "$root/root"
mkdir "$root/root/samples"
PYTHONPATH=$project/tests/python "$project/.venv/bin/python" -c '
import sys, pathlib, format_samples
for number, one in enumerate(format_samples.SAMPLES):
    folder = pathlib.Path(sys.argv[1]) / str(number)
    folder.mkdir()
    one.write(folder / one.name)
    print(f"{number}/{one.name}")' "$root/root/samples" >"$root/root/samples/list.txt"
cat >"$root/root/try.sh" <<'END'
set -eu
cd /root
. /etc/os-release && echo "$PRETTY_NAME, $(python3 --version), $(ldd --version | sed -n 1p)"
python3 -m venv venv
install() { venv/bin/pip install --quiet --quiet --disable-pip-version-check "$(ls meshlab_spectral-*.whl)[$1]"; }
PATH=$PWD/venv/bin:$PATH
venv/bin/pip install --quiet --quiet --disable-pip-version-check meshlab_spectral-*.whl
du -sh venv | sed 's/venv/alone/'
install formats,usd
du -sh venv | sed 's/venv/with VTK, NIfTI and USD/'
python try_without_meshlab.py samples
apt-get update -qq && apt-get install -qq --no-install-recommends $1 >/dev/null
install formats,meshlab
du -sh venv | sed 's/venv/with pymeshlab/'
python try_wheel.py
meshlab-spectral install
meshlab-spectral install --uninstall
END
# In namespaces of its own, so that the mount and remaining processes vanish however it ends.
unshare --mount --pid --fork --kill-child bash -c \
    'mount --bind "$1" "$1" && mount -t proc proc "$1/proc" && exec chroot "$1" bash /root/try.sh "$2"' - "$root" "$(paste -sd' ' <<<"$libraries")"
echo "=== the wheel works in $suite"
