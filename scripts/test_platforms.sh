#!/usr/bin/env bash
# Runs the tests of other platforms, with the tools that they need: Wine, QEMU and C compilers.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/lib.sh
. scripts/lib.sh
# shellcheck source=scripts/cross.sh
. scripts/cross.sh

if has apt-get && [ "$(id -u)" = 0 ]; then
    apt_install wine wine64 qemu-user-static gcc-mingw-w64-x86-64-win32 gcc-aarch64-linux-gnu \
        libc6-dev-arm64-cross llvm-14
fi
for tool in wine qemu-aarch64-static x86_64-w64-mingw32-gcc aarch64-linux-gnu-gcc; do
    has "$tool" || fail "no $tool" "Install wine, qemu-user-static, mingw-w64 and gcc-aarch64-linux-gnu."
done
exec "$VENV_PYTHON" tests/platforms/run.py "$@"
