"""Exported FMUs on each platform of which this machine has a stand-in.

The libraries of `make runtimes` go into FMUs of a few mechanisms. The C host of the tests runs
them on Linux, as a Windows program under Wine, and as an ARM program under QEMU; FMPy runs them in
Linux's Python and in a Python for Windows under Wine. All get the same requests: motions, a dead
point, calls to be refused; the statuses and the messages must be the same, the numbers to the last
few bits. The program for Windows is used under Wine. Libraries for macOS are inspected. Results go
into docs/platforms.md, with what was not tried for want of a library or a wheel.

    .venv/bin/python tests/platforms/run.py [--no-docs]
"""

from __future__ import annotations

import json
import math
import os
import re
import shutil
import subprocess
import sys
import urllib.parse
import zipfile
from dataclasses import dataclass, field
from pathlib import Path

from common import FOLDER, HERE, LIBRARIES, ROOT, WORK, Difference, Failure, environment, expect, headers, run
from fmpy import read_model_description
from libraries import inspect, loading_time
from wine import use_program, windows_program, windows_python, wine_prefix

PAGE = ROOT / "docs" / "platforms.md"
PROGRAM = Path(os.environ.get("BIELA_BIN", ROOT / "target/release/biela"))
# The C library of Debian 11, where scripts/test_platforms.sh could get it.
OLD_SYSTEM = WORK / "debian-11"

PLATFORMS = ("linux64", "win64", "darwin64", "aarch64-linux", "aarch64-darwin")
MECHANISMS = ("four_bar", "cam_roller", "platform_3rpr", "tlv")
STEPS, SIZE = 200, 0.005


# ---------------------------------------------------------------------------------------------
# FMUs and requests


@dataclass
class Fmu:
    """An exported FMU, unpacked, with the requests that its instance gets."""

    name: str
    archive: Path
    folder: Path
    guid: str
    inputs: list = field(default_factory=list)
    outputs: list = field(default_factory=list)

    def requests(self, uri):
        """The requests to the C host; the last one of a motion is met at a dead point."""
        numbers = lambda values: ",".join(map(repr, values))  # noqa: E731
        inputs = numbers(vr for vr, _ in self.inputs)
        yield "Instantiate", 0, "instance", self.guid, uri, 1, 1, "full"
        yield "SetupExperiment", 0, 0.0, r"\N"
        yield "EnterInitializationMode", 0
        yield "ExitInitializationMode", 0
        for step in range(STEPS):
            t = step * SIZE
            yield "SetReal", 0, len(self.inputs), inputs, numbers(self.values(t))
            yield "DoStep", 0, repr(t), repr(SIZE), 1
            for k in range(0, len(self.outputs), 128):
                some = self.outputs[k : k + 128]
                yield "GetReal", 0, len(some), numbers(some), ""
        # Calls to be refused: an unknown variable, no number, a step back.
        yield "GetReal", 0, 1, "99999", ""
        yield "SetReal", 0, 1, inputs.split(",")[0], "nan"
        yield "DoStep", 0, repr(STEPS * SIZE), "-0.1", 1
        # Far beyond a dead point, where there is one.
        yield "SetReal", 0, 1, inputs.split(",")[0], "0.9"
        yield "DoStep", 0, repr(STEPS * SIZE), repr(SIZE), 1
        yield "GetReal", 0, min(128, len(self.outputs)), numbers(self.outputs[:128]), ""
        yield "GetRealStatus", 0, 2, "room"

    def values(self, t):
        """The inputs at a time: around their starts, by as much as each mechanism can take."""
        width = {"four_bar": 2 * math.pi, "cam_roller": 2 * math.pi}.get(self.name, 0.03)
        return [start + width * math.sin(2.0 * t + k) * min(1.0, t) for k, (_, start) in enumerate(self.inputs)]


