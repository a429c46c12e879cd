#!/usr/bin/env bash
# Every C++ source is as clang-format 14 (Debian 12's) writes it. Usage: tests/rules/check_format.sh [--fix]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
mode=(--dry-run -Werror)
[ "${1:-}" != --fix ] || mode=(-i)
formatter=clang-format-14
command -v "$formatter" >/dev/null || formatter=clang-format
git ls-files -z --cached --others --exclude-standard -- '*.h' '*.cpp' |
    while IFS= read -r -d '' file; do [ ! -e "$file" ] || printf '%s\0' "$file"; done |
    xargs -0 -n 64 -P "$(nproc)" "$formatter" "${mode[@]}"
