#!/usr/bin/env bash
# Installs the system packages that are missing (Debian 12 and its relatives).
#   scripts/setup.sh           what building and running need
#   scripts/setup.sh --tests   also what the tests need: validation layers, a second driver, npm
# Without root and without sudo it lists what is missing and exits with 2.
set -euo pipefail

wanted=(libshaderc-dev glslang-dev spirv-tools pkg-config g++ mesa-vulkan-drivers libvulkan1)
case "${1:-}" in
"") tests=no ;;
--tests)
    tests=yes
    wanted+=(vulkan-validationlayers)
    ;;
*)
    echo "usage: scripts/setup.sh [--tests]" >&2
    exit 2
    ;;
esac

swiftshader=/usr/lib/chromium/vk_swiftshader_icd.json

installed() { [ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null)" = installed ]; }

if ! command -v cargo >/dev/null; then
    echo "setup: Rust is missing; rustup (https://rustup.rs) installs it" >&2
    exit 2
fi
needed=$(sed -n 's/^rust-version = "\(.*\)"/\1/p' "$(dirname "$0")/../Cargo.toml")
found=$(cargo --version | cut -d' ' -f2)
if [ "$(printf '%s\n' "$needed" "$found" | sort --version-sort | head -1)" != "$needed" ]; then
    echo "setup: Rust $found is too old, $needed is needed; rustup update installs it" >&2
    exit 2
fi
if ! command -v dpkg-query >/dev/null; then
    echo "setup: this is no Debian; install what these packages hold: ${wanted[*]}" >&2
    exit 2
fi

missing=()
for package in "${wanted[@]}"; do
    installed "$package" || missing+=("$package")
done
# Installed by calls of their own: apt refuses chromium and npm in one call.
separate=()
if [ "$tests" = yes ]; then
    [ -e "$swiftshader" ] || separate+=(chromium)
    command -v npm >/dev/null || separate+=("nodejs npm")
fi
[ "${#missing[@]}" -gt 0 ] || [ "${#separate[@]}" -gt 0 ] || exit 0

as_root=()
if [ "$(id -u)" != 0 ]; then
    if ! command -v sudo >/dev/null; then
        echo "setup: not root and no sudo; missing packages: ${missing[*]} ${separate[*]}" >&2
        exit 2
    fi
    as_root=(sudo)
fi
install() {
    echo "setup: installing $*" >&2
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
        apt-get install --yes --quiet --no-install-recommends "$@" >&2
}
"${as_root[@]}" apt-get update --quiet >&2
[ "${#missing[@]}" -eq 0 ] || install "${missing[@]}"
for packages in "${separate[@]}"; do
    # Word splitting is meant: one entry is one call of apt.
    # shellcheck disable=SC2086
    install $packages
done
