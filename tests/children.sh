# shellcheck shell=bash
# For bash scripts to source: runs programs that end when a signal ends the script, with all that
# they have started and mounted. The script's trap on EXIT calls end_child.

child='' child_signal=''

# run_child SIGNAL PROGRAM ARGUMENTS: runs a program, and gives its exit status. SIGNAL is what
# ends it early.
run_child() {
    child_signal=$1
    shift
    # In the background: bash heeds a signal at once only while it waits for a child there.
    "$@" <&0 &
    child=$!
    local status=0
    wait "$child" || status=$?
    child=''
    return "$status"
}

# in_namespaces OPTIONS_OF_UNSHARE PROGRAM ARGUMENTS: runs a program in namespaces of its own, in
# which nothing outlives it: no process, no mount.
in_namespaces() {
    # While it waits, unshare heeds no other signal.
    run_child KILL unshare --mount --mount-proc --pid --fork --kill-child "$@"
}

# end_child: ends what run_child has started and still waits for.
end_child() {
    [ -n "$child" ] || return 0
    kill -"$child_signal" "$child" 2>/dev/null || true
    wait "$child" 2>/dev/null || true
}

trap 'exit 130' INT
trap 'exit 143' TERM
