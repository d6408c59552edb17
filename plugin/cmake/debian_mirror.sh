#!/bin/sh
# Prints the address of a Debian mirror: $DEBIAN_MIRROR, or the one that this machine uses, the first
# among its apt sources, of either format.
set -eu

[ -z "${DEBIAN_MIRROR:-}" ] || { echo "$DEBIAN_MIRROR"; exit 0; }
mirror=$(cat /etc/apt/sources.list /etc/apt/sources.list.d/*.list \
             /etc/apt/sources.list.d/*.sources 2>/dev/null |
    sed -nE -e 's/^deb[[:space:]]+(\[[^]]*\][[:space:]]+)?([^[:space:]]*debian\/?)[[:space:]].*/\2/p' \
            -e 's/^URIs:[[:space:]]*([^[:space:]]*debian\/?)([[:space:]].*)?$/\1/p' | sed -n 1p)
[ -n "$mirror" ] || {
    echo "$0: no Debian mirror among the apt sources; give one: DEBIAN_MIRROR=ADDRESS make ..." >&2
    exit 1; }
echo "$mirror"
