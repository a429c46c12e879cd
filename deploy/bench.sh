#!/usr/bin/env bash
# Usage: deploy/bench.sh [Google Benchmark options]
#
# Sets up, builds and runs the benchmarks, one after the other; each figure stands next to the limit that bounds it.
set -euo pipefail
cd "$(dirname "$0")/.."
case ${1:-} in
-h | --help)
    . deploy/progress.sh
    help_of deploy/bench.sh
    exit
    ;;
esac
deploy/setup.sh bench
for bench in film embree filter compose display; do
    echo "== $bench"
    "build/release/bin/tessera_${bench}_bench" "$@"
done
for bench in kernel update light; do
    echo "== $bench"
    "build/release/bin/tessera_${bench}_bench"
done
echo "== back-ends"
build/release/bin/tessera bench backends --scenes room-1,balls:1000000 --repeat 3
echo "== live"
build/release/bin/tessera bench live
echo "== displays"
build/release/bin/tessera bench displays
PYTHONPATH=build/release/python /usr/bin/python3 deploy/bench_join.py build/release/bin
