#!/usr/bin/env bash
# Usage: deploy/test.sh [--long] [--ci] [ctest options], for example: deploy/test.sh -L numerics
#
# Sets up, builds and runs the tests, except those with the labels `slow` and `long`: slow tests add little to the others for
# their time, long tests rebuild the tree or take many minutes for other reasons.
#   --ci    what a submission has to pass (.ci/run): also the slow tests and those of the benchmarks, with the tools of
#           deploy/packages-ci.txt installed; a missing tool is a failure, while otherwise the tests that need it are skipped
#   --long  runs all tests
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
