#!/usr/bin/env bash
# Runs the tests of other platforms, with the tools that they need: Wine, QEMU and C compilers.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/lib.sh
. scripts/lib.sh
# shellcheck source=scripts/cross.sh
. scripts/cross.sh

# The C library of an older system, to load the libraries with. Packages of Debian 11 come from
# where those of this Debian do.
old_library() { # FOLDER
    local folder=$1 apt
    [ ! -d "$folder/lib" ] || return 0
    rm -rf "$folder"
    mkdir -p "$folder/lists/partial" "$folder/cache/archives/partial"
    echo "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg]" \
        "$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' | head -n 1) bullseye main" >"$folder/sources.list"
    apt=(apt-get -o "Dir::Etc::sourcelist=$folder/sources.list" -o Dir::Etc::sourceparts=/dev/null
        -o "Dir::State::lists=$folder/lists" -o "Dir::Cache=$folder/cache" -o Dir::State::status=/dev/null
        -o APT::Sandbox::User=root)
    { "${apt[@]}" update -qq && (cd "$folder" && "${apt[@]}" download -qq libc6/bullseye); } >/dev/null 2>&1 ||
        { say "Debian 11 is not to be had: its C library is not tried" && rm -rf "$folder" && return; }
    dpkg -x "$folder"/libc6_*.deb "$folder"
    rm -rf "$folder"/{lists,cache}
}

if can_apt; then
    apt_install wine wine64 qemu-user-static gcc-mingw-w64-x86-64-win32 gcc-aarch64-linux-gnu \
        libc6-dev-arm64-cross "$LLVM_PACKAGE" || true
    old_library "$PWD/target/platforms/debian-11"
fi
for tool in wine qemu-aarch64-static x86_64-w64-mingw32-gcc aarch64-linux-gnu-gcc; do
    has "$tool" || fail "no $tool" "Install wine, qemu-user-static, mingw-w64 and gcc-aarch64-linux-gnu."
done
exec "$VENV_PYTHON" tests/platforms/run.py "$@"
