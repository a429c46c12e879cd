#!/usr/bin/env bash
# Usage: deploy/demo.sh [options of `tessera render`] | --live [--once] | --wall
#
# Builds Tessera and renders a glTF scene with a master, an Embree node and a Vulkan node as separate processes (TCP on
# loopback, CURVE keys generated for this run). Work is split by tiles and samples; the pictures are out/demo.exr and
# out/demo.png. Options are passed to the render: deploy/demo.sh --spp 16
#   --live  a tour of live editing instead (deploy/tour.sh); with --once it exits afterwards
#   --wall  simulates a stereo wall of six projectors instead (deploy/wall.sh)
# Only the programs that are needed are built.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
case ${1:-} in
-h | --help)
    . deploy/progress.sh
    help_of deploy/demo.sh
    exit
    ;;
--live | --wall)
    script=deploy/tour.sh
    [ "$1" = --live ] || script=deploy/wall.sh
    shift
    exec "$script" "$@"
    ;;
esac
deploy/setup.sh release tessera tessera-master tessera-node

bin=build/release/bin
folder=$(mktemp -d)
children=()

# shellcheck source=deploy/children.sh
. deploy/children.sh
trap stop_everything EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

mkdir -p out
keys=$folder/keys
"$bin/tessera" keys "$keys" >"$folder/keys.log"

# Two free consecutive ports; if another program takes them first, the next are tried.
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
# One Embree node, one Vulkan node (on the software device if there is no GPU).
start node-1 "$bin/tessera-node" --master "$endpoint" --keys "$keys" --name node-1 --threads 1 --backend embree
start node-2 "$bin/tessera-node" --master "$endpoint" --keys "$keys" --name node-2 --threads 1 --backend vulkan

echo "demo: rendering tests/scenes/interior-1.glb with an Embree and a Vulkan node"
rm -f out/demo.exr out/demo.png out/demo.json
# In the background, so that a signal is answered at once.
# The windows are open: light that is found through panes of glass would still be noisy.
"$bin/tessera" render tests/scenes/interior-1.glb --master "$endpoint" --keys "$keys" --wait-nodes 2:60 \
    --env tests/scenes/env-noon.exr --camera room --hide "kitchen window panes" --hide "tall window panes" \
    --hide "wide window panes" --hide "lamp bulb" \
    --size "${TESSERA_DEMO_SIZE:-640x360}" --spp "${TESSERA_DEMO_SPP:-32}" --denoise=nfor:blend=off --policy mixed \
    -o out/demo.exr -o out/demo.png --json "$@" >"$folder/demo.json" &
render=$!
children+=("$render")
status=0
wait "$render" || status=$?
((status == 0)) || fail "the render failed" "$status"
mv "$folder/demo.json" out/demo.json

jq -r '
    def rounded(digits): . * pow(10; digits) | round / pow(10; digits);
    def mib: . / 1048576 | rounded(1);
    "",
    "  picture     \(.width) x \(.height), \(.spp) samples per pixel, \(.triangles) triangles, \(.instances) instances, \(.lights) lights",
    "  time        \(.seconds_render | rounded(2)) s rendering, \(.seconds_total | rounded(2)) s in total, first picture after \(.first_picture_seconds | rounded(2)) s",
    "  speed       \(.mrays_per_second | rounded(2)) Mray/s, \(.samples_per_second / 1e6 | rounded(3)) Msamples/s",
    (.samples_total = ([.nodes[].samples] | add) | .samples_total as $all | .nodes[] |
    "  node \(.id)      pid \(.pid), \(.kind): \(.units) units, \(100 * .samples / ([$all, 1] | max) | rounded(1)) % of the samples"),
    "  units       \(.units.issued) issued, \(.units.merged) merged, \(.units.reissued) reissued, \(.units.lost) lost",
    "  network     \(.wire_bytes.film | mib) MiB film, \(.wire_bytes.blobs | mib) MiB scene, \(.wire_bytes.control | mib) MiB control, encrypted with CURVE",
    "  film hash   \(.film_hash)"
' out/demo.json
echo "  files       out/demo.exr  out/demo.png  out/demo.json"
