"""Prints the gallery's table in Markdown: mechanism, truth, largest errors.

Run in `tests/fmpy`: `python -m gallery [NAME …]`, or `python -m gallery --page` to write the page
`mechanisms/README.md` with its pictures as well. `BIELA_BIN` names the program. Exit status 1 if
something is not as it should be; it is told on stderr, and no page is written.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

from harness import Fmu, export, mechanism_file

from . import cases, page
from .runner import run, table


def main() -> int:
    """The table of all cases, or of those named."""
    known = cases()
    parser = argparse.ArgumentParser(prog="python -m gallery", description=__doc__.splitlines()[0])
    chosen = parser.add_mutually_exclusive_group()
    chosen.add_argument("names", nargs="*", default=[], metavar="NAME", help="mechanisms [all]")
    chosen.add_argument("--page", action="store_true", help="write mechanisms/README.md")
    arguments = parser.parse_args()
    if unknown := set(arguments.names) - set(known):
        print(f"no case for {', '.join(sorted(unknown))}", file=sys.stderr)
        return 2
    rows = []
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        for name in arguments.names or known:
            path = export(mechanism_file(name), folder / f"{name}.fmu")
            rows.append(run(name, known[name], Fmu.unpack(path, folder / name)))
    print(table(rows))
    failures = [f"{row.name}: {failure}" for row in rows for failure in row.failures]
    print(*failures, sep="\n", end="\n" * bool(failures), file=sys.stderr)
    if arguments.page and not failures:
        page.write(rows)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
