#!/usr/bin/env bash
# Runs some tests of the scripts in pages and in the studio: the check of their types, those in tests/studio
# that need node, and those in a browser that are marked `smoke`, with the program of `make build`. The last
# lines say what was left out because something is missing here; `make check-scripts`, `make test-page` and
# `make test-studio` get it and run all of them.
#
# One solver, the studio's, serves the pages too: it answers all that they ask. It is the one of
# `make studio` if that is up to date, otherwise one that is built faster.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/lib.sh
. scripts/lib.sh

OUT=target/smoke
left_out=()
leave_out() { left_out+=("left out: $1"); }

# Gets what the solver is built with, if it may be had: rustup's is in the user's folder, Debian's packages
# are for machines of CI.
get_target() {
    [ -d "$(rustc --print target-libdir --target wasm32-unknown-unknown)" ] ||
        { has rustup && rustup target add wasm32-unknown-unknown; } ||
        { [ "${CI:-}" = true ] && can_apt && apt_install rustc-web cargo-web rust-web-src lld; }
}

if has node; then
    node --test tests/studio
else
    leave_out 'completion in mechanism files (no node on PATH)'
fi

npx=(npx --offline --yes --package "$TYPESCRIPT")
if has npx && "${npx[@]}" tsc --version >/dev/null 2>&1; then
    "${npx[@]}" tsc --project crates/page/tsconfig.json
else
    leave_out "types of the scripts (npx has no $TYPESCRIPT here)"
fi

browser=$(cd tests/fmpy && "../../$VENV_PYTHON" -c 'import browsing; print(browsing.find_browser() or "")')
if [ -z "$browser" ]; then
    leave_out 'pages and the studio in a browser (no Chromium or Chrome on PATH)'
elif ! get_target; then
    leave_out 'pages and the studio in a browser (no Rust for wasm32-unknown-unknown: see `make page`)'
else
    solver=$(bash scripts/page.sh studio --current)
    if [ -z "$solver" ]; then
        bash scripts/page.sh studio --smoke
        solver=$OUT/studio.wasm
    fi
    tests=(tests/page)
    if "$VENV_PYTHON" -m pip install --quiet --require-hashes -r tests/studio/requirements.txt; then
        tests+=(tests/studio)
        "$BIELA_BIN" studio --solver "$solver" --write $OUT/studio
    else
        leave_out 'the studio in a browser (Playwright cannot be installed)'
    fi
    BIELA_PAGE_SOLVER=$solver BIELA_STUDIO=$OUT/studio "$VENV_PYTHON" -m pytest -m smoke "${tests[@]}"
fi

[ ${#left_out[@]} = 0 ] || printf '%s\n' "${left_out[@]}"
