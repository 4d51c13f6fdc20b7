#!/usr/bin/env bash
# Refreshes the requirements.txt of tests/fmpy, tests/studio and scripts/site, each from the
# requirements.in beside it: newest versions, every hash, for every system and Python from 3.10 on.
# Needs the network, and .venv.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/lib.sh
. scripts/lib.sh

uv=uv
if ! has uv; then
    uv=.tools/uv/bin/uv
    if [ ! -x "$uv" ]; then
        say "installing uv into .tools"
        "$VENV_PYTHON" -m pip install --quiet --target .tools/uv uv ||
            fail "uv could not be installed (see pip's message above)" "Check the network."
    fi
fi

for lock in "$LOCK" tests/studio/requirements.txt scripts/site/requirements.txt; do
    new=$lock.new
    trap 'rm -f "$new"' EXIT
    {
        echo "# Locked from requirements.in for Python 3.10 and newer on every system; refresh it with: make lock"
        "$uv" pip compile --quiet --no-config --upgrade --universal --python-version 3.10 \
            --generate-hashes --no-emit-index-url --no-header "${lock%.txt}.in"
    } >"$new"
    mv "$new" "$lock"
    say "wrote $lock"
done