def export(name):
    archive = FOLDER / f"{name}.fmu"
    run(PROGRAM, "export", ROOT / f"mechanisms/{name}.toml", "-o", archive, "--runtime", LIBRARIES)
    folder = FOLDER / name
    shutil.rmtree(folder, ignore_errors=True)
    with zipfile.ZipFile(archive) as content:
        content.extractall(folder)
    description = read_model_description(str(archive))
    fmu = Fmu(name, archive, folder, description.guid)
    for variable in description.modelVariables:
        if variable.causality == "input" and variable.name.endswith(".position"):
            fmu.inputs.append((variable.valueReference, float(variable.start)))
        elif variable.causality == "output":
            fmu.outputs.append(variable.valueReference)
    return fmu


def answers(fmu, command, library, uri):
    """Returns the answers of a C host, one list of fields per line."""
    lines = "".join("\t".join(map(str, request)) + "\n" for request in fmu.requests(uri))
    done = subprocess.run([*map(str, command), str(library)], input=lines.encode(), capture_output=True, env=environment())
    text = done.stdout.decode("utf-8")
    expect(done.returncode == 0, f"{fmu.name}: the host ends with {done.returncode}: {done.stderr.decode(errors='replace')}")
    expect(not done.stderr.strip(), f"{fmu.name}: something is written to stderr: {done.stderr[:500]}")
    return [line.rstrip("\r").split("\t") for line in text.split("\n") if line.strip()]


def split(lines):
    """Texts of a run, and its numbers as tables of one width each."""
    texts, tables = [], {}
    for fields in lines:
        if fields[0] == "answer" and len(fields) > 10:
            texts.append(fields[:2])
            tables.setdefault(len(fields), []).append([float(value) for value in fields[2:]])
        elif fields[4:5] != ["logSolver"]:
            # The solver's details tell residuals, which are rounding.
            texts.append(fields)
    return texts, tables


def compare(name, ours, reference, difference):
    (texts, tables), (expected, expected_tables) = split(ours), split(reference)
    for text, other in zip(texts, expected, strict=True):
        expect(text == other, f"{name}: {text} instead of {other}")
    for width, table in tables.items():
        difference.add(table, expected_tables[width])
    difference.check(name)


# ---------------------------------------------------------------------------------------------
# Platforms


def compile_host(compiler, output, *more):
    sources = [ROOT / "tests/host.c", *(m for m in more if str(m).endswith(".c"))]
    flags = [m for m in more if not str(m).endswith(".c")]
    run(compiler, "-std=c11", "-O2", "-pthread", f"-I{headers()}", *sources, "-o", WORK / output, *flags)
    return WORK / output


def file_uri(path, root="/"):
    return f"file://{root}" + urllib.parse.quote(str(path).lstrip("/"))


def in_host(fmus, command, library, root="/"):
    """Returns the answers of a C host to all FMUs by name; `library` is PLATFORM.EXTENSION."""
    platform, extension = library.split(".")
    results = {}
    for f in fmus:
        path = f"{root.strip('/')}{f.folder}/binaries/{platform}/{f.name}.{extension}"
        results[f.name] = answers(f, command, path, file_uri(f.folder / "resources", root))
    return results


def linux(fmus):
    host = compile_host("cc", "host-linux", "-ldl")
    return in_host(fmus, [host], "linux64.so")


def old_linux(fmus):
    """Under the C library of an older system, in OLD_SYSTEM; its version too."""
    libraries = OLD_SYSTEM / "lib/x86_64-linux-gnu"
    loader = next(libraries.glob("ld-2.*.so"))
    zig = ROOT / ".tools/cross/bin/python-zig"
    flags = ["-target", "x86_64-linux-gnu.2.17", "-std=c11", "-O2", "-pthread", f"-I{headers()}", "-ldl"]
    run(zig, "cc", *flags, ROOT / "tests/host.c", "-o", WORK / "host-old")
    host = [loader, "--library-path", libraries, WORK / "host-old"]
    results = in_host(fmus, host, "linux64.so")
    return results, loader.stem.removeprefix("ld-")


