"""Exported FMUs on each platform of which this machine has a stand-in.

The libraries of `make runtimes` go into FMUs of a few mechanisms, of both versions of FMI. The C
hosts of the tests run them on Linux, as Windows programs under Wine, and as ARM programs under
QEMU; FMPy runs them in Linux's Python and in a Python for Windows under Wine. All get the same
requests: motions, a dead point, calls to be refused, all rounding modes; events, intermediate
update and early return in FMI 3.0. The statuses and the messages must be the same, the numbers to
the last few bits. The program for Windows is used under Wine. Libraries for macOS are inspected.
Results go into docs/platforms.md, with what was not tried for want of a library or a wheel.

    .venv/bin/python tests/platforms/run.py [--no-docs]
"""

from __future__ import annotations

import json
import re
import sys

from common import HERE, LIBRARIES, FOLDER, ROOT, Difference, Failure, environment, expect, run
from hosts import (
    ARM, LINUX, MECHANISMS, OLD_LIBRARIES, PROGRAM, SCENARIOS, WINDOWS, Fmu, compare, export, old_linux,
)  # fmt: skip
from libraries import inspect, loading_time
from wine import use_program, windows_program, windows_python, wine_prefix

PAGE = ROOT / "docs" / "platforms.md"
PLATFORMS = ("linux64", "win64", "darwin64", "aarch64-linux", "aarch64-darwin")


def fmpy(fmus, command, root=""):
    """Simulates all FMUs in FMPy; their results by name."""
    results = [fmu.archive.with_suffix(".json") for fmu in fmus]
    for result in results:
        result.unlink(missing_ok=True)
    # Pipes on all three: Python under Wine ends without.
    run(*command, f"{root}{HERE}/simulate.py", *(f"{root}{f.archive}" for f in fmus), input="", env=environment())
    return {f.name: json.loads(r.read_text(encoding="utf-8")) for f, r in zip(fmus, results, strict=True)}


def compare_fmpy(ours, reference, difference):
    for name, result in ours.items():
        expected = reference[name]
        expect(result["problems"] == expected["problems"] == [], f"{name}: FMPy finds {result['problems']}")
        expect(result["names"] == expected["names"], f"{name}: other variables")
        difference.add(result["rows"], expected["rows"])
        difference.check(name)


# ---------------------------------------------------------------------------------------------
# The page


def write_page(libraries, runs, missing):
    """Puts the tables in the page, between their marks, and what was not tried."""
    row = lambda cells: f"| {' | '.join(cells)} |"  # noqa: E731
    page = PAGE.read_text(encoding="utf-8")
    parts = {
        "libraries": ["| library | size | needs |", "|---|---|---|", *map(row, libraries)],
        "runs": ["| host | FMI | FMUs | numbers, beside C host on Linux |", "|---|---|---|---|", *map(row, runs)],
        "missing": [f"Not tried in this run: {'; '.join(missing)}."] if missing else [],
    }
    for name, lines in parts.items():
        mark = re.compile(rf"(<!-- {name} -->\n).*?(<!-- end -->)", re.S)
        expect(mark.search(page), f"{PAGE} has no marks for {name}")
        text = "".join(line + "\n" for line in lines)
        page = mark.sub(lambda found, text=text: f"{found[1]}{text}{found[2]}", page)
    PAGE.write_text(page, encoding="utf-8")
    print(f"wrote {PAGE.relative_to(ROOT)}")


def main():
    FOLDER.mkdir(parents=True, exist_ok=True)
    libraries, runs, missing = [], [], []
    for library in sorted(LIBRARIES.glob("*/biela.*")):
        libraries.append((f"`{library.relative_to(LIBRARIES)}`", *inspect(library)))
        print("inspected", *libraries[-1], flush=True)
    built = {library.parent.name for library in LIBRARIES.glob("*/biela.*")}
    expect("linux64" in built, "there are no libraries: run `make runtimes` first")
    missing += [f"the library `{name}`, which was not built" for name in PLATFORMS if name not in built]
    print(f"loading takes {loading_time(LIBRARIES / 'linux64/biela.so'):.2f} ms", flush=True)
    fmus = {2: [export(name) for name in MECHANISMS]}
    fmus[3] = [export(name, 3) for name in dict.fromkeys((*MECHANISMS, *(s[0] for s in SCENARIOS)))]

    def record(host, fmus, result):
        names = ", ".join(dict.fromkeys(fmu.name for fmu in fmus))
        runs.append((host, f"{fmus[0].version}.0", names, str(result)))
        print(*runs[-1], sep=" | ", flush=True)

    # In the C hosts.
    systems = [LINUX]
    if OLD_LIBRARIES.is_dir():
        systems.append(old_linux())
    else:
        missing.append("an older C library, which is not at hand")
    if "aarch64-linux" in built:
        systems.append(ARM)
    if "win64" in built:
        wine_prefix()
        systems.append(WINDOWS)
    reference = {}
    for system in systems:
        for version, results in ((2, system.runs_2(fmus[2])), (3, system.runs_3(fmus[3]))):
            used = [fmu for fmu in fmus[version] if version == 2 or fmu.name in {s[0] for s in SCENARIOS}]
            if system is LINUX:
                reference[version] = results
                record(f"C host, {system.name}", used, "the reference")
            else:
                record(f"C host, {system.name}", used, compare(system, results, reference[version]))

    # In FMPy.
    def record_fmpy(host, fmus):
        difference = Difference()
        compare_fmpy(fmpy(fmus, python, "Z:"), fmpy(fmus, [sys.executable]), difference)
        record(host, fmus, f"beside FMPy on Linux: {difference}")

    if "win64" in built:
        python = ["wine", windows_python()]
        for version in (2, 3):
            record_fmpy("FMPy in Python for Windows (Wine)", fmus[version])
        program = windows_program(python[1])
        if program:
            ours, expected, archive = use_program(program, [PROGRAM])
            difference = Difference()
            difference.add(ours, expected)
            difference.check("the wheel's `run`")
            exported = [Fmu("first", 2, archive)]
            record("`python -m biela run` of the wheel for Windows (Wine)", exported, f"beside `biela run` on Linux: {difference}")
            record_fmpy("its export, in FMPy for Windows (Wine)", exported)
        else:
            missing.append("the program for Windows, of which there is no wheel")
    for what in missing:
        print(f"not tried: {what}", flush=True)
    if "--no-docs" not in sys.argv:
        write_page(libraries, runs, missing)


if __name__ == "__main__":
    try:
        main()
    except Failure as failure:
        sys.exit(f"failed: {failure}")
