#!/usr/bin/env bash
# Sets up, builds and runs every test. Usage: deploy/test.sh [ctest options], for example: deploy/test.sh -L numerics
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
deploy/setup.sh release
exec ctest --test-dir build/release --output-on-failure --no-tests=error --parallel "$(nproc)" "$@"