def windows(fmus):
    folder = HERE / "windows"
    host = compile_host(
        "x86_64-w64-mingw32-gcc", "host.exe", folder / "wmain.c", f"-I{folder}", "-municode", "-static", "-Dmain=host_main",
        "-D__USE_MINGW_ANSI_STDIO=1",
    )  # fmt: skip
    wine_prefix()
    return in_host(fmus, ["wine", host], "win64.dll", "/Z:/")


def arm(fmus):
    host = compile_host("aarch64-linux-gnu-gcc", "host-aarch64", "-ldl")
    qemu = ["qemu-aarch64-static", "-L", "/usr/aarch64-linux-gnu", host]
    return in_host(fmus, qemu, "aarch64-linux.so")


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
    page = PAGE.read_text(encoding="utf-8")
    parts = {
        "libraries": ["| library | size | needs |", "|---|---|---|", *(f"| `{n}` | {s} | {w} |" for n, s, w in libraries)],
        "runs": ["| host | FMUs | numbers, beside C host on Linux |", "|---|---|---|", *(f"| {h} | {f} | {d} |" for h, f, d in runs)],
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
        libraries.append((str(library.relative_to(LIBRARIES)), *inspect(library)))
        print("inspected", *libraries[-1], flush=True)
    built = {library.parent.name for library in LIBRARIES.glob("*/biela.*")}
    expect("linux64" in built, "there are no libraries: run `make runtimes` first")
    missing += [f"the library `{name}`, which was not built" for name in PLATFORMS if name not in built]
    print(f"loading takes {loading_time(LIBRARIES / 'linux64/biela.so'):.2f} ms", flush=True)
    fmus = [export(name) for name in MECHANISMS]
    names = ", ".join(f.name for f in fmus)

    def record(host, fmus, difference, beside=""):
        runs.append((host, ", ".join(f.name for f in fmus), f"{beside}{difference}"))
        print(f"{host}: {difference}", flush=True)

    # In the C host.
    reference = linux(fmus)
    runs.append(("C host, Linux x86-64", names, "the reference"))

    def record_host(host, results):
        difference = Difference()
        for name, lines in results.items():
            compare(f"{host}, {name}", lines, reference[name], difference)
        record(host, fmus, difference)

    if OLD_SYSTEM.is_dir():
        results, version = old_linux(fmus)
        record_host(f"C host, Linux x86-64 with glibc {version}", results)
    else:
        missing.append("an older C library, which is not at hand")
    if "aarch64-linux" in built:
        record_host("C host, Linux ARM (QEMU)", arm(fmus))
    if "win64" in built:
        record_host("C host, Windows x86-64 (Wine)", windows(fmus))

        # In FMPy.
        def record_fmpy(host, fmus):
            difference = Difference()
            compare_fmpy(fmpy(fmus, python, "Z:"), fmpy(fmus, [sys.executable]), difference)
            record(host, fmus, difference, "beside FMPy on Linux: ")

        python = ["wine", windows_python()]
        record_fmpy("FMPy in Python for Windows (Wine)", fmus)
        program = windows_program()
        if program:
            ours, expected, archive = use_program(program, PROGRAM, python[1])
            difference = Difference()
            difference.add(ours, expected)
            difference.check("biela.exe run")
            exported = [Fmu("first", archive, FOLDER, "")]
            record("`biela.exe run` (Wine)", exported, difference, "beside `biela run` on Linux: ")
            record_fmpy("export of `biela.exe`, in FMPy for Windows (Wine)", exported)
        else:
            missing.append("`biela.exe`, of which there is no wheel")
    for what in missing:
        print(f"not tried: {what}", flush=True)
    if "--no-docs" not in sys.argv:
        write_page(libraries, runs, missing)


if __name__ == "__main__":
    try:
        main()
    except Failure as failure:
        sys.exit(f"failed: {failure}")
