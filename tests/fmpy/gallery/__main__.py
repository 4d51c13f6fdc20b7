"""Prints the gallery's table in Markdown: mechanism, truth, largest errors.

Run in `tests/fmpy`: `python -m gallery [NAME …]`. `BIELA_BIN` names the program.
Exit status 1 if something is not as it should be; it is told on stderr.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from harness import Fmu, export, mechanism_file

from . import cases
from .runner import run, table


def main() -> int:
    """The table of all cases, or of those named."""
    known = cases()
    if unknown := set(sys.argv[1:]) - set(known):
        print(f"no case for {', '.join(sorted(unknown))}", file=sys.stderr)
        return 2
    rows = []
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        for name in sys.argv[1:] or known:
            path = export(mechanism_file(name), folder / f"{name}.fmu")
            rows.append(run(name, known[name], Fmu.unpack(path, folder / name)))
    print(table(rows))
    failures = [f"{row.name}: {failure}" for row in rows for failure in row.failures]
    print(*failures, sep="\n", end="\n" * bool(failures), file=sys.stderr)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
