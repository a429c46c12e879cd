#!/usr/bin/env bash
# Usage: deploy/docs.sh [FOLDER]
#
# Generates man pages of all programs and commands from their --help, and the reference of the C++ client from its headers, in
# FOLDER/man and FOLDER/cpp (default: build/docs). Needs a build, and Debian's help2man and doxygen.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=deploy/progress.sh
. deploy/progress.sh
case ${1:-} in
-h | --help)
    help_of deploy/docs.sh
    exit
    ;;
esac
folder=${1:-build/docs}
bin=${TESSERA_BIN:-build/release/bin}
for tool in help2man doxygen; do
    command -v "$tool" >/dev/null || { echo "docs: $tool not found: apt-get install $tool" >&2; exit 1; }
done
[ -x "$bin/tessera" ] || { echo "docs: $bin/tessera not found: run deploy/setup.sh first" >&2; exit 1; }
mkdir -p "$folder/man/man1" "$folder/cpp"

# Writes the man pages of a command and its sub-commands, except `tessera bench`, which needs the benchmarks.
page() {
    local help summary name inner
    help=$("$@" --help)
    summary=$(head -n 1 <<<"$help")
    name=$(basename "$1")
    inner="${*:2}"
    help2man --no-info --name "${summary%.}" --version-string "$("$bin/tessera" --version | cut -d ' ' -f 2)" \
        --output "$folder/man/man1/$name${inner:+-${inner// /-}}.1" "$*"
    while read -r inner; do
        [ "$inner" = bench ] || page "$@" "$inner"
    done < <(sed -n '/^Subcommands:/,/^$/p' <<<"$help" | grep -oE '^  [a-z][a-z-]*' | tr -d ' ')
}
for program in tessera tessera-master tessera-node tessera-display; do
    page "$bin/$program"
done
echo "wrote $(find "$folder/man" -name '*.1' | wc -l) man pages: man -M $folder/man tessera"

doxygen - <<EOF
PROJECT_NAME = Tessera
PROJECT_BRIEF = "the C++ client"
INPUT = client mediator/session
FILE_PATTERNS = *.h
RECURSIVE = NO
EXTRACT_ALL = YES
GENERATE_LATEX = NO
HAVE_DOT = NO
QUIET = YES
WARNINGS = NO
OUTPUT_DIRECTORY = $folder/cpp
STRIP_FROM_PATH = .
EOF
echo "wrote $folder/cpp/html/index.html"
