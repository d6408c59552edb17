#!/usr/bin/env bash
# Tries `make demo` and `make test` where nothing was installed before: in a bare Debian with only
# ca-certificates, git and make, on a clone of this repository's HEAD.
#
# usage: clean_room.sh [--suite SUITE] [--demo] [--user] [--ci] [--shared FOLDER] [ROOT]
#
#   --suite SUITE    another Debian than bookworm, 12: trixie, 13
#   --demo           `make demo` alone
#   --user           as a user with sudo, not as root
#   --ci             then .ci/run too, in a second clone
#   --shared FOLDER  mounted as ../shared of the clone, read-only (meshes of the benchmarks)
#   ROOT             new folder for the Debian system, to be kept; without it a temporary one,
#                    deleted afterwards (4 GB either way)
#
# Needs root. Network settings (mirror, apt and pip settings, certificates, name servers) are taken
# from this machine.
set -euo pipefail

usage() { sed -n '2,/^set /{s/^# \{0,1\}//p}' "$0" >&2; exit 2; }

user=root ci=false shared='' root='' suite=bookworm target=test
while [ $# -gt 0 ]; do
    case $1 in
        --user) user=tester ;;
        --demo) target=demo ;;
        --suite) [ $# -gt 1 ] || usage; suite=$2; shift ;;
        --ci) ci=true ;;
        --shared) [ $# -gt 1 ] || usage; shared=$(realpath "$2"); shift ;;
        -*) usage ;;
        *) [ -z "$root" ] || usage; root=$(realpath -m "$1") ;;
    esac
    shift
done
[ "$(id -u)" -eq 0 ] || { echo "$0: needs root, for debootstrap and chroot" >&2; exit 2; }
repository=$(git -C "$(dirname "$0")" rev-parse --show-toplevel)

if [ -z "$root" ]; then
    root=$(mktemp -d)
    chmod 755 "$root"
    trap 'rm -rf --one-file-system "$root"' EXIT
    trap 'exit 130' INT TERM
elif [ -n "$(ls -A "$root" 2>/dev/null)" ]; then
    echo "$0: $root is not empty, so it would be no clean room" >&2
    exit 2
fi

include=ca-certificates,git,make
[ "$user" = root ] || include=$include,sudo
echo "=== a bare Debian, $suite, in $root"
"$repository/tests/debian_root.sh" "$suite" "$root" "$include"
for file in /etc/pip.conf ~/.pip/pip.conf ~/.config/pip/pip.conf; do
    [ ! -f "$file" ] || cp "$file" "$root/etc/pip.conf"
done

home=/root
if [ "$user" != root ]; then
    home=/home/$user
    chroot "$root" useradd --create-home --shell /bin/bash "$user"
    echo "$user ALL=(ALL) NOPASSWD: ALL" >"$root/etc/sudoers.d/$user"
fi
git clone --quiet "$repository" "$root$home/project"
git clone --quiet "$repository" "$root$home/ci"
chroot "$root" chown -R "$user:" "$home"
[ -z "$shared" ] || mkdir "$root$home/shared"

# The environment of the trial: nothing of this shell's but what pip needs to reach its index.
settings=(HOME="$home" USER="$user" PATH=/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin LC_ALL=C.UTF-8)
for name in $(compgen -e | grep -E '^(PIP_(CERT|INDEX_URL|EXTRA_INDEX_URL|TRUSTED_HOST|PROXY|DEFAULT_TIMEOUT)|(https?|no|HTTPS?|NO)_(proxy|PROXY)|SSL_CERT_FILE)$'); do
    settings+=("$name=${!name}")
done

# In namespaces of its own, so that mounts and remaining processes vanish however it ends.
inside() {
    # A mount point as its root: without one, .ci/run could not have such namespaces in there.
    mount --bind "$root" "$root"
    mount -t proc proc "$root/proc"
    mkdir -p "$root/dev/pts" "$root/dev/shm"
    mount -t devpts -o newinstance devpts "$root/dev/pts"
    mount -t tmpfs tmpfs "$root/dev/shm"
    [ -z "$shared" ] || mount --bind -o ro "$shared" "$root$home/shared"
    run() {
        echo "=== $1: $2"
        time env -i "${settings[@]}" chroot --userspec="$user:" "$root" \
            bash -c "cd $home/$1 && $2" </dev/null
    }
    run project 'make demo'
    run project 'ls -l build/demo'
    [ "$target" = demo ] || run project 'make test'
    run project 'make demo  # again: no set-up work'
    if "$ci"; then run ci 'bash .ci/run'; fi
    echo '=== clean room: all passed'
}
export root home user shared ci target
# Arrays and functions do not pass through the environment: they go as text.
unshare --mount --pid --fork --kill-child \
    bash -c "set -euo pipefail; $(declare -p settings); $(declare -f inside); inside"
