"""Errors of an FMU's outputs by step size and setting, for a crank that swings at 1 Hz.

The host sets the inputs of time t, steps to t + h and reads the outputs of t + h. The table shows
their largest error after the first half second, relative to the amplitude of each order.

Cells begin with `# %%`, as VS Code, Spyder and Jupytext have them; as a script it runs as well.
"""

# %% Export
# The program `biela` is on the PATH (`make install`).
import subprocess
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

HERE = Path(__file__).resolve().parent
subprocess.run(
    ["biela", "export", HERE.parent / "mechanisms" / "four_bar.toml", "-o", "four_bar.fmu"],
    check=True,
)
description = read_model_description("four_bar.fmu")
reference = {v.name: v.valueReference for v in description.modelVariables}
fmu = FMU2Slave(
    guid=description.guid,
    unzipDirectory=extract("four_bar.fmu"),  # into a temporary folder
    modelIdentifier=description.coSimulation.modelIdentifier,
    instanceName="crank",
)
fmu.instantiate()

# %% Motion
OMEGA = 2 * np.pi
AMPLITUDES = np.array([1.0, OMEGA, OMEGA**2])  # rad, rad/s, rad/s²
INPUTS = [reference[f"crank_angle.{order}"] for order in ("position", "velocity", "acceleration")]
OUTPUTS = [reference[f"crank.{order}"] for order in ("phi", "omega", "alpha")]


def motion(t):
    """Angle, velocity and acceleration of the crank at a time."""
    sin, cos = np.sin(OMEGA * t), np.cos(OMEGA * t)
    return np.array([1.0 + sin, OMEGA * cos, -(OMEGA**2) * sin])


# %% One run
HOLD, TAYLOR = 1, 2


def run(h, wired, extrapolation=HOLD, derivatives=False, read_after_set=False):
    """Largest relative errors of angle, velocity and acceleration over 1.5 s.

    `wired` inputs are set, of the position's derivatives both if `derivatives`. With
    `read_after_set` the host sets the inputs of t + h after the step and reads then.
    """
    fmu.reset()
    fmu.setupExperiment(startTime=0.0)
    fmu.setInteger([reference["extrapolation"]], [extrapolation])
    fmu.setReal(INPUTS[:wired], motion(0.0)[:wired])
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    errors = []
    for step in range(round(1.5 / h)):
        t = step * h
        fmu.setReal(INPUTS[:wired], motion(t)[:wired])
        if derivatives:
            fmu.setRealInputDerivatives(2 * INPUTS[:1], [1, 2], motion(t)[1:])
        fmu.doStep(t, h)
        if read_after_set:
            fmu.setReal(INPUTS[:wired], motion(t + h)[:wired])
        if t >= 0.5:
            errors.append(np.abs(np.array(fmu.getReal(OUTPUTS)) - motion(t + h)))
    return np.max(errors, axis=0) / AMPLITUDES


# %% Table
STEPS = (0.02, 0.005, 0.001)
SETTINGS = {
    "position wired": {"wired": 1},
    "position wired, extrapolated": {"wired": 1, "extrapolation": TAYLOR},
    "position wired, read after set": {"wired": 1, "read_after_set": True},
    "position and its derivatives": {"wired": 1, "derivatives": True},
    "all wired": {"wired": 3},
    "all wired, extrapolated": {"wired": 3, "extrapolation": TAYLOR},
    "all wired, read after set": {"wired": 3, "read_after_set": True},
}
print("setting                         step [ms]    angle  velocity  acceleration")
for setting, options in SETTINGS.items():
    for h in STEPS:
        errors = ("0" if error < 1e-10 else f"{error:.0e}" for error in run(h, **options))
        print("{:30}  {:9.0f}  {:>7}  {:>8}  {:>12}".format(setting, 1000 * h, *errors))
fmu.terminate()
fmu.freeInstance()
