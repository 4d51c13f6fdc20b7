#!/usr/bin/env bash
# Gives a clean clone what Rust, Python 3 and a C compiler leave open, without root:
#   .venv/               the packages of tests/fmpy/requirements.txt, each checked by its hash
#   .cargo/config.toml   where cargo finds libclang, the FMI headers and that Python
# Quick, and without network, when both are up to date.
#
# BIELA_PYTHON=/path/to/python3 chooses the Python to build on; CC the C compiler.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/lib.sh
. scripts/lib.sh

# Cargo hands BIELA_PYTHON on to what it runs, where it names the environment made here.
case ${BIELA_PYTHON:-} in */.venv/bin/python*) unset BIELA_PYTHON ;; esac

STAMP=.venv/.up-to-date
# The last uv that the Rust of its time (1.95) builds.
UV_CRATE=uv@0.12.5

# What an environment is made from; prints nothing if that Python does not run.
fingerprint() { # PYTHON
    "$1" - "$LOCK" 2>/dev/null <<'PY'
import hashlib, os, sys
lock = hashlib.sha256(open(sys.argv[1], "rb").read()).hexdigest()
print(lock, "python", ".".join(map(str, sys.version_info[:3])), os.path.realpath(sys.base_prefix))
PY
}

environment_is_current() {
    [ -f "$STAMP" ] || return 1
    local now
    now=$(fingerprint "$VENV_PYTHON") || return 1
    [ "$now" = "$(cat "$STAMP")" ] || return 1
    # Another Python asked for than the one in use?
    [ -z "${BIELA_PYTHON:-}" ] || [ "$(fingerprint "$BIELA_PYTHON")" = "$now" ]
}

# Prints the real path of PYTHON (which may be a shim) if its version will do.
usable_python() { # PYTHON
    "$1" -c '
import sys
if not (3, 10) <= sys.version_info[:2] <= (3, 14): sys.exit(1)
import venv
print(sys.executable)' 2>/dev/null
}

choose_python() {
    local name tried=''
    if [ -n "${BIELA_PYTHON:-}" ]; then
        BASE_PYTHON=$(usable_python "$BIELA_PYTHON") && return
        fail "BIELA_PYTHON=$BIELA_PYTHON is no Python 3.10 to 3.14 with the module venv" \
            "Set it to one that is, or unset it to have one looked for."
    fi
    for name in python3 python3.13 python3.12 python3.11 python3.10 python3.14 python; do
        has "$name" || continue
        BASE_PYTHON=$(usable_python "$name") && return
        tried="$tried $name ($("$name" -V 2>&1 | head -n 1))"
    done
    fail "no Python 3.10 to 3.14 on PATH; found:${tried:- none}" \
        "Install one, or name it: make setup BIELA_PYTHON=/path/to/python3"
}

# The lock's entry for pip alone, for the tools that have to bring pip first.
pip_requirement() {
    awk '/^[^ #]/ { mine = /^pip==/ } mine && !/#/' "$LOCK" >.tools/pip.txt
}

uv_installs_pip() { # UV
    "$1" pip install --quiet --no-config --no-deps --require-hashes \
        --python "$VENV_PYTHON" -r .tools/pip.txt
}

# Any pip of any Python 3 will do: --target puts pip's files where the environment looks,
# however old that pip is, and leaves the system's Python alone.
found_pip_installs_pip() { # PIP...
    "$@" --version >/dev/null 2>&1 || return 1
    say "bringing pip into .venv with \`$*\`"
    local site
    site=$("$VENV_PYTHON" -c 'import sysconfig; print(sysconfig.get_path("purelib"))') &&
        "$@" install --quiet --no-deps --require-hashes --target "$site" -r .tools/pip.txt
}

cargo_builds_uv() {
    [ -x .tools/bin/uv ] && return
    has cargo || return 1
    say "found neither ensurepip nor pip nor uv: building the crate uv with cargo instead"
    say "(once; 5 to 20 minutes; a package python3-venv or python3-pip would spare it)"
    # Built for a quick build: it has only one package to install.
    CARGO_TARGET_DIR=.tools/uv-build \
        CARGO_PROFILE_RELEASE_OPT_LEVEL=1 CARGO_PROFILE_RELEASE_LTO=off \
        CARGO_PROFILE_RELEASE_CODEGEN_UNITS=16 CARGO_PROFILE_RELEASE_DEBUG=0 \
        cargo install --quiet --locked --no-default-features --root .tools "$UV_CRATE" || return 1
    rm -rf .tools/uv-build
}

make_environment() {
    local version
    version=$("$BASE_PYTHON" -c 'import platform; print(platform.python_version())')
    say "making .venv with Python $version ($BASE_PYTHON)"
    rm -rf .venv
    # Debian leaves ensurepip to another package; then this fails and pip comes another way.
    if "$BASE_PYTHON" -m venv .venv >/dev/null 2>&1 &&
        "$VENV_PYTHON" -m pip --version >/dev/null 2>&1; then
        return
    fi
    rm -rf .venv
    "$BASE_PYTHON" -m venv --without-pip .venv ||
        fail "$BASE_PYTHON cannot make a virtual environment" \
            "Name another Python: make setup BIELA_PYTHON=/path/to/python3"
    mkdir -p .tools
    pip_requirement
    found_pip_installs_pip "$BASE_PYTHON" -m pip && return
    found_pip_installs_pip pip3 && return
    found_pip_installs_pip pip && return
    if has uv; then
        say "bringing pip into .venv with \`uv\`"
        uv_installs_pip uv && return
    fi
    if cargo_builds_uv; then
        say "bringing pip into .venv with the uv just built"
        uv_installs_pip .tools/bin/uv && return
    fi
    fail "no way was found to bring pip into .venv (see the messages above)" \
        "Check the network, or install pip, Debian's python3-venv, or uv; then try again."
}

install_packages() {
    say "installing the packages of $LOCK (550 MB on disk)"
    # Wheels only: a Python without wheels fails here at once, not in an hour of compiling.
    "$VENV_PYTHON" -m pip install --quiet --only-binary :all: --require-hashes -r "$LOCK" ||
        fail "the packages of $LOCK could not be installed (see pip's message above)" \
            "Check the network and the proxy, then try again." \
            "If it finds no matching distribution, choose another Python: BIELA_PYTHON=/path/to/python3"
}

read -r compiler _ <<<"${CC:-cc}"
has "$compiler" || fail "no C compiler ($compiler)" "Install gcc or clang, or set CC."
has cargo || fail "no cargo on PATH" "Install Rust (rustup, or the system's packages)."
[ -f "$LOCK" ] || fail "$LOCK is missing" "Restore it from git."

changed=
if ! environment_is_current; then
    choose_python
    make_environment
    install_packages
    # Last, so that an interrupted set-up starts again.
    fingerprint "$VENV_PYTHON" >"$STAMP.new" && mv "$STAMP.new" "$STAMP"
    changed=1
fi
# Every time, as the compiler may have moved; it touches the file only if its content changes.
written=$("$VENV_PYTHON" scripts/cargo_config.py) || exit 1
[ -z "$written" ] || say "$written"
# The tests of pages are skipped where there is no browser. A machine of CI's own gets one.
if [ "${CI:-}" = true ] && [ "$(id -u)" = 0 ] && has apt-get && ! has chromium && ! has google-chrome; then
    say "installing Chromium for the tests of pages"
    { apt-get update -qq && apt-get install -y -qq --no-install-recommends chromium; } >/dev/null ||
        say "Chromium could not be installed: the tests of pages are skipped"
    changed=1
fi
[ -n "$changed$written" ] || say "up to date"
