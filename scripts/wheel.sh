#!/usr/bin/env bash
# Builds a Python wheel per platform, or for those named, into target/wheels. Each holds the program
# with the libraries of all platforms, from `make runtimes`.
#
#   scripts/wheel.sh [linux64 win64 darwin64 aarch64-linux]...
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/lib.sh
. scripts/lib.sh
# shellcheck source=scripts/cross.sh
. scripts/cross.sh

export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-$PWD/target}
# The build script puts them into the program.
export BIELA_RUNTIMES=$PWD/target/runtimes

wheel() { # TARGET [ARGUMENT]...
    cross_build 'maturin build --zig' "$1" --out target/wheels "${@:2}"
}

libraries=$(bash scripts/runtimes.sh --current | wc -l)
[ "$libraries" -gt 0 ] || fail "there are no current libraries" "Run \`make runtimes\` first."
say "packing the libraries of $libraries platforms"
[ -n "$(bash scripts/page.sh --current)" ] || say "without the solver for pages: run \`make page\` first"
cross_setup
if [ $# -eq 0 ]; then
    set -- linux64 win64 darwin64 aarch64-linux
fi
for platform in "$@"; do
    case $platform in
    linux64) wheel x86_64-unknown-linux-gnu --compatibility manylinux2014 ;;
    aarch64-linux) wheel aarch64-unknown-linux-gnu --compatibility manylinux2014 ;;
    win64) wheel x86_64-pc-windows-gnu ;;
    darwin64)
        wheel x86_64-apple-darwin
        wheel aarch64-apple-darwin
        ;;
    *) fail "no wheel for $platform" "Name linux64, win64, darwin64 or aarch64-linux." ;;
    esac
done
ls -l target/wheels
