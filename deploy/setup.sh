#!/usr/bin/env bash
# Usage: deploy/setup.sh [PRESET [TARGET...]]
#
# Installs the Debian packages that are missing, then configures the preset (default: release) and builds the targets
# (default: all that its options choose). A second run installs and builds nothing.
#
# Presets: release (everything once, quickly: sources are compiled in batches), dev (each source on its own: less to compile
# after a change), bench (release with the benchmarks), debug, asan, tsan. CMakePresets.json has them.
#
# TESSERA_BUILD_JOBS: how many compilers run at a time (default: one for each core).
# TESSERA_PACKAGES: files that list packages (default: deploy/packages.txt).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=deploy/progress.sh
. deploy/progress.sh
case ${1:-} in
-h | --help)
    help_of deploy/setup.sh
    exit
    ;;
-*)
    echo "setup: there is no option $1; see --help" >&2
    exit 64
    ;;
esac
preset=${1:-release}
[ "$#" -eq 0 ] || shift

missing_packages() {
    local package lists
    read -ra lists <<<"${TESSERA_PACKAGES:-deploy/packages.txt}"
    while read -r package; do
        if ! dpkg-query -W -f='${db:Status-Status}\n' "$package" 2>/dev/null | grep -qx installed; then
            printf '%s\n' "$package"
        fi
    done < <(cat "${lists[@]}" | sed -e 's/#.*//' -e 's/[[:space:]]//g' -e '/^$/d')
}

as_root() {
    if [ "$(id -u)" -eq 0 ]; then
        "$@"
    elif command -v sudo >/dev/null; then
        sudo "$@"
    else
        echo "setup: packages are missing (${missing[*]}): run this as root, or install sudo" >&2
        exit 1
    fi
}

if ! command -v dpkg-query >/dev/null; then
    echo "setup: this is no Debian: install what deploy/packages.txt lists in your system's way" >&2
    exit 1
fi
mapfile -t missing < <(missing_packages)
if [ "${#missing[@]}" -gt 0 ]; then
    progress "packages  reading the lists"
    quietly as_root apt-get -qq update
    # One by one would take longer; in groups there is something to see.
    group=8
    for ((first = 0; first < ${#missing[@]}; first += group)); do
        progress "packages  $first of ${#missing[@]} installed"
        quietly as_root env DEBIAN_FRONTEND=noninteractive \
            apt-get -qq install -y --no-install-recommends "${missing[@]:first:group}"
    done
    progress_done "installed ${#missing[@]} packages"
fi

progress "configuring"
# Configuring tells of a Python library that Imath's package names and nobody here needs; only errors matter.
quietly cmake --preset "$preset"
build "$preset" "$@"
