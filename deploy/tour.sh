#!/usr/bin/env bash
# Usage: deploy/demo.sh --live [--once]
#
# The tour of deploy/demo.sh --live: a master with its session on disk, two nodes, concurrent edits from the command line and
# from Python, undo, loss of a node, and a killed and restarted master. Its pictures are written to out/tour/. Afterwards the
# cluster keeps running for other clients until Ctrl-C; with --once it exits.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

once=
for argument in "$@"; do
    case $argument in
    --once) once=yes ;;
    -h | --help)
        . deploy/progress.sh
        help_of deploy/tour.sh
        exit
        ;;
    *)
        echo "demo: --live accepts only --once, not '$argument'" >&2
        exit 64
        ;;
    esac
done
deploy/setup.sh release tessera tessera-master tessera-node tessera_python

bin=build/release/bin
folder=$(mktemp -d)
children=()
# shellcheck source=deploy/children.sh
. deploy/children.sh
trap stop_everything EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

tour=out/tour
rm -rf "$tour"
mkdir -p "$tour"
keys=$folder/keys
"$bin/tessera" keys "$keys" >"$folder/keys.log"

start_master() {
    start master "$bin/tessera-master" --listen "$endpoint" --keys "$keys" --session "$folder/session" --heartbeat 0.25 --checkpoint 1
    master=${children[-1]}
}
answers() {
    local question
    for ((question = 0; question < 40; ++question)); do
        "$bin/tessera" status --master "$endpoint" --keys "$keys" >"$folder/status.log" 2>&1 && return 0
        kill -0 "$master" 2>/dev/null || return 1
    done
    return 1
}
for ((attempt = 0; ; ++attempt)); do
    [ "$attempt" -lt 20 ] || fail "found no free port"
    endpoint=tcp://127.0.0.1:${TESSERA_DEMO_PORT:-$((20000 + RANDOM % 12000))}
    start_master
    answers && break
done
here=(--master "$endpoint" --keys "$keys")
start node-1 "$bin/tessera-node" "${here[@]}" --name node-1 --threads 1
start node-2 "$bin/tessera-node" "${here[@]}" --name node-2 --threads 1
node_2=${children[-1]}

# Saves one picture of the current scene.
shot() {
    "$bin/tessera" watch "${here[@]}" --name photographer --size 640x360 --spp "${TESSERA_DEMO_SPP:-32}" --filter fdf --once \
        -o "$tour/$1.png" >"$folder/$1.log" || fail "no picture $1"
    echo "tour: out/tour/$1.png  $2"
}

"$bin/tessera" edit "${here[@]}" --name loader --scene studio -c "load tests/scenes/studio-1.glb" >"$folder/load.log"
shot 1-loaded "a scene, loaded with 'tessera edit'"

# Two concurrent editors: an edit script, and Python.
printf 'set materials/sweep.base_color 0.15 0.25 0.5 1\nset materials/gold.roughness 0.4\n' >"$folder/blue.txt"
"$bin/tessera" edit "$folder/blue.txt" "${here[@]}" --name ann >"$folder/ann.log" 2>&1 &
ann=$!
PYTHONPATH=build/release/python /usr/bin/python3 deploy/tour.py "$endpoint" "$keys" "$tour/2-python.png" >"$folder/python.log" 2>&1 ||
    fail "the Python client failed"
wait "$ann" || fail "the script was rejected"
echo "tour: out/tour/2-python.png  a drag of 40 edits and a new lamp, seen from Python"
shot 2-edited "what both edited at the same time"

"$bin/tessera" status "${here[@]}" --chrome-trace "$tour/trace.json" >"$folder/times.log"
echo "tour: out/tour/trace.json  the times of these edits, for ui.perfetto.dev; in short:"
sed -n '/^live scene/,/cancel/p' "$folder/times.log"

transaction=$("$bin/tessera" edit "${here[@]}" -c "log 20" | awk '$4 == "ann" { print $1; exit }')
"$bin/tessera" edit "${here[@]}" --name ann -c "undo $transaction" >"$folder/undo.log"
shot 3-undone "ann's edits undone (transaction $transaction), Python's kept"

"$bin/tessera" watch "${here[@]}" --name photographer --size 640x360 --spp 64 --filter fdf --once -o "$tour/4-node-lost.png" >"$folder/4.log" &
watcher=$!
sleep 0.5
kill -KILL "$node_2"
wait "$node_2" 2>/dev/null || true
wait "$watcher" || fail "no picture after the loss of a node"
echo "tour: out/tour/4-node-lost.png  node-2 was killed while this was rendered"

"$bin/tessera" watch "${here[@]}" --name photographer --size 640x360 --spp 96 --filter fdf --once -o "$tour/5-master-killed.png" >"$folder/5.log" &
watcher=$!
sleep 2
kill -KILL "$master"
wait "$master" 2>/dev/null || true
start_master
answers || fail "the master did not restart"
wait "$watcher" || fail "no picture after the restart of the master"
echo "tour: out/tour/5-master-killed.png  the master was killed and restarted while this was rendered"
echo
"$bin/tessera" log "$folder/session"
echo
"$bin/tessera" status "${here[@]}"

[ -z "$once" ] || exit 0
cat <<END

The cluster is still running. Join it from other terminals:

  $bin/tessera watch --master $endpoint --keys $keys
  $bin/tessera edit  --master $endpoint --keys $keys
  $bin/tessera status --master $endpoint --keys $keys

Ctrl-C stops it.
END
wait "$master" || true
