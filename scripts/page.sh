#!/usr/bin/env bash
# Builds the solver that pages hold, into target/runtimes/page.wasm, from where `make install`,
# `make wheel` and the program in target/ take it. The same sources and the same compiler give the
# same bytes.
#
#   scripts/page.sh              builds it
#   scripts/page.sh --current    prints its path if it was built from these sources
#
# Needs the target wasm32-unknown-unknown of Rust, which rustup adds. Debian's packages rustc-web,
# cargo-web and rust-web-src, with the linker of rustup's toolchain, take its place.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/lib.sh
. scripts/lib.sh

TARGET=wasm32-unknown-unknown
export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-$PWD/target}
OUT=$PWD/target/runtimes
# Usual size, packed, at most [bytes]: each page and each FMU holds the solver.
USUAL_SIZE=1100000

# Prints a digest of all that the solver is built from.
sources() { digest_of src page scripts/page.sh Cargo.toml Cargo.lock; }

current() { [ -f "$OUT/page.wasm" ] && [ "$(cat "$OUT/.page-sources" 2>/dev/null)" = "$(sources)" ]; }

# Whether a compiler has the standard library for the target.
has_target() { # RUSTC
    [ -d "$("$1" --print target-libdir --target "$TARGET" 2>/dev/null)" ]
}

# Whether Debian's compiler is there with the sources of the standard library.
has_sources() {
    [ -d /usr/lib/rustlib/src/rust/library/std ] && [ -x /usr/bin/cargo ] && [ -x /usr/bin/rustc ]
}

# Gets the standard library for the target, from rustup or from Debian.
get_target() {
    has rustup && say "adding $TARGET with rustup" && rustup target add "$TARGET" && return
    can_apt && apt_install rustc-web cargo-web rust-web-src lld
}

if [ "${1:-}" = --current ]; then
    ! current || printf '%s\n' "$OUT/page.wasm"
    exit
fi

if ! has_target rustc && ! has_sources; then
    get_target || fail "there is no Rust standard library for $TARGET" \
        "Run \`rustup target add $TARGET\`," \
        "or install Debian's rustc-web, cargo-web, rust-web-src and lld." \
        "Without it, biela writes pages that play a motion computed beforehand."
fi
built_from=$(sources)
# Paths of this machine would differ from machine to machine.
flags="--remap-path-prefix=$PWD=. --remap-path-prefix=${CARGO_HOME:-$HOME/.cargo}=cargo"
# With half the usual threshold for inlining the solver is an eighth smaller, and not slower.
flags="$flags -Cllvm-args=-inline-threshold=100"
arguments=(build --locked --package biela-page --profile page --target "$TARGET")
say "building the solver for pages; the first time this takes some minutes"
if has_target rustc; then
    RUSTFLAGS="$flags" cargo "${arguments[@]}"
else
    linker=$(rustc --print sysroot)/lib/rustlib/$(rustc -vV | sed -n 's/^host: //p')/bin/rust-lld
    [ -x "$linker" ] || linker=$(command -v rust-lld || command -v wasm-ld) ||
        fail "no linker for WebAssembly" "Install lld, or Rust by rustup."
    say "using $(/usr/bin/rustc --version), with a standard library built here"
    RUSTC=/usr/bin/rustc RUSTC_BOOTSTRAP=1 RUSTFLAGS="$flags" \
        CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER=$linker \
        /usr/bin/cargo "${arguments[@]}" -Zbuild-std=std,panic_abort
fi
mkdir -p "$OUT"
cp "$CARGO_TARGET_DIR/$TARGET/page/biela_page.wasm" "$OUT/page.wasm.new"
packed=$(gzip -9 -c "$OUT/page.wasm.new" | wc -c)
say "page.wasm: $(wc -c <"$OUT/page.wasm.new") bytes, $packed packed"
[ "$packed" -le "$USUAL_SIZE" ] || say "note: it usually has at most $USUAL_SIZE bytes, packed"
mv "$OUT/page.wasm.new" "$OUT/page.wasm"
printf '%s\n' "$built_from" >"$OUT/.page-sources"
