"""From mechanism files to pictures: exports the five examples as FMUs and runs them in FMPy.

Each FMU is validated, driven through a full motion and compared with the closed form of its
mechanism. Writes `demo/out/NAME.fmu` and `demo/out/NAME.png`. `BIELA_BIN` names the program to
export with; without it the release build is used. Exit status: 0 if every FMU is valid and every
error within its limit, 1 otherwise, 2 if there is no program.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

import fmpy
import numpy as np
from closed_form import CLOSED_FORMS, largest_errors
from fmpy.validation import validate_fmu
from motions import full_motion
from plots import draw

ROOT = Path(__file__).resolve().parent.parent
STEPS = 720

LIMITS = {"position": 1e-12, "velocity": 1e-10, "acceleration": 1e-10}
"""Largest permitted error, relative to the largest magnitude of its kind over the motion."""


@dataclass
class Outcome:
    """What became of one mechanism."""

    name: str
    problems: list[str]
    errors: dict[str, float]
    seconds: float

    @property
    def ok(self) -> bool:
        return not self.problems and all(self.errors[k] <= limit for k, limit in LIMITS.items())


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out", type=Path, default=ROOT / "demo" / "out", help="folder to write to"
    )
    out = parser.parse_args().out
    out.mkdir(parents=True, exist_ok=True)

    suffix = ".exe" if os.name == "nt" else ""
    biela = Path(os.environ.get("BIELA_BIN") or ROOT / "target" / "release" / f"biela{suffix}")
    if not biela.is_file():
        print(f"no program at {biela}: build it first with `make build`", file=sys.stderr)
        return 2

    print_head()
    outcomes = []
    for name in CLOSED_FORMS:
        outcomes.append(show(name, biela, out))
        print_row(outcomes[-1])
    print_end(outcomes, out)
    return 0 if all(outcome.ok for outcome in outcomes) else 1


def show(name: str, biela: Path, out: Path) -> Outcome:
    """Exports, validates, runs, compares and draws one mechanism."""
    file, fmu = ROOT / "mechanisms" / f"{name}.toml", out / f"{name}.fmu"
    export = subprocess.run([biela, "export", file, "-o", fmu], capture_output=True, text=True)
    if export.returncode != 0:
        sys.exit(f"{file.name} could not be exported:\n{export.stderr}")
    problems = validate_fmu(str(fmu))

    form = CLOSED_FORMS[name]
    description = fmpy.read_model_description(str(fmu))
    inputs = [v.name for v in description.modelVariables if v.causality == "input"]
    outputs = [v.name for v in description.modelVariables if v.causality == "output"]

    began = perf_counter()
    result = fmpy.simulate_fmu(
        str(fmu),
        input=signals(name, float(description.defaultExperiment.stopTime)),
        output_interval=float(description.defaultExperiment.stopTime) / STEPS,
        output=inputs + outputs,
    )
    seconds = perf_counter() - began

    # FMPy holds the inputs over each step: a row's outputs belong to the inputs recorded with it.
    in_force = (result[f"{form.driver}.{s}"] for s in ("position", "velocity", "acceleration"))
    expected = form().motion(*in_force)
    if len(result) != STEPS + 1:
        problems.append(f"the run ended after {len(result) - 1} of {STEPS} steps")
    if set(expected) != set(outputs):
        problems.append("the outputs are not those of the closed form")

    draw(name, result, expected, lengths(description), out / f"{name}.png")
    return Outcome(name, problems, largest_errors(result, expected), seconds)


def signals(name: str, duration: float) -> np.ndarray:
    """The full motion as FMPy takes it: one column for the time and one for each input."""
    driver = CLOSED_FORMS[name].driver
    columns = ["time", *(f"{driver}.{s}" for s in ("position", "velocity", "acceleration"))]
    time = np.linspace(0, duration, STEPS + 1)
    table = np.empty(len(time), dtype=[(column, float) for column in columns])
    for column, values in zip(columns, (time, *full_motion(name, time, duration)), strict=True):
        table[column] = values
    return table


def lengths(description) -> dict[str, float]:
    """The parameters' values in the FMU."""
    return {
        v.name: float(v.start)
        for v in description.modelVariables
        if v.causality == "parameter" and v.type == "Real"
    }


# ---------------------------------------------------------------------------------------------
# What is printed


def print_head() -> None:
    print("Mechanism files exported as FMUs and run in FMPy over a full motion, compared with the")
    print("closed form. Errors are relative to the largest magnitude over the motion.\n")
    print(f"{'':14}{'':>6}  {'':10}  {'largest error of':^32}")
    print(
        f"{'mechanism':14}{'steps':>6}  {'validation':10}  "
        f"{'position':>10} {'velocity':>10} {'accel.':>10}  {'time':>8}"
    )
    print("-" * 78)


def print_row(outcome: Outcome) -> None:
    cells = " ".join(f"{outcome.errors[key]:10.1e}" for key in LIMITS)
    validation = "problems" if outcome.problems else "valid"
    print(f"{outcome.name:14}{STEPS:>6}  {validation:10}  {cells}  {outcome.seconds:6.2f} s")
    for problem in outcome.problems:
        print(f"    {problem}")
    for key, limit in LIMITS.items():
        if not outcome.errors[key] <= limit:
            print(f"    {key}: the error exceeds its limit")


def print_end(outcomes: list[Outcome], out: Path) -> None:
    print("-" * 78)
    cells = " ".join(f"{limit:10.0e}" for limit in LIMITS.values())
    print(f"{'limit':14}{'':>6}  {'':10}  {cells}\n")
    if not all(outcome.ok for outcome in outcomes):
        print("Some results are not what they should be; see above.")
        return
    try:
        shown = out.resolve().relative_to(Path.cwd())
    except ValueError:
        shown = out.resolve()
    print(f"Plots (*.png) and FMUs (*.fmu) are in {shown}. To run one yourself:\n")
    print("    from fmpy import simulate_fmu")
    print(f"    result = simulate_fmu({str(shown / 'four_bar.fmu')!r})")


if __name__ == "__main__":
    sys.exit(main())
