#!/usr/bin/env bash
# Sets up, builds and runs every test. Arguments go to ctest, as in: deploy/test.sh -L unit
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
deploy/setup.sh
exec ctest --test-dir build/release --output-on-failure --no-tests=error -j2 "$@"
