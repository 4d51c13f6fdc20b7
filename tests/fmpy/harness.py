"""The program, the FMUs it exports, and a thin layer over FMPy's slave, for all tests here.

`BIELA_BIN` names the program; without it the release build is used, then the debug build.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from ctypes import byref
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, NamedTuple

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import printLogMessage
from fmpy.fmi2 import (
    FMU2Slave,
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
)
from fmpy.logging import addLoggerProxy
from fmpy.model_description import ModelDescription, ModelVariable

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "demo"))

from closed_form import largest_errors  # noqa: E402  (its folder has only just been added)

SHIPPED = sorted(path.stem for path in (ROOT / "mechanisms").glob("*.toml"))
"""Names of the shipped mechanisms."""

OK, WARNING, DISCARD, ERROR, FATAL = range(5)


# ---------------------------------------------------------------------------------------------
# The program


def state_names(description) -> list[str]:
    """Returns the names of the continuous states, in their order."""
    return [unknown.variable.derivative.name for unknown in description.derivatives]


def state_outputs(description) -> list[str]:
    """Returns the names of the outputs that the continuous states are at first, in their order."""
    outputs = (v for v in description.modelVariables if v.causality == "output")
    return [output.name for output in outputs if output.start is not None]


def program() -> Path:
    """Path of the `biela` program; a missing one fails the test that asks for it."""
    suffix = ".exe" if os.name == "nt" else ""
    if named := os.environ.get("BIELA_BIN"):
        candidates = [Path(named)]
    else:
        candidates = [ROOT / "target" / kind / f"biela{suffix}" for kind in ("release", "debug")]
    for candidate in candidates:
        if candidate.is_file():
            return candidate
    pytest.fail(f"no program at {' or '.join(map(str, candidates))}: run `make build` first")


def run_biela(*arguments, **options) -> subprocess.CompletedProcess:
    """Runs the program; the caller looks at its exit status."""
    return subprocess.run(
        [program(), *map(str, arguments)],
        capture_output=True,
        text=True,
        encoding="utf-8",
        **options,
    )


def export(mechanism: Path, fmu: Path, *, version: int = 2, **options) -> Path:
    """Exports a mechanism file as `fmu`, for a version of FMI, and returns that path."""
    done = run_biela("export", mechanism, "--fmi", version, "-o", fmu, **options)
    assert done.returncode == 0, done.stderr
    return fmu


# ---------------------------------------------------------------------------------------------
# Exported FMUs


@dataclass(frozen=True)
class Fmu:
    """An exported FMU: the file, its unpacked folder and its model description."""

    path: Path
    folder: Path
    description: ModelDescription

    @classmethod
    def unpack(cls, path: Path, folder: Path) -> Fmu:
        fmpy.extract(path, folder)
        return cls(path, folder, fmpy.read_model_description(str(path)))

    @property
    def name(self) -> str:
        return self.description.modelName

    @property
    def variables(self) -> dict[str, ModelVariable]:
        return {variable.name: variable for variable in self.description.modelVariables}

    def names(self, causality: str) -> list[str]:
        """Names of the variables with this causality, in order."""
        return [v.name for v in self.description.modelVariables if v.causality == causality]

    @property
    def library(self) -> Path:
        """The shared library for the platform the tests run on."""
        return (
            self.folder
            / "binaries"
            / fmpy.platform
            / f"{self.description.modelIdentifier}{fmpy.sharedLibraryExtension}"
        )


def mechanism_file(name: str) -> Path:
    """The file of a shipped mechanism, or of one made for the tests."""
    shipped = ROOT / "mechanisms" / f"{name}.toml"
    return shipped if shipped.exists() else ROOT / "tests" / "fmpy" / "mechanisms" / f"{name}.toml"


# ---------------------------------------------------------------------------------------------
# Running: messages, instances, signals


class Message(NamedTuple):
    """One call of the host's logger."""

    status: int
    category: str
    text: str


class Messages(list):
    """The logger's messages, with the callbacks that collect them.

    FMPy's native helper, which formats the text, knows one logger at a time for the whole
    process. All instances therefore share one, and the environment that each hands back with a
    message tells whose it is.
    """

    _collecting: ClassVar[dict[int, Messages]] = {}

    def __init__(self):
        super().__init__()
        number = len(self._collecting) + 1
        self._collecting[number] = self
        self.callbacks = fmi2CallbackFunctions()
        self.callbacks.logger = fmi2CallbackLoggerTYPE(self._dispatch)
        self.callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE(fmpy.calloc)
        self.callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE(fmpy.free)
        self.callbacks.componentEnvironment = number
        addLoggerProxy(byref(self.callbacks))

    @classmethod
    def _dispatch(cls, environment, *message):
        if environment is None:  # of an instance with FMPy's own callbacks
            printLogMessage(environment, *message)
        else:
            cls._collecting[environment].log(environment, *message)

    def log(self, environment, instance, status, category, text):
        """The logger, as FMPy wants it."""
        self.append(Message(status, category.decode("utf-8"), text.decode("utf-8")))

    def texts(self, status: int) -> list[str]:
        """Texts of the messages with this status."""
        return [message.text for message in self if message.status == status]


