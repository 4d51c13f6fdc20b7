#!/usr/bin/env bash
# Puts all that a release holds into target/dist: for this platform, or for those named, a wheel and
# an archive with the program, the libraries of all platforms that are built, the solver for pages,
# the mechanisms and the documentation, and a list of checksums.
#
#   scripts/dist.sh [linux64 win64 darwin64 aarch64-linux]...
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/lib.sh
. scripts/lib.sh
# shellcheck source=scripts/cross.sh
. scripts/cross.sh

export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-$PWD/target}
OUT=$PWD/target/dist

# Prints the platform of this machine.
own_platform() {
    case "$(uname -s) $(uname -m)" in
    'Linux x86_64') echo linux64 ;;
    'Linux aarch64') echo aarch64-linux ;;
    Darwin*) echo darwin64 ;;
    *) fail "no release for $(uname -s) on $(uname -m)" "Name a platform: make dist ONLY=linux64" ;;
    esac
}

# Prints what the archive for a target is called.
name_of() { # TARGET
    case $1 in
    x86_64-unknown-linux-gnu) echo linux-x86_64 ;;
    aarch64-unknown-linux-gnu) echo linux-aarch64 ;;
    x86_64-pc-windows-gnu) echo windows-x86_64 ;;
    x86_64-apple-darwin) echo macos-x86_64 ;;
    aarch64-apple-darwin) echo macos-arm64 ;;
    esac
}

# Builds the program for a target, with its libraries beside it, and packs both.
archive() { # TARGET
    local program=biela
    case $1 in *-windows-*) program=biela.exe ;; esac
    BIELA_RUNTIMES='' cross_build 'cargo zigbuild' "$1" --package biela-tools --bin biela
    python3 scripts/pack.py "$OUT" "$(name_of "$1")" "$(cross_built "$1" "$program")"
}

[ $# -gt 0 ] || set -- "$(own_platform)"
for name in page studio; do
    [ -n "$(bash scripts/page.sh "$name" --current)" ] || bash scripts/page.sh "$name"
done
libraries=$(bash scripts/runtimes.sh --current)
for platform in "$@"; do
    case $libraries in *"$platform/"*) ;; *) bash scripts/runtimes.sh "$platform" ;; esac
done
say "libraries:" $(bash scripts/runtimes.sh --current)
bash scripts/wheel.sh "$@"
rm -rf "$OUT"
mkdir -p "$OUT"
for platform in "$@"; do
    for target in $(targets_of "$platform"); do
        archive "$target"
        python3 scripts/pack.py --wheel "$OUT" "$(name_of "$target")" target/wheels
    done
done
(cd "$OUT" && python3 "$OLDPWD/scripts/pack.py" --sums . >SHA256SUMS && cat SHA256SUMS)
say "a release is in ${OUT#"$PWD"/}"
