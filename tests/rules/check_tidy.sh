#!/usr/bin/env bash
# Runs clang-tidy with the checks of .clang-tidy, without the warnings of clang itself, over all product sources, as they are compiled in BUILD_FOLDER (batches of
# sources are read once). Prints what it finds; exits with 1 if there is any. Usage: tests/rules/check_tidy.sh BUILD_FOLDER
set -uo pipefail
folder=$(realpath -m "$1")
cd "$(dirname "${BASH_SOURCE[0]}")/../.." || exit
products='(mediator|backends|node|master|client)'
run-clang-tidy-16 -quiet -p "$folder" -j "$(nproc)" -header-filter "$PWD/$products/.*" -extra-arg=-w \
    "^($PWD|$folder)/$products/(?!.*\.pb\.cc)" 2>&1 | grep -v -e '^clang-tidy-16 ' -e '^[0-9]* warnings'
exit "${PIPESTATUS[0]}"