def numbers_in(text: str) -> list[float]:
    """All numbers that a message mentions."""
    return [float(n) for n in re.findall(r"[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?", text)]


class Slave:
    """One instance of an FMU: FMPy's `FMU2Slave` with names in place of value references.

    A call that fails raises FMPy's `FMICallException`, which carries the status.
    """

    def __init__(
        self,
        fmu: Fmu,
        *,
        guid: str | None = None,
        messages: Messages | None = None,
        logging: bool = False,
    ):
        self.variables = fmu.variables
        self.messages = Messages() if messages is None else messages
        self.time = 0.0
        self.fmi = FMU2Slave(
            guid=fmu.description.guid if guid is None else guid,
            modelIdentifier=fmu.description.modelIdentifier,
            unzipDirectory=str(fmu.folder),
            instanceName=f"{fmu.name} under test",
        )
        self.fmi.instantiate(callbacks=self.messages.callbacks, loggingOn=logging)

    def setup(self, start_time: float = 0.0, stop_time: float | None = None) -> None:
        self.fmi.setupExperiment(startTime=start_time, stopTime=stop_time)
        self.time = start_time

    def start(self, values: dict[str, float] | None = None, **experiment: float) -> Slave:
        """Set-up and initialization with `values` set in between; ready for the first step."""
        self.setup(**experiment)
        self.set(values or {})
        self.fmi.enterInitializationMode()
        self.fmi.exitInitializationMode()
        return self

    def set(self, values: dict[str, float]) -> None:
        """Sets variables by name, in the order given; those of one type in one call."""
        for kind in ("Real", "Integer"):
            chosen = {n: v for n, v in values.items() if self._kind(n) == kind}
            if chosen:
                getattr(self.fmi, f"set{kind}")(self._references(chosen), list(chosen.values()))

    def get(self, *names: str) -> list:
        """Values of variables by name, in that order."""
        values = {}
        for kind in ("Real", "Integer"):
            chosen = [name for name in names if self._kind(name) == kind]
            if chosen:
                found = getattr(self.fmi, f"get{kind}")(self._references(chosen))
                values.update(zip(chosen, found, strict=True))
        return [values[name] for name in names]

    def get_one(self, name: str):
        return self.get(name)[0]

    def outputs(self) -> dict[str, float]:
        """All outputs by name."""
        names = [n for n, v in self.variables.items() if v.causality == "output"]
        return dict(zip(names, self.get(*names), strict=True))

    def set_derivatives(self, name: str, *derivatives: float) -> None:
        """Input derivatives of an input: first, second, …"""
        orders = list(range(1, len(derivatives) + 1))
        self.fmi.setRealInputDerivatives(
            self._references([name]) * len(orders), orders, list(derivatives)
        )

    def step(self, size: float) -> None:
        """One step from where the last one ended."""
        self.fmi.doStep(self.time, size)
        self.time += size

    def _references(self, names) -> list[int]:
        return [self.variables[name].valueReference for name in names]

    def _kind(self, name: str) -> str:
        kind = self.variables[name].type
        return "Integer" if kind == "Enumeration" else kind


def simulate(fmu: Fmu, messages: Messages | None = None, **options):
    """`fmpy.simulate_fmu` on the unpacked FMU, recording inputs and outputs."""
    options.setdefault("output", fmu.names("input") + fmu.names("output"))
    if messages is not None:
        options["logger"] = messages.log
    return fmpy.simulate_fmu(str(fmu.folder), **options)


def signals(driver: str, time, *columns) -> np.ndarray:
    """Input signals for FMPy: the driver's value and as many of its rates as are given."""
    suffixes = ("position", "velocity", "acceleration")[: len(columns)]
    dtype = [("time", float), *((f"{driver}.{suffix}", float) for suffix in suffixes)]
    table = np.empty(len(time), dtype=dtype)
    for name, column in zip(table.dtype.names, (time, *columns), strict=True):
        table[name] = column
    return table


def collect(rows: list[dict[str, float]]) -> dict[str, np.ndarray]:
    """Rows of outputs turned into columns."""
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


# ---------------------------------------------------------------------------------------------
# Comparing


POSITION_LIMIT = 1e-12
RATE_LIMIT = 1e-10
"""Promised accuracy of positions, and of velocities and accelerations: the largest error over a
motion, relative to the largest magnitude of the same kind of quantity over that motion."""


def assert_accurate(actual, expected) -> None:
    """`actual[name]` keeps the promise for every name in `expected`."""
    errors = largest_errors(actual, expected)
    assert errors["position"] <= POSITION_LIMIT, errors
    assert errors["velocity"] <= RATE_LIMIT, errors
    assert errors["acceleration"] <= RATE_LIMIT, errors
