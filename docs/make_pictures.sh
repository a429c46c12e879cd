#!/usr/bin/env bash
# Usage: docs/make_pictures.sh [FOLDER]
#
# Renders all pictures of the documents again, into docs/ or the given folder (about 30 minutes on 2 cores).
#   TESSERA_SPP  samples per pixel of the charts (default: 128)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=deploy/progress.sh
. deploy/progress.sh
case ${1:-} in
-h | --help)
    help_of docs/make_pictures.sh
    exit
    ;;
esac
out=${1:-docs}
spp=${TESSERA_SPP:-128}
deploy/setup.sh bench
tessera=build/release/bin/tessera
mkdir -p "$out"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

progress "pictures  demo"
TESSERA_DEMO_SIZE=960x540 TESSERA_DEMO_SPP=64 quietly deploy/demo.sh
cp out/demo.png "$out/demo.png"

progress "pictures  product"
quietly "$tessera" render tests/scenes/still.glb --env tests/scenes/env-studio.exr --env-rotation 90 --size 960x540 --spp 128 \
    --denoise=nfor:blend=off --exposure -1.2 \
    -o "$out/product.png"

progress "pictures  wall"
quietly deploy/demo.sh --wall
"$tessera" display preview deploy/wall.toml --pictures out/wall --black 0.002 --width 960 -o "$folder/wall.png" >/dev/null
cp "$folder/wall-left.png" "$out/wall.png"

progress "pictures  renderers"
for renderer in path whitted raster coverage; do
    backend=embree
    [ $renderer != raster ] || backend=vulkan
    quietly "$tessera" render tests/scenes/still.glb --env tests/scenes/env-studio.exr --env-rotation 90 --renderer $renderer --backend $backend \
        --size 320x240 --spp "$spp" -o "$out/renderer-$renderer.png"
done

progress "pictures  noise"
for amount in "before --spp 16" "after --noise 0.5"; do
    # shellcheck disable=SC2086  # words
    quietly "$tessera" render tests/scenes/interior-1.glb --size 384x216 ${amount#* } --noise-map "$out/noise-${amount%% *}.png" \
        -o "$folder/interior.png"
done

progress "pictures  denoisers"
quietly "$tessera" bench filters -o "$folder/filters" --scenes room-1 --spp 4 --size 96x54 --large 480x270 --reference-spp 256
cp "$folder/filters/crops.png" "$out/filters.png"

# docs/material_chart.py says what the rows show. Pictures of four rows stay small.
python3 docs/material_chart.py "$folder" >"$folder/scenes"
while read -r scene rows; do
    progress "pictures  ${scene%.*}"
    quietly "$tessera" render "$folder/$scene" --background 0.12,0.13,0.15 --bounces 12 --spp "$spp" --denoise \
        --size "512x$((64 * rows))" -o "$out/${scene%.*}.png" </dev/null
done <"$folder/scenes"
progress_done "pictures  all are in $out"
