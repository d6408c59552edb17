#!/bin/sh
# Installs those Debian packages of a list that are missing; does nothing when none is.
#
# usage: install_debian_packages.sh LIST
#
# LIST holds one package name a line, with comments from '#'. Asks for root through sudo, and only
# when something is missing, so that a machine set up by its administrator needs no sudo.
set -eu

[ $# -eq 1 ] || { echo "usage: $0 LIST" >&2; exit 2; }
packages=$(sed -e 's/#.*//' "$1" | xargs)

if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
    # Not an error: the same things may have come from another package manager.
    echo "Note: no apt-get here, so nothing was installed. Under the names of Debian 12 this needs:"
    echo "  $packages"
    exit 0
fi

# Such as npm, which other builds of Node hold and conflict with.
# shellcheck disable=SC2016  # dpkg-query's variables, not the shell's
provided=" $(dpkg-query --show --showformat='${db:Status-Abbrev},${Provides}\n' | sed -n 's/^ii *,//p' | tr ',\n' '  ') "

missing=''
for package in $packages; do
    # A removed package may still be known to dpkg: only its status tells.
    # shellcheck disable=SC2016  # ${Status} is dpkg-query's, not the shell's
    status=$(dpkg-query --show --showformat='${Status}' "$package" 2>/dev/null || true)
    case $status in
        'install ok installed' | 'hold ok installed') ;;
        *)
            case $provided in
                *" $package "*) ;;
                *) missing="$missing $package" ;;
            esac
            ;;
    esac
done
[ -n "$missing" ] || exit 0

as_root=''
if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || {
        echo "$0: not root and no sudo here; have these packages installed:$missing" >&2
        exit 1
    }
    as_root='sudo'
fi
echo "Installing Debian packages:$missing"
# `env` inside sudo, because sudo drops the variable otherwise. Errors come on standard error.
# shellcheck disable=SC2086  # the lists are meant to be split
{
    $as_root env DEBIAN_FRONTEND=noninteractive apt-get -qq update
    $as_root env DEBIAN_FRONTEND=noninteractive \
        apt-get -qq install --yes --no-install-recommends $missing
} >/dev/null
