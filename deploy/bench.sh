#!/usr/bin/env bash
# Usage: deploy/bench.sh [--docs]
#
# Sets up, builds and runs the benchmarks one after the other (about an hour and a half on 2 cores) and writes them as one page,
# out/bench/benchmarks.md. Each figure is next to the limit that bounds it. Run it on an otherwise idle machine.
#   --docs  writes docs/benchmarks.md instead
set -euo pipefail
cd "$(dirname "$0")/.."
# shellcheck source=deploy/progress.sh
. deploy/progress.sh
page=out/bench/benchmarks.md
case ${1:-} in
"") ;;
--docs) page=docs/benchmarks.md ;;
-h | --help)
    help_of deploy/bench.sh
    exit
    ;;
*)
    echo "bench: unknown option $1; see --help" >&2
    exit 64
    ;;
esac
deploy/setup.sh bench
bin=build/release/bin
out=out/bench
mkdir -p "$out"

# run NAME COMMAND...: its output becomes the file NAME; what it says on the error stream is shown if it fails.
run() {
    local name=$1
    shift
    progress "bench  ${name%.*}"
    "$@" >"$out/$name" 2>"$out/errors" || {
        cat "$out/errors" >&2
        echo "bench: ${name%.*} failed: $*" >&2
        exit 1
    }
}

for bench in embree film filter adaptive compose display; do
    run "$bench.json" "$bin/tessera_${bench}_bench" --benchmark_format=json
done
for bench in kernel update texture; do
    run "$bench.txt" "$bin/tessera_${bench}_bench"
done
run light.txt "$bin/tessera_light_bench" trees
run fog.txt "$bin/tessera_light_bench" fog
run skies.txt "$bin/tessera_light_bench" skies
run filters.json "$bin/tessera" bench filters -o "$out/filters" --scenes room-1,studio-1,interior-1,still --spp 4 --large none \
    --reference-spp 512 --json
run consistency.json "$bin/tessera" bench consistency --spp 4,16,64,256 --seeds 4 --reference-spp 2048 \
    --references "$out/references" --json
run adaptive_sampling.json "$bin/tessera" bench adaptive --spp 32,64 --noise 0.2 --seeds 3 --reference-spp 8192 \
    --references "$out/references" --json
run adaptive_error.json "$bin/tessera" bench adaptive --spp "" --noise "" --error 0.03,0.01 --filter fdf --seeds 3 --reference-spp 2048 \
    --references "$out/references" --json
run transport.json "$bin/tessera" bench transport -o "$out/transport" --json
run variance.json "$bin/tessera" bench variance --spp 4,16,64 --seeds 12 --json
run backends.txt "$bin/tessera" bench backends --scenes room-1,studio-1,interior-1,balls:1000000 --spp 4 --repeat 3
run live.txt "$bin/tessera" bench live
run wire.txt /usr/bin/python3 tests/bench/wire/wire_bench.py --bin "$bin" --spp 16 --pairs 5 --no-targets
run displays.txt "$bin/tessera" bench displays
PYTHONPATH=build/release/python run join.txt /usr/bin/python3 deploy/bench_join.py "$bin"

python3 docs/make_benchmarks.py "$out" "$("$bin/tessera" --version)" >"$out/page"
mv "$out/page" "$page"
cp "$out/transport/transport.svg" "$(dirname "$page")/transport.svg"
echo "bench: wrote $page"
