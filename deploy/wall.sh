#!/usr/bin/env bash
# Usage: deploy/demo.sh --wall
#
# The wall of deploy/demo.sh --wall: a master, two nodes, and six headless output processes, one for each projector of
# deploy/wall.toml (3 x 2, keystoned, overlapping, both eyes), frame-locked. The pictures of each projector, and a preview of
# what viewers see on the screen, are written to out/wall/.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
case ${1:-} in
-h | --help)
    . deploy/progress.sh
    help_of deploy/wall.sh
    exit
    ;;
esac
if [ "$#" -gt 0 ]; then
    echo "demo: --wall takes no options, not '$1'" >&2
    exit 64
fi
deploy/setup.sh release tessera tessera-master tessera-node tessera-display

bin=build/release/bin
folder=$(mktemp -d)
children=()
# shellcheck source=deploy/children.sh
. deploy/children.sh
trap stop_everything EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

wall=out/wall
rm -rf "$wall"
mkdir -p "$wall/patterns"
echo "demo: checking the wall described by deploy/wall.toml"
"$bin/tessera" display check deploy/wall.toml -o "$wall/plan.png"
"$bin/tessera" display pattern deploy/wall.toml -o "$wall/patterns" >"$folder/pattern.log"
"$bin/tessera" display preview deploy/wall.toml --pictures "$wall/patterns" -o "$wall/pattern.png" >"$folder/pattern.log"

keys=$folder/keys
"$bin/tessera" keys "$keys" >"$folder/keys.log"
for ((attempt = 0; ; ++attempt)); do
    [ "$attempt" -lt 20 ] || fail "found no free port"
    endpoint=tcp://127.0.0.1:${TESSERA_DEMO_PORT:-$((20000 + RANDOM % 12000))}
    start master "$bin/tessera-master" --listen "$endpoint" --keys "$keys"
    master=${children[-1]}
    for ((question = 0; question < 20; ++question)); do
        "$bin/tessera" status --master "$endpoint" --keys "$keys" >"$folder/status.log" 2>&1 && break 2
        kill -0 "$master" 2>/dev/null || continue 2
    done
    fail "the master does not answer"
done
here=(--master "$endpoint" --keys "$keys")
start node-1 "$bin/tessera-node" "${here[@]}" --name node-1 --threads 1
start node-2 "$bin/tessera-node" "${here[@]}" --name node-2 --threads 1

"$bin/tessera" edit "${here[@]}" -c 'load tests/scenes/room-1.glb' >"$folder/edit.log" ||
    fail "the scene was not loaded"
"$bin/tessera" display open deploy/wall.toml "${here[@]}" >"$folder/open.log" || fail "the display was not opened"
mapfile -t outputs < <("$bin/tessera" status "${here[@]}" --json | jq -r '.display.outputs[].name')
for output in "${outputs[@]}"; do
    start "output-$output" "$bin/tessera-display" "${here[@]}" --output "$output" --headless --png "$wall" --log "$wall/$output.log"
done

echo "demo: ${#outputs[@]} frame-locked output processes"
for ((waited = 0; ; ++waited)); do
    "$bin/tessera" status "${here[@]}" --json >"$folder/status.json" || fail "the master does not answer"
    least=$(jq '[.display.outputs[] | if .state == "locked" then .samples else 0 end] | min' "$folder/status.json")
    ((least >= 16)) && break
    ((waited < 1200)) || fail "not all outputs became locked"
    sleep 0.25
done
sleep 0.5 # wait for the last frame
"$bin/tessera" display preview deploy/wall.toml --pictures "$wall" --black 0.002 -o "$wall/preview.png" >"$folder/preview.log" ||
    fail "no viewer preview"

"$bin/tessera" status "${here[@]}" | sed -n "/^display/,/^node/p" | sed '/^node/d'
cat "$wall"/*.log | jq -rs '
    def rounded(digits): . * pow(10; digits) | round / pow(10; digits);
    group_by(.frame) | map(select(length == 6)) |
    "  frames      \(length) shown by all six projectors; \(map(select([.[].version] | unique | length > 1)) | length) with mixed versions",
    "  in step     within \(map(([.[].shown] | max) - ([.[].shown] | min)) | sort | .[length / 2 | floor] / 1e6 | rounded(2)) ms (median of the frames)"'
echo "  files       $wall/preview-left.png, -right.png: viewer preview; $wall/plan.png; $wall/OUTPUT-left.png, -right.png: what each projector shows"
