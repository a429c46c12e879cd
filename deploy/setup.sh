#!/usr/bin/env bash
# Usage: deploy/setup.sh [PRESET [TARGET...]]
#
# Installs missing Debian packages, then configures the preset (default: release) and builds the targets
# (default: all that its options enable). A second run does nothing if nothing has changed.
#
# Presets: release (unity build: fastest full build), dev (each source on its own: fast incremental builds), bench (release with
# the benchmarks), debug, asan, tsan, fuzz; see CMakePresets.json.
#
# TESSERA_BUILD_JOBS: number of parallel compilers (default: number of cores).
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
    echo "setup: unknown option $1; see --help" >&2
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
    echo "setup: this system is not Debian: install the packages of deploy/packages.txt with your package manager" >&2
    exit 1
fi
mapfile -t missing < <(missing_packages)
if [ "${#missing[@]}" -gt 0 ]; then
    progress "packages  reading the lists"
    quietly as_root apt-get -qq update
    # In groups, to show progress without installing one by one.
    group=8
    for ((first = 0; first < ${#missing[@]}; first += group)); do
        progress "packages  $first of ${#missing[@]} installed"
        quietly as_root env DEBIAN_FRONTEND=noninteractive \
            apt-get -qq install -y --no-install-recommends "${missing[@]:first:group}"
    done
    progress_done "installed ${#missing[@]} packages"
fi

progress "configuring"
# Quiet, since Imath's package warns about a Python library that is not needed here.
quietly cmake --preset "$preset"
build "$preset" "$@"
