# Shared by the scripts in this folder, which source it from the project's root.
# shellcheck shell=bash disable=SC2034

VENV_PYTHON=.venv/bin/python
LOCK=tests/fmpy/requirements.txt

# Settings of the caller's that would send packages elsewhere than told, or let foreign ones in.
# Mirrors, proxies and certificates (PIP_INDEX_URL and the like) stay in force.
unset PYTHONPATH PYTHONHOME PIP_TARGET PIP_PREFIX PIP_ROOT PIP_PYTHON PIP_DRY_RUN
export PIP_USER=0 PIP_REQUIRE_VIRTUALENV=0
export PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_ROOT_USER_ACTION=ignore PIP_NO_INPUT=1

say() { printf 'set-up: %s\n' "$*"; }

# fail WHAT [REMEDY]...
fail() {
    printf 'set-up failed: %s\n' "$1" >&2
    shift
    [ $# -eq 0 ] || printf '  %s\n' "$@" >&2
    exit 1
}

has() { command -v "$1" >/dev/null 2>&1; }

# Prints the linker lld, of rustup's toolchain or of the system, nothing if there is none.
lld_program() {
    local lld
    lld=$(rustc --print sysroot)/lib/rustlib/$(rustc -vV | sed -n 's/^host: //p')/bin/rust-lld
    if [ -x "$lld" ]; then echo "$lld"; else command -v rust-lld || command -v lld || true; fi
}

# Whether packages of Debian can be installed here.
can_apt() { has apt-get && [ "$(id -u)" = 0 ]; }

# Installs packages of Debian that are not there. A failure shows the words of apt-get.
apt_install() { # PACKAGE...
    local words status=0
    dpkg -s "$@" >/dev/null 2>&1 && return
    say "installing $*"
    words=$({ apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=600 \
        install -y -qq --no-install-recommends "$@"; } 2>&1) || status=$?
    [ "$status" = 0 ] || printf '%s\n' "$words" | tail -n 5 | sed 's/^/  apt-get: /' >&2
    return "$status"
}

# Prints a digest of the sources in files and folders.
digest_of() { # PATH...
    find "$@" -type f ! -name '*.md' -print0 | LC_ALL=C sort -z | xargs -0 cat |
        if has sha256sum; then sha256sum; else shasum -a 256; fi
}
