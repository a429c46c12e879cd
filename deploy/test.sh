#!/usr/bin/env bash
# Usage: deploy/test.sh [--long] [--ci] [ctest options], for example: deploy/test.sh -L numerics
#
# Sets up, builds and runs the tests, but for those with the label `long`, which compile the tree once more or take many
# minutes for another reason.
#   --long  runs these, too
#   --ci    what a submission has to pass (.ci/run): also the tests of the benchmarks, with the tools of
#           deploy/packages-ci.txt installed; a tool that is missing is a failure, while elsewhere the tests that need it are
#           left out
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=deploy/progress.sh
. deploy/progress.sh
choice=(--label-exclude '^long$')
preset=release
while [ "$#" -gt 0 ]; do
    case $1 in
    -h | --help)
        help_of deploy/test.sh
        exit
        ;;
    --long) choice=() ;;
    --ci)
        preset=ci
        export TESSERA_PACKAGES="deploy/packages.txt deploy/packages-ci.txt"
        ;;
    *) break ;;
    esac
    shift
done
deploy/setup.sh "$preset"
exec ctest --test-dir build/release --output-on-failure --no-tests=error --parallel "$(nproc)" "${choice[@]}" "$@"
