#!/usr/bin/env bash
# What deploy/completions/tessera.bash offers for some beginnings. Usage: completion_test.sh BIN_FOLDER
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
PATH=$(realpath "$1"):$PATH
# shellcheck source=deploy/completions/tessera.bash
. "$root/deploy/completions/tessera.bash"
failures=0

# offers EXPECTED WORD...: the last word is the one to complete.
offers() {
    local expected=$1
    shift
    COMP_WORDS=("$@")
    COMP_CWORD=$(($# - 1))
    COMPREPLY=()
    _tessera
    if [ "${COMPREPLY[*]}" != "$expected" ]; then
        echo "'$*' offers '${COMPREPLY[*]}' instead of '$expected'"
        failures=$((failures + 1))
    fi
}

offers "render" tessera re
offers "filter filters" tessera "fi"
offers "--view-transform" tessera render --view
offers "neutral" tessera render --view-transform ne
offers "tiled cooperative mixed" tessera render room.glb --policy ""
offers "--pattern" tessera display adjust --pat
offers "on off" tessera display adjust --pattern ""
offers "--session" tessera-master --sess
offers "" tessera render room
exit "$failures"
