#!/usr/bin/env bash
# Installs biela in empty environments and uses it there, without cargo on the PATH: the wheel of this
# machine with pip, and its archive of `make dist`; and the sources with `cargo install`, without what
# `make setup` makes. Under Wine it uses the archive for Windows, where both are there with a compiler
# for Windows.
#
#   scripts/test_install.sh [pip archive cargo]...
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

# Checks that the files of a release are those of their checksums, and prints the archive of a name.
archive() { # NAME
    (cd target/dist && python3 ../../scripts/pack.py --sums . | cmp -s - SHA256SUMS) ||
        fail "target/dist is not what SHA256SUMS lists" "Run \`make dist\` first."
    find target/dist -name "biela-*-$1"
}

test_archive() {
    local archive system
    case "$(uname -s)" in Darwin) system=macos ;; *) system=linux ;; esac
    archive=$(archive "$system-$(uname -m).tar.gz")
    mkdir "$WORK/archive"
    tar xzf "$archive" -C "$WORK/archive" --strip-components 1
    use "$WORK/archive/bin"
    [ -f "$WORK/archive/share/biela/docs/README.md" ] || fail "$archive has no documentation"
    (cd "$WORK/use" && "$WORK/archive/bin/biela" page first.toml)
    say "archive: $(basename "$archive") works"
    archive=$(archive windows-x86_64.zip)
    if [ -n "$archive" ] && has wine && has x86_64-w64-mingw32-gcc; then
        python3 -m zipfile -e "$archive" "$WORK/windows"
        # As `make test-platforms` has it, with the library of Windows 10 that Wine lacks.
        "$VENV_PYTHON" -c "import sys; sys.path.insert(0, 'tests/platforms'); import wine; wine.wine_prefix()"
        export WINEPREFIX=$PWD/target/platforms/wine WINEDEBUG=-all
        (
            cd "$WORK/windows"/*/
            wine bin/biela.exe new first --from four_bar
            wine bin/biela.exe export first.toml
            cmp first.fmu "$WORK/use/first.fmu"
        )
        say "archive: $(basename "$archive") writes the same FMU under Wine"
    fi
}

test_cargo() {
    # No settings of the checkout's, no Python, no libclang: a clean copy of the sources.
    git archive --prefix=biela/ HEAD | tar x -C "$WORK"
    (
        cd "$WORK/biela"
        env -i HOME="$HOME" PATH="$(dirname "$(command -v cargo)"):/usr/bin:/bin" \
            cargo install --quiet --locked --path crates/tools --root "$WORK/cargo"
    )
    use "$WORK/cargo/bin"
    say "cargo: the program works"
}

if [ $# -eq 0 ]; then
    set -- pip archive cargo
fi
for way in "$@"; do
    "test_$way"
done
