#!/usr/bin/env bash
# shellcheck disable=SC2154 # folder and children are the caller's
# For scripts that start programs: start NAME COMMAND..., fail TEXT, stop_everything. Wants: folder, children=().

# Ends all started processes: with SIGTERM, and with SIGKILL after five seconds.
stop_everything() {
    trap '' INT TERM
    local i child waited
    # Nodes before the master, so that they can deregister.
    for ((i = ${#children[@]} - 1; i >= 0; --i)); do kill -TERM "${children[i]}" 2>/dev/null || true; done
    for child in "${children[@]}"; do
        for ((waited = 0; waited < 50; ++waited)); do
            kill -0 "$child" 2>/dev/null || break
            sleep 0.1
        done
        kill -KILL "$child" 2>/dev/null || true
        wait "$child" 2>/dev/null || true
    done
    rm -rf "$folder"
}

start() {
    local name=$1
    shift
    "$@" >>"$folder/$name.log" 2>&1 &
    children+=("$!")
}

fail() {
    echo "demo: $1" >&2
    tail -n 5 "$folder"/*.log >&2 || true
    exit "${2:-1}"
}
