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
# The build script puts what is in it into the program.
export BIELA_RUNTIMES=$CARGO_TARGET_DIR/wheel-runtimes

wheel() { # TARGET [ARGUMENT]...
    cross_build 'maturin build --zig' "$1" --out target/wheels "${@:2}"
}

libraries=$(bash scripts/runtimes.sh --current)
[ -n "$libraries" ] || fail "there are no current libraries" "Run \`make runtimes\` first."
say "packing the libraries" $libraries
rm -rf "$BIELA_RUNTIMES"
for library in $libraries; do
    mkdir -p "$BIELA_RUNTIMES/${library%/*}"
    cp "target/runtimes/$library" "$BIELA_RUNTIMES/$library"
done
for name in page studio; do
    solver=$(bash scripts/page.sh "$name" --current)
    if [ -n "$solver" ]; then
        cp "$solver" "$BIELA_RUNTIMES/$name.wasm"
    else
        say "without the solver of the $name: run \`make $name\` first"
    fi
done
if [ $# -eq 0 ]; then
    set -- linux64 win64 darwin64 aarch64-linux
fi
cross_setup "$@"
say "building wheels for $*, 5 to 11 minutes for each processor on two processors"
for platform in "$@"; do
    case $platform in
    linux64) wheel x86_64-unknown-linux-gnu --compatibility manylinux2014 ;;
    aarch64-linux) wheel aarch64-unknown-linux-gnu --compatibility manylinux2014 ;;
    win64) wheel x86_64-pc-windows-gnu ;;
    darwin64)
        wheel x86_64-apple-darwin
        wheel aarch64-apple-darwin
        ;;
    *) fail "no wheel for $platform alone" "The wheels of darwin64 are for both processors." ;;
    esac
done
ls -l target/wheels
