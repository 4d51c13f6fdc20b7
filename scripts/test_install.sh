#!/usr/bin/env bash
# Installs biela in empty environments and uses it there: the wheel of this machine with pip, without
# cargo on the PATH, and the sources with `cargo install`, without what `make setup` makes.
#
#   scripts/test_install.sh [pip cargo]...
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/lib.sh
. scripts/lib.sh

WORK=$(mktemp -d)
trap 'rm -rf "$WORK"' EXIT

# Checks, runs and exports a new mechanism with a program, in a folder with nothing else, and
# simulates the FMU in FMPy.
use() { # FOLDER_OF_PROGRAM
    local folder=$WORK/use python=$PWD/$VENV_PYTHON
    rm -rf "$folder"
    mkdir "$folder"
    (
        cd "$folder"
        # Nothing else, least of all cargo.
        export PATH=$1
        biela new first --from four_bar
        biela check first.toml >/dev/null
        biela run first.toml --drive 'crank_angle = 60*deg + 2*pi*t' --stop 1 --output first.csv --plot first.svg
        biela platforms
        biela export first.toml
        "$python" -c "
import fmpy.validation
problems = fmpy.validation.validate_fmu('first.fmu')
result = fmpy.simulate_fmu('first.fmu', stop_time=0.1, output=['rocker.phi'])
assert not problems and abs(result['rocker.phi'][-1] - 2.1436968092) < 1e-6, (problems, result[-1])
print('FMPy runs it on', fmpy.platform, 'of', fmpy.supported_platforms('first.fmu'))"
    )
}

test_pip() {
    local machine wheel
    machine=$(uname -m)
    wheel=$(ls -t target/wheels/biela-*manylinux*"$machine".whl | head -1)
    python3 -m venv "$WORK/venv"
    # The program needs no other package, the module NumPy.
    "$WORK/venv/bin/pip" install --quiet --no-index --no-deps "$wheel"
    use "$WORK/venv/bin"
    "$WORK/venv/bin/python" -m biela --version
    "$WORK/venv/bin/pip" install --quiet numpy
    (cd "$WORK/use" && "$WORK/venv/bin/python" -c "
import biela
result = biela.load('first.toml').run(t=[0, 0.1], drive={'crank_angle': '60*deg + 2*pi*t'})
assert abs(result['rocker.phi'][0] - 2.1436968092) < 1e-10, result
print('the module runs it')")
    say "pip: $(basename "$wheel") works"
}

test_cargo() {
    # No settings of the checkout's, no Python, no libclang: a clean copy of the sources.
    git archive --prefix=biela/ HEAD | tar x -C "$WORK"
    (
        cd "$WORK/biela"
        env -i HOME="$HOME" PATH="$(dirname "$(command -v cargo)"):/usr/bin:/bin" \
            cargo install --quiet --locked --path . --root "$WORK/cargo"
    )
    use "$WORK/cargo/bin"
    say "cargo: the program works"
}

if [ $# -eq 0 ]; then
    set -- pip cargo
fi
for way in "$@"; do
    "test_$way"
done
