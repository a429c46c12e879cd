#!/usr/bin/env bash
# Lines, files and folders of the product: every hand-written source outside tests and deploy. Usage: deploy/count_lines.sh [REVISION]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
revision=${1:-}
sources=('*.cpp' '*.h' '*.proto' '*.py' '*.comp' '*.vert' '*.frag' '*.glsl')
product='^(proto|mediator|backends|node|master|client)/'
if [ -n "$revision" ]; then
    list() { git ls-tree -r --name-only "$revision"; }
    text() { git show "$revision:$1"; }
else
    list() { git ls-files; }
    text() { cat "$1"; }
fi
patterns=$(printf '%s\n' "${sources[@]}" | sed -e 's/\./\\./' -e 's/\*/.*/' -e 's/$/$/' | paste -sd '|')
list | grep -E "$product" | grep -E "$patterns" | while read -r file; do
    printf '%s %s\n' "${file%%/*}" "$(text "$file" | wc -l)"
done | awk '
    { files[$1]++; lines[$1] += $2; all_files++; all += $2 }
    END {
        for (folder in files) printf "%-10s %5d files %7d lines\n", folder, files[folder], lines[folder] | "sort"
        close("sort")
        printf "%-10s %5d files %7d lines\n", "product", all_files, all
    }'
