#!/usr/bin/env bash
# Helpers for long-running scripts: help_of SCRIPT, progress TEXT, progress_done TEXT, quietly COMMAND..., build PRESET TARGET....
# Updates one line on a terminal; otherwise prints a line every 20 seconds.

progress_shown=
progress_at=-1000

# Prints the comment at the top of a script.
help_of() { sed -n '2,/^[^#]/s/^# \{0,1\}//p' "$1"; }

progress() {
    if [ -t 1 ]; then
        printf '\r\033[K%s' "$1"
        progress_shown=yes
    elif ((SECONDS - progress_at >= 20)); then
        printf '%s\n' "$1"
        progress_at=$SECONDS
    fi
}

progress_done() {
    [ -z "$progress_shown" ] || printf '\r\033[K'
    progress_shown=
    printf '%s\n' "$1"
}

# Silent unless it fails.
quietly() {
    local log
    log=$(mktemp)
    if ! "$@" >"$log" 2>&1; then
        [ -z "$progress_shown" ] || printf '\n'
        cat "$log" >&2
        rm -f "$log"
        echo "setup: failed: $*" >&2
        exit 1
    fi
    rm -f "$log"
}

minutes_left() {
    local seconds=$1
    if ((seconds < 50)); then
        echo "less than a minute left"
    elif ((seconds < 90)); then
        echo "about 1 minute left"
    else
        echo "about $(((seconds + 30) / 60)) minutes left"
    fi
}

# Builds targets (none: all) of a preset and shows the progress.
build() {
    local preset=$1 log line begin=$SECONDS built=0 total=0 elapsed state
    shift
    log=$(mktemp)
    local command=(cmake --build --preset "$preset" --parallel "${TESSERA_BUILD_JOBS:-$(nproc)}")
    [ "$#" -eq 0 ] || command+=(--target "$@")
    # Ninja prints a line for each file, prefixed by NINJA_STATUS.
    while IFS= read -r line; do
        printf '%s\n' "$line" >>"$log"
        [[ $line =~ ^@([0-9]+)/([0-9]+)@ ]] || continue
        built=${BASH_REMATCH[1]} total=${BASH_REMATCH[2]} elapsed=$((SECONDS - begin))
        state="building  $built of $total files"
        if ((built >= 10 && elapsed >= 10)); then
            state+=", $(minutes_left $((elapsed * (total - built) / built)))"
        fi
        progress "$state"
    done < <(NINJA_STATUS='@%f/%t@ ' "${command[@]}" 2>&1 || echo "@failed@")
    if tail -n 1 "$log" | grep -qx '@failed@'; then
        [ -z "$progress_shown" ] || printf '\n'
        # The failed commands and their output, without warnings of others.
        sed -e '/^@failed@$/d' -e 's/^@\([0-9]*\/[0-9]*\)@ /[\1] /' "$log" | grep -n -A 200 '^FAILED:' | head -n 300 >&2 ||
            tail -n 50 "$log" >&2
        rm -f "$log"
        echo "setup: the build failed" >&2
        exit 1
    fi
    rm -f "$log"
    elapsed=$((SECONDS - begin))
    if ((total > 0)); then progress_done "built $total files in $((elapsed / 60)) min $((elapsed % 60)) s"; fi
}
