#!/usr/bin/env bash
# Configures the preset for developers, with the benchmarks, and compiles each source on its own: every one includes what it
# uses. Without optimisation, since only that is the question. Usage: tests/rules/build_each_source.sh BUILD_FOLDER
set -euo pipefail
folder=$(realpath -m "$1")
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
cmake --preset debug -B "$folder" -D TESSERA_BENCH=ON -D CMAKE_CXX_FLAGS_DEBUG=-O0
cmake --build "$folder" --parallel "$(nproc)"
