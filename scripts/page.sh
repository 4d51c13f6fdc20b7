#!/usr/bin/env bash
# Builds the solver that pages hold, or the studio's, into target/runtimes/page.wasm or studio.wasm,
# from where `make install`, `make wheel` and the program in target/ take it. The same sources and the
# same compiler give the same bytes.
#
#   scripts/page.sh page                builds that of pages
#   scripts/page.sh studio              builds that of the studio
#   scripts/page.sh page --current      prints its path if it was built from these sources
#   scripts/page.sh studio --smoke      builds that of the studio for tests: slower, and built several times
#                                       faster, into target/smoke/studio.wasm
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
name=${1:-page} profile=page
if [ "${2:-}" = --smoke ]; then profile=smoke OUT=$PWD/target/smoke; fi
# Usual size, packed, at most [bytes]: each page and each FMU holds the solver of pages.
case $name in
page) usual_size=1200000 made_of='crates/tools/src crates/tools/Cargo.toml crates/page' ;;
studio) usual_size=1900000 made_of='crates/tools/src crates/tools/Cargo.toml crates/page crates/studio' ;;
*) fail "no solver is called \`$name\`" "It is page or studio." ;;
esac

# Prints a digest of all that the solver is built from.
# shellcheck disable=SC2086  # a list
sources() { digest_of src $made_of scripts/page.sh Cargo.toml Cargo.lock; }

current() {
    [ -f "$OUT/$name.wasm" ] && [ "$(cat "$OUT/.$name-sources" 2>/dev/null)" = "$(sources)" ]
}

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

if [ "${2:-}" = --current ]; then
    ! current || printf '%s\n' "$OUT/$name.wasm"
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
arguments=(build --locked --package "biela-$name" --profile "$profile" --target "$TARGET")
say "building the solver of the $name; the first time this takes some minutes"
if has_target rustc; then
    RUSTFLAGS="$flags" cargo "${arguments[@]}"
else
    linker=$(lld_program)
    [ -n "$linker" ] || fail "no linker for WebAssembly" "Install lld, or Rust by rustup."
    say "using $(/usr/bin/rustc --version), with a standard library built here"
    RUSTC=/usr/bin/rustc RUSTC_BOOTSTRAP=1 RUSTFLAGS="$flags" \
        CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER=$linker \
        /usr/bin/cargo "${arguments[@]}" -Zbuild-std=std,panic_abort
fi
mkdir -p "$OUT"
cp "$CARGO_TARGET_DIR/$TARGET/$profile/biela_$name.wasm" "$OUT/$name.wasm.new"
packed=$(gzip -9 -c "$OUT/$name.wasm.new" | wc -c)
say "$name.wasm: $(wc -c <"$OUT/$name.wasm.new") bytes, $packed packed"
[ $profile = smoke ] || [ "$packed" -le "$usual_size" ] || say "note: it usually has at most $usual_size bytes, packed"
mv "$OUT/$name.wasm.new" "$OUT/$name.wasm"
printf '%s\n' "$built_from" >"$OUT/.$name-sources"
