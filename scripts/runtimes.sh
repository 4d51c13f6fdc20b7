#!/usr/bin/env bash
# Builds the library inside every FMU for all platforms, or for those named, into
# target/runtimes/PLATFORM/biela.EXTENSION, from where `make install` and `make wheel` take them.
#
#   scripts/runtimes.sh [linux64 win64 darwin64 aarch64-linux aarch64-darwin]...
#   scripts/runtimes.sh --current     lists the libraries that were built from these sources
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/lib.sh
. scripts/lib.sh
# shellcheck source=scripts/cross.sh
. scripts/cross.sh

CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-$PWD/target}
OUT=$PWD/target/runtimes
# Usual size of a library for one processor, at most [bytes]. A larger one may have taken in what an
# FMU does not need, or the standard library of another compiler.
USUAL_SIZE=4000000

# Builds the library for a target and prints its path.
library() { # TARGET FILE
    # A failure counts here: `set -e` does not hold in the substitution that calls this.
    cross_build 'cargo zigbuild' "$1" --package biela-runtime >&2 && cross_built "$1" "$2" || return
    tell_size "$1" "$(cross_built "$1" "$2")" >&2
}

# Prints a digest of all that a library is built from.
sources() { digest_of src crates/runtime scripts/cross.sh Cargo.toml Cargo.lock; }

current() {
    local now folder
    now=$(sources)
    for folder in "$OUT"/*/; do
        [ ! -f "$folder/.sources" ] || [ "$(cat "$folder/.sources")" != "$now" ] ||
            (cd "$OUT" && printf '%s\n' "$(basename "$folder")"/biela.*)
    done
}

tell_size() { # TARGET FILE
    local size
    size=$(wc -c <"$2")
    say "$1: $((size)) bytes"
    [ "$size" -le "$USUAL_SIZE" ] || say "note: libraries for $1 usually have at most $USUAL_SIZE bytes"
}

put() { # PLATFORM/FILE SOURCE
    mkdir -p "$OUT/${1%/*}"
    cp "$2" "$OUT/$1.new"
    mv "$OUT/$1.new" "$OUT/$1"
    printf '%s\n' "$BUILT_FROM" >"$OUT/${1%/*}/.sources"
}

build() { # PLATFORM
    local path other
    # Before the build: the sources may change meanwhile.
    BUILT_FROM=$(sources)
    case $1 in
    linux64)
        path=$(library x86_64-unknown-linux-gnu libbiela_runtime.so)
        put linux64/biela.so "$path"
        ;;
    aarch64-linux)
        path=$(library aarch64-unknown-linux-gnu libbiela_runtime.so)
        put aarch64-linux/biela.so "$path"
        ;;
    win64)
        path=$(library x86_64-pc-windows-gnu biela_runtime.dll)
        put win64/biela.dll "$path"
        ;;
    aarch64-darwin)
        path=$(library aarch64-apple-darwin libbiela_runtime.dylib)
        put aarch64-darwin/biela.dylib "$path"
        ;;
    darwin64)
        path=$(library aarch64-apple-darwin libbiela_runtime.dylib)
        other=$(library x86_64-apple-darwin libbiela_runtime.dylib)
        mkdir -p "$OUT"
        "$(lipo_program)" -create -output "$OUT/joined.dylib" "$other" "$path"
        put darwin64/biela.dylib "$OUT/joined.dylib"
        rm "$OUT/joined.dylib"
        ;;
    esac
}

if [ "${1:-}" = --current ]; then
    current
    exit
fi
if [ $# -eq 0 ]; then
    set -- linux64 win64 aarch64-linux aarch64-darwin darwin64
fi
cross_setup "$@"
count=$#
say "building $count of 5 libraries, about 5 minutes each on two processors the first time"
for platform in "$@"; do
    say "$platform: library $((count - $# + 1)) of $count, after $((SECONDS / 60)) min"
    build "$platform"
    shift
done
say "built in $((SECONDS / 60)) min $((SECONDS % 60)) s; \`make install\` installs them"
