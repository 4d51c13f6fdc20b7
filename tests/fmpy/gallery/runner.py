"""Runs cases through FMPy and measures the errors."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from fmpy.validation import validate_fmu
from harness import Fmu, simulate

from . import Case
from .taylor import Taylor

ORDERS = ("position", "velocity", "acceleration")
BODY_SUFFIXES = {
    "x": ("x", "vx", "ax"),
    "y": ("y", "vy", "ay"),
    "phi": ("phi", "omega", "alpha"),
}
USE_INPUTS = 2
"""The setting of `rates` that takes an input's rates as they are given."""

RESIDUAL_LIMIT = 100 * np.finfo(float).eps
"""The residual is in characteristic lengths and radians. The solver takes one of four times its
rounding for zero, eps times the magnitudes that a row adds up: some lengths and angles, 25 at most
in these mechanisms."""


@dataclass
class Row:
    """Result of a case: a row of the table."""

    name: str
    source: str
    problems: list[str]
    residual: float = np.inf
    #: Largest error of each order relative to the largest magnitude of its kind.
    errors: dict[str, float] = field(default_factory=dict)
    #: Where each order's largest error is.
    worst: dict[str, str] = field(default_factory=dict)
    #: Largest deviation from each exact property.
    properties: dict[str, float] = field(default_factory=dict)
    limits: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def failures(self) -> list[str]:
        """Returns the faults, in words."""
        found = list(self.problems)
        if not self.residual <= RESIDUAL_LIMIT:
            found.append(f"residual {self.residual:.1e} exceeds {RESIDUAL_LIMIT:.1e}")
        for order, limit in zip(ORDERS, self.limits, strict=True):
            if not self.errors.get(order, np.inf) <= limit:
                error, place = self.errors.get(order), self.worst.get(order)
                found.append(f"{order}: error {error} of {place} exceeds {limit}")
        for what, deviation in self.properties.items():
            if not deviation <= self.limits[0]:
                found.append(f"{what}: deviates by {deviation}")
        return found


def position_names(fmu: Fmu) -> set[str]:
    """The positions among an FMU's outputs, named as in `Truth`."""
    positions = (*BODY_SUFFIXES, "position")
    return {
        output.removesuffix(".position")
        for output in fmu.names("output")
        if output.rpartition(".")[2] in positions
    }


def outputs_of(name: str) -> tuple[str, str, str]:
    """The FMU's outputs for a position named as in `Truth`: it and its rates."""
    owner, _, suffix = name.rpartition(".")
    if owner and suffix in BODY_SUFFIXES:
        return tuple(f"{owner}.{s}" for s in BODY_SUFFIXES[suffix])
    return tuple(f"{name}.{order}" for order in ORDERS)


def run(name: str, case: Case, fmu: Fmu) -> Row:
    """Validates the FMU, runs the case's motion and compares."""
    row = Row(name, case.source, list(validate_fmu(str(fmu.path))), limits=case.limits)
    motion = record(case, fmu)
    if len(motion["time"]) != case.steps + 1:
        row.problems.append(f"ended after {len(motion['time']) - 1} of {case.steps} steps")
    row.residual = float(np.max(motion["solver.residual"]))

    # FMPy holds inputs over a step: a row's outputs belong to the inputs recorded with it, which
    # were set at the row before.
    positions = (name for name in fmu.names("input") if name.endswith(".position"))
    names = sorted(name.removesuffix(".position") for name in positions)
    time = Taylor.time(late(motion["time"]) if names else motion["time"])
    drivers = {driver: Taylor(*(motion[o] for o in outputs_of(driver))) for driver in names}
    if not covers(drivers, case.drivers(time)):
        row.problems.append("the inputs in force are not the case's motion")
    compare(row, case.truth(time, drivers), motion, fmu)
    for what, deviation in case.properties(motion).items():
        row.properties[what] = worst_of(deviation)
    return row


def record(case: Case, fmu: Fmu) -> dict[str, np.ndarray]:
    """Inputs, outputs and the residual over the case's motion."""
    inputs = fmu.names("input")
    time = np.linspace(0, case.duration, case.steps + 1)
    drivers = case.drivers(Taylor.time(time))
    signals = np.zeros(len(time), dtype=[(column, float) for column in ("time", *inputs)])
    # Those that no driver has, such as a set point, stay at their start.
    for column in inputs:
        signals[column] = float(fmu.variables[column].start)
    signals["time"] = time
    for driver, u in drivers.items():
        values = (u.value, u.first, u.second)
        for column, value in zip(outputs_of(driver), values, strict=True):
            signals[column] = value
    result = simulate(
        fmu,
        input=signals if inputs else None,
        start_time=0.0,
        stop_time=case.duration,
        output_interval=case.duration / case.steps,
        start_values=case.parameters | ({"rates": USE_INPUTS} if drivers else {}),
        output=[*inputs, *fmu.names("output"), "solver.residual"],
    )
    return {column: np.array(result[column]) for column in result.dtype.names}


def late(column: np.ndarray) -> np.ndarray:
    """A column one row later; the first row stays."""
    return np.concatenate([column[:1], column[:-1]])


def covers(found: dict[str, Taylor], sent: dict[str, Taylor]) -> bool:
    """Whether the inputs found are those sent, but for FMPy's interpolation between samples."""
    return set(found) == set(sent) and all(
        np.allclose(getattr(found[name], order), getattr(sent[name], order), rtol=1e-12, atol=1e-11)
        for name in sent
        for order in ("value", "first", "second")
    )


def compare(row: Row, truth: dict[str, Taylor], motion: dict[str, np.ndarray], fmu: Fmu) -> None:
    """Fills in the errors of what the truth knows.

    An error is relative to the largest magnitude that the truth has of the same kind, lengths or
    angles and their rates, over the motion; a kind that stays zero is compared absolutely.
    """
    size: dict[tuple[str, str], float] = {}
    error: dict[tuple[str, str], tuple[float, str]] = {}
    for name, exact in truth.items():
        outputs = outputs_of(name)
        dimension = unit_of(fmu, outputs[0])
        values = (exact.value, exact.first, exact.second)
        for order, output, value in zip(ORDERS, outputs, values, strict=True):
            if output not in motion:
                row.problems.append(f"the FMU has no output {output}")
                continue
            kind = (order, dimension)
            size[kind] = max(size.get(kind, 0.0), float(np.max(np.abs(value))))
            worst = worst_of(motion[output] - value)
            error[kind] = max(error.get(kind, (0.0, "")), (worst, output))
    for (order, dimension), (worst, output) in error.items():
        relative = worst / (size[order, dimension] or 1.0)
        if relative >= row.errors.get(order, 0.0):
            row.errors[order] = relative
            row.worst[order] = output


def worst_of(deviation) -> float:
    """The largest magnitude; what is not a number counts as infinitely large."""
    deviation = np.abs(np.asarray(deviation))
    return float(np.max(np.where(np.isfinite(deviation), deviation, np.inf)))


def unit_of(fmu: Fmu, output: str) -> str:
    """An output's unit, whether it stands at the variable or at its type."""
    variable = fmu.variables[output]
    return variable.unit or variable.declaredType.unit


def table(rows: list[Row]) -> str:
    """The rows as a Markdown table."""

    lines = [
        "| mechanism | truth | position | velocity | acceleration | residual |",
        "|---|---|---:|---:|---:|---:|",
    ]
    for row in rows:
        cells = [row.name, row.source]
        cells += [f"{row.errors.get(order, np.inf):.1e}" for order in ORDERS]
        cells.append(f"{row.residual:.1e}")
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)
