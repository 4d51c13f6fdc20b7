"""FMUs of both versions, and C hosts that run them on stand-ins for other systems."""

from __future__ import annotations

import math
import os
import re
import shutil
import subprocess
import urllib.parse
import zipfile
from dataclasses import dataclass, field
from pathlib import Path

from common import FOLDER, HERE, LIBRARIES, ROOT, WORK, Difference, environment, expect, headers, run
from fmpy import read_model_description

PROGRAM = Path(os.environ.get("BIELA_BIN", ROOT / "target/release/biela"))
# The C library of Debian 11, where scripts/test_platforms.sh could get it.
OLD_LIBRARIES = WORK / "debian-11/lib/x86_64-linux-gnu"

MECHANISMS = ("four_bar", "cam_roller", "platform_3rpr", "tlv")
STEPS, SIZE = 200, 0.005
# Scenarios of tests/host3.c: mechanism, scenario, its numbers or the variables whose references it
# takes.
SCENARIOS = (
    ("pendulum", "states"),
    ("pendulum", "events", "rod.phi"),
    ("pendulum", "intermediate", "rod.phi", "rod.omega", "rod.alpha"),
    ("tlv", "early", 0, "extrapolation", 0.6, 0.1),
    ("tlv", "early", 1, "extrapolation", 0.6, 0.1),
)


# ---------------------------------------------------------------------------------------------
# FMUs and requests


@dataclass
class Fmu:
    """An exported FMU, unpacked, with the variables that hosts set and read."""

    name: str
    version: int
    archive: Path
    folder: Path = Path()
    token: str = ""
    references: dict = field(default_factory=dict)
    inputs: list = field(default_factory=list)
    outputs: list = field(default_factory=list)

    def values(self, t):
        """Returns the inputs at a time: around their starts, by as much as each mechanism can take."""
        width = {"four_bar": 2 * math.pi, "cam_roller": 2 * math.pi}.get(self.name, 0.03)
        return [start + width * math.sin(2.0 * t + k) * min(1.0, t) for k, (_, start) in enumerate(self.inputs)]


def export(name, version=2):
    """Exports a shipped mechanism with all libraries, and unpacks it."""
    folder = FOLDER / f"{name} {version}"
    archive = folder.with_suffix(".fmu")
    options = ["-o", archive, "--fmi", version, "--runtime", LIBRARIES]
    run(PROGRAM, "export", ROOT / f"mechanisms/{name}.toml", *options)
    shutil.rmtree(folder, ignore_errors=True)
    with zipfile.ZipFile(archive) as content:
        content.extractall(folder)
    description = read_model_description(str(archive))
    fmu = Fmu(name, version, archive, folder, description.guid or description.instantiationToken)
    for variable in description.modelVariables:
        fmu.references[variable.name] = variable.valueReference
        if variable.causality == "input" and variable.name.endswith(".position"):
            fmu.inputs.append((variable.valueReference, float(variable.start)))
        elif variable.causality == "output":
            fmu.outputs.append(variable.valueReference)
    return fmu


def requests(fmu, uri):
    """Returns the requests to `tests/host.c`; the last one of a motion is met at a dead point."""
    numbers = lambda values: ",".join(map(repr, values))  # noqa: E731
    inputs = numbers(vr for vr, _ in fmu.inputs)
    some = fmu.outputs[:128]
    yield "Instantiate", 0, "instance", fmu.token, uri, 1, 1, "full"
    yield "SetupExperiment", 0, 0.0, r"\N"
    yield "EnterInitializationMode", 0
    yield "ExitInitializationMode", 0
    for step in range(STEPS):
        t = step * SIZE
        yield "SetReal", 0, len(fmu.inputs), inputs, numbers(fmu.values(t))
        yield "DoStep", 0, repr(t), repr(SIZE), 1
        for k in range(0, len(fmu.outputs), 128):
            part = fmu.outputs[k : k + 128]
            yield "GetReal", 0, len(part), numbers(part), ""
    # Calls to be refused: an unknown variable, no number, a step back.
    yield "GetReal", 0, 1, "99999", ""
    yield "SetReal", 0, 1, inputs.split(",")[0], "nan"
    yield "DoStep", 0, repr(STEPS * SIZE), "-0.1", 1
    # Far beyond a dead point, where there is one.
    yield "SetReal", 0, 1, inputs.split(",")[0], "0.9"
    yield "DoStep", 0, repr(STEPS * SIZE), repr(SIZE), 1
    yield "GetReal", 0, len(some), numbers(some), ""
    yield "GetRealStatus", 0, 2, "room"
    yield "Modes", fmu.token, uri, len(some), numbers(some)


# ---------------------------------------------------------------------------------------------
# Systems


