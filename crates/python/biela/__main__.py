"""Runs the program: `python -m biela`."""

from __future__ import annotations

import signal
import sys

from . import _biela


def main() -> int:
    """Runs the program with the arguments of this process; returns its exit status."""
    # Ctrl-C ends the program at once; Python would wait for it to return.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _biela.program(["biela", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
