#!/usr/bin/env bash
# Prints how much disk the wheel that `make wheel` has built takes in an empty environment, with each
# of its extras: the table in python/README.md.
#
# usage: wheel_sizes.sh [PYTHON]
set -euo pipefail

python=${1:-python3}
project=$(cd "$(dirname "$0")/.." && pwd)
wheel=$(echo "$project"/build/wheel/meshlab_spectral-*-manylinux_*.whl)
[ -f "$wheel" ] || { echo "$0: no wheel: run \`make wheel\`" >&2; exit 2; }
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT

# Megabytes of a new environment with a package, or nothing in it.
size() {
    rm -rf "$root/venv"
    "$python" -m venv "$root/venv"
    [ $# -eq 0 ] || "$root/venv/bin/pip" install --quiet --disable-pip-version-check "$1"
    "$root/venv/bin/python" -m compileall -q "$root/venv" >"$root/log" 2>&1 || true
    du -sB1000000 "$root/venv" | cut -f1
}

echo "| installed | MB |"
echo "| --- | --- |"
echo "| nothing but pip | $(size) |"
echo "| the wheel, $(du -B1000000 "$wheel" | cut -f1) MB to download | $(size "$wheel") |"
for extra in draco maps matrices cluster plots render formats meshlab; do
    echo "| with \`$extra\` | $(size "$wheel[$extra]") |"
done
echo "| with all of them | $(size "$wheel[cluster,draco,formats,maps,matrices,meshlab,pictures]") |"
