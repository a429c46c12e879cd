#!/usr/bin/env bash
# Usage: deploy/test.sh [--long] [--ci] [ctest options], for example: deploy/test.sh -L numerics
#
# Sets up, builds and runs the tests, but for those with the labels `slow` and `long`: the former take long for what they add
# to the others, the latter compile the tree once more or take many minutes for another reason.
#   --ci    what a submission has to pass (.ci/run): also the slow tests and those of the benchmarks, with the tools of
#           deploy/packages-ci.txt installed; a tool that is missing is a failure, while elsewhere the tests that need it are
#           left out
#   --long  runs all there are
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=deploy/progress.sh
. deploy/progress.sh
left_out='slow|long'
preset=release
while [ "$#" -gt 0 ]; do
    case $1 in
    -h | --help)
        help_of deploy/test.sh
        exit
        ;;
    --long) left_out='' ;;
    --ci)
        preset=ci
        left_out=${left_out:+long}
        export TESSERA_PACKAGES="deploy/packages.txt deploy/packages-ci.txt"
        ;;
    *) break ;;
    esac
    shift
done
deploy/setup.sh "$preset"
exec ctest --test-dir build/release --output-on-failure --no-tests=error --parallel "$(nproc)" --label-exclude "^($left_out)\$" "$@"