@dataclass(frozen=True)
class System:
    """A system on which C hosts run: their compiler, what starts them, its libraries."""

    name: str
    compiler: tuple
    start: tuple
    # Folders in FMUs of both versions, and the extension.
    library: tuple
    flags: tuple = ("-ldl", "-lm")
    windows: bool = False

    def host(self, source):
        """Compiles a host and returns the command that starts it."""
        program = WORK / f"{Path(source).stem}-{self.library[1]}{'.exe' if self.windows else ''}"
        # The headers of FMI 3.0 declare `()`, which newer compilers want as `(void)`.
        common = ["-std=c11", "-O2", "-pthread", "-isystem", headers()]
        run(*self.compiler, *common, ROOT / "tests" / source, "-o", program, *self.flags)
        return [*self.start, program]

    def path(self, path, end=""):
        """Returns a path of this machine as the system sees it, with a separator at its end if
        `end` is one."""
        text = f"{path}{end}"
        return "Z:" + text.replace("/", "\\") if self.windows else text

    def uri(self, path):
        return f"file://{'/Z:' if self.windows else ''}" + urllib.parse.quote(str(path))

    def binary(self, fmu):
        tuple_2, tuple_3, extension = self.library
        folder = tuple_2 if fmu.version == 2 else tuple_3
        # The C hosts of Windows take slashes too.
        return f"{'Z:' if self.windows else ''}{fmu.folder}/binaries/{folder}/{fmu.name}.{extension}"

    def run(self, name, command, text=b""):
        """Returns what a host writes, one list of fields per line."""
        done = subprocess.run([*map(str, command)], input=text, capture_output=True, env=environment())
        told = done.stderr.decode(errors="replace")
        expect(done.returncode == 0, f"{self.name}, {name}: the host ends with {done.returncode}: {told}")
        expect(not told.strip(), f"{self.name}, {name}: something is written to stderr: {told[:500]}")
        return [line.rstrip("\r") for line in done.stdout.decode("utf-8").split("\n") if line.strip()]

    def runs_2(self, fmus):
        """Returns the texts and tables of FMI 2.0's FMUs by name."""
        host, results = self.host("host.c"), {}
        for fmu in fmus:
            uri = self.uri(fmu.folder / "resources")
            text = "".join("\t".join(map(str, request)) + "\n" for request in requests(fmu, uri))
            lines = [line.split("\t") for line in self.run(fmu.name, [*host, self.binary(fmu)], text.encode())]
            # Status, values that depend on the host's rounding mode, modes that a call changed.
            expect(lines[-1] == ["answer", "0", "0", "0"], f"{self.name}, {fmu.name}: rounding modes: {lines[-1]}")
            texts, tables = [], {}
            for fields in lines:
                if fields[0] == "answer" and len(fields) > 10:
                    texts.append(fields[:2])
                    tables.setdefault(len(fields), []).append([float(value) for value in fields[2:]])
                else:
                    # The solver's details tell residuals, which are rounding.
                    texts.append([re.sub(r"residual \S+", "residual", field) for field in fields])
            results[fmu.name] = texts, tables
        return results

    def runs_3(self, fmus):
        """Returns the texts and tables of FMI 3.0's FMUs by scenario."""
        host, results = self.host("host3.c"), {}
        fmus = {fmu.name: fmu for fmu in fmus}
        for mechanism, scenario, *more in SCENARIOS:
            fmu = fmus[mechanism]
            more = [fmu.references[value] if isinstance(value, str) else value for value in more]
            resources = self.path(fmu.folder / "resources", "/")
            command = [*host, self.binary(fmu), fmu.token, resources, scenario, *more]
            name = f"{mechanism} {scenario} {more[:1]}"
            texts, tables = [], {}
            for line in self.run(name, command):
                try:
                    row = [float(value) for value in line.split(" ")]
                    tables.setdefault(len(row), []).append(row)
                except ValueError:
                    texts.append(line)
            results[name] = texts, tables
        return results


LINUX = System("Linux x86-64", ("cc",), (), ("linux64", "x86_64-linux", "so"))
ARM = System(
    "Linux ARM (QEMU)",
    ("aarch64-linux-gnu-gcc",),
    ("qemu-aarch64-static", "-L", "/usr/aarch64-linux-gnu"),
    ("aarch64-linux", "aarch64-linux", "so"),
)
WINDOWS = System(
    "Windows x86-64 (Wine)",
    ("x86_64-w64-mingw32-gcc", "-municode", "-Dmain=host_main", f"-I{HERE}/windows", f"{HERE}/windows/wmain.c"),
    ("wine",),
    ("win64", "x86_64-windows", "dll"),
    ("-static", "-D__USE_MINGW_ANSI_STDIO=1"),
    windows=True,
)


def old_linux():
    """Returns the system of OLD_LIBRARIES."""
    loader = next(OLD_LIBRARIES.glob("ld-2.*.so"))
    zig = ROOT / ".tools/cross/bin/python-zig"
    return System(
        f"Linux x86-64 with glibc {loader.stem.removeprefix('ld-')}",
        (zig, "cc", "-target", "x86_64-linux-gnu.2.17"),
        (loader, "--library-path", OLD_LIBRARIES),
        LINUX.library,
    )


def compare(system, ours, reference):
    """Refuses other texts than those of the reference; returns the difference of the numbers."""
    difference = Difference()
    for name, (texts, tables) in ours.items():
        expected, expected_tables = reference[name]
        for text, other in zip(texts, expected, strict=True):
            expect(text == other, f"{system.name}, {name}: {text} instead of {other}")
        for width, table in tables.items():
            difference.add(table, expected_tables[width])
        difference.check(f"{system.name}, {name}")
    return difference
