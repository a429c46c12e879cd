#!/usr/bin/env bash
# Installs the Debian packages that are missing, then configures and builds the preset (default: release).
# A second run installs and builds nothing. Usage: deploy/setup.sh [PRESET]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
preset=${1:-release}

missing_packages() {
    local package
    while read -r package; do
        if ! dpkg-query -W -f='${db:Status-Status}\n' "$package" 2>/dev/null | grep -qx installed; then
            printf '%s\n' "$package"
        fi
    done < <(sed -e 's/#.*//' -e 's/[[:space:]]//g' -e '/^$/d' deploy/packages.txt)
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

# Silent unless it fails.
quietly() {
    local log
    log=$(mktemp)
    if ! "$@" >"$log" 2>&1; then
        cat "$log" >&2
        rm -f "$log"
        echo "setup: failed: $*" >&2
        exit 1
    fi
    rm -f "$log"
}

if ! command -v dpkg-query >/dev/null; then
    echo "setup: this is no Debian: install what deploy/packages.txt lists in your system's way" >&2
    exit 1
fi
mapfile -t missing < <(missing_packages)
if [ "${#missing[@]}" -gt 0 ]; then
    echo "setup: installing ${#missing[@]} packages"
    quietly as_root apt-get -qq update
    quietly as_root env DEBIAN_FRONTEND=noninteractive \
        apt-get -qq install -y --no-install-recommends "${missing[@]}"
fi

# Configuring tells of a Python library that Imath's package names and nobody here needs; only errors matter.
quietly cmake --preset "$preset"
cmake --build --preset "$preset" --parallel "${TESSERA_BUILD_JOBS:-$(nproc)}"
