#!/usr/bin/env bash
# Sets up and does the main job: a master and two nodes as processes of their own (TCP on loopback, CURVE keys made for this
# run) render a glTF scene by tiles and cooperative samples into out/demo.exr and out/demo.png.
set -euo pipefail
cd "$(dirname "$0")/.."
deploy/setup.sh release

bin=build/release/bin
port=${TESSERA_DEMO_PORT:-7420}
master=tcp://127.0.0.1:$port
work=$(mktemp -d)
started=()

stop_everything() {
    trap - EXIT INT TERM
    # Nodes first, so that they can say goodbye; then whoever does not listen.
    for ((i = ${#started[@]} - 1; i >= 0; --i)); do kill -TERM "${started[i]}" 2>/dev/null || true; done
    for _ in $(seq 50); do
        local left=0
        for pid in "${started[@]}"; do kill -0 "$pid" 2>/dev/null && left=1; done
        ((left)) || break
        sleep 0.1
    done
    for pid in "${started[@]}"; do kill -KILL "$pid" 2>/dev/null || true; done
    wait 2>/dev/null || true
    rm -rf "$work"
}
trap stop_everything EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

start() {  # start NAME COMMAND...: in the background, with its log
    local name=$1
    shift
    "$@" >"$work/$name.log" 2>&1 &
    started+=($!)
}

mkdir -p out
"$bin/tessera" keys "$work/keys" >/dev/null
start master "$bin/tessera-master" --listen "$master" --keys "$work/keys"
start node-1 "$bin/tessera-node" --master "$master" --keys "$work/keys" --name node-1 --threads 1
start node-2 "$bin/tessera-node" --master "$master" --keys "$work/keys" --name node-2 --threads 1

# In the background too, so that Ctrl-C reaches this script at once.
"$bin/tessera" render tests/scenes/studio-1.glb --master "$master" --keys "$work/keys" --wait-nodes 2:60 \
    --env tests/scenes/env-studio.exr --size 1280x720 --spp "${TESSERA_DEMO_SPP:-64}" --policy mixed \
    -o out/demo.exr -o out/demo.png --json >"$work/demo.json" &
started+=($!)
status=0
wait "${started[-1]}" || status=$?
if ((status != 0)); then
    tail -n 5 "$work"/*.log >&2
    exit "$status"
fi

mv "$work/demo.json" out/demo.json
jq -r '
  "rendered  \(.width)x\(.height), \(.spp) samples per pixel, \(.triangles) triangles, \(.lights) lights",
  "time      \(.seconds_render * 100 | round / 100) s rendering, first picture after \(.first_picture_seconds * 100 | round / 100) s",
  "speed     \(.mrays_per_second * 100 | round / 100) Mrays/s, \(.samples_per_second / 1e4 | round / 100) Msamples/s",
  (.nodes[] | "node      pid \(.pid): \(.units) units, \(.samples) samples (\(.kind))"),
  "units     \(.units.merged) merged, \(.units.reissued) reissued, \(.units.duplicate) duplicate, \(.units.lost) lost",
  "wire      \(.wire_bytes.film / 1e6 | round) MB film, \(.wire_bytes.blobs / 1e3 | round) kB scene, \(.wire_bytes.control / 1e3 | round) kB control",
  "film      \(.film_hash)",
  "pictures  out/demo.exr, out/demo.png; figures in out/demo.json"' out/demo.json
