#!/usr/bin/env bash
# Renders the README's pictures of renderers and materials anew, into docs/ or the folder that is named:
#   docs/make_pictures.sh [FOLDER]
# TESSERA is the program (build/release/bin/tessera), TESSERA_SPP the samples per pixel (128).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
out=${1:-docs}
tessera=${TESSERA:-build/release/bin/tessera}
spp=${TESSERA_SPP:-128}
[ -x "$tessera" ] || { echo "make_pictures: there is no '$tessera': build it, or set TESSERA" >&2; exit 2; }
mkdir -p "$out"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

for renderer in path whitted raster coverage; do
    backend=embree
    [ $renderer != raster ] || backend=vulkan
    "$tessera" render tests/scenes/still.glb --env tests/scenes/env-studio.exr --renderer $renderer --backend $backend \
        --size 320x240 --spp "$spp" -o "$out/renderer-$renderer.png"
done

# What the rows show is in docs/material_chart.py. Pictures of four rows stay small.
python3 docs/material_chart.py "$folder" >"$folder/scenes"
while read -r scene rows; do
    "$tessera" render "$folder/$scene" --background 0.12,0.13,0.15 --bounces 12 --spp "$spp" --filter fdf \
        --size "512x$((64 * rows))" -o "$out/${scene%.*}.png" </dev/null
done <"$folder/scenes"
