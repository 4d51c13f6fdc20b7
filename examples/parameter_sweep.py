"""A four-bar exported as an FMU, run in FMPy over a turn of its crank for several crank lengths.

Cells begin with `# %%`, as VS Code, Spyder and Jupytext have them; as a script it runs as well.
"""

# %% Export
# The program `biela` is on the PATH (`make install`).
import os
import subprocess
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from fmpy import extract, read_model_description, simulate_fmu

HERE = Path(__file__).resolve().parent
SMALL = os.environ.get("BIELA_EXAMPLE") == "small"

subprocess.run(
    ["biela", "export", HERE.parent / "mechanisms" / "four_bar.toml", "-o", "four_bar.fmu"],
    check=True,
)

# %% What is in it
description = read_model_description("four_bar.fmu")
for variable in description.modelVariables:
    if variable.causality in ("input", "parameter"):
        print(f"{variable.causality:10} {variable.name:27} start {variable.start}")

# %% One run
# The crank turns once in a second. Its rates are inputs too, so that the outputs' rates are exact
# from the first step; `extrapolation` = 2 carries the angle along within a step, so that the
# outputs belong to the same time as the inputs.
STEPS = 60 if SMALL else 360
time = np.linspace(0, 1, STEPS + 1)
omega = 2 * np.pi
names = ["time", *(f"crank_angle.{order}" for order in ("position", "velocity", "acceleration"))]
signals = np.zeros(len(time), dtype=[(name, float) for name in names])
signals["time"] = time
signals["crank_angle.position"] = omega * time
signals["crank_angle.velocity"] = omega
folder = extract("four_bar.fmu")  # into a temporary folder, once for all runs


def run(crank_length):
    """The motion over one turn, as a structured array."""
    return simulate_fmu(
        folder,
        model_description=description,
        stop_time=1,
        step_size=1 / STEPS,
        output_interval=1 / STEPS,
        input=signals,
        start_values={
            "crank_length": crank_length,
            "crank_angle.position": 0.0,
            "extrapolation": 2,
        },
        output=["rocker.phi", "rocker.omega", "rocker.alpha", "transmission.position"],
    )


# %% A parameter swept
crank_lengths = np.linspace(0.04, 0.14, 3 if SMALL else 6)
results = {length: run(length) for length in crank_lengths}

# %% What comes out, and what the closed form says
# The rocker turns back where crank and coupler are in line (law of cosines).
BASE, COUPLER, ROCKER = 0.40, 0.25, 0.30


def angle(side):
    """Between the base and the rocker, where `side` joins their far ends."""
    return np.arccos((BASE**2 + ROCKER**2 - side**2) / (2 * BASE * ROCKER))


print("\ncrank [mm]  swing [deg]  closed form  least transmission angle [deg]")
for length, result in results.items():
    swing = np.ptp(result["rocker.phi"])
    closed_form = angle(COUPLER + length) - angle(COUPLER - length)
    transmission = np.abs(result["transmission.position"])
    least = np.minimum(transmission, np.pi - transmission).min()
    row = (1000 * length, np.degrees(swing), np.degrees(closed_form), np.degrees(least))
    print("{:10.0f}  {:11.3f}  {:11.3f}  {:30.2f}".format(*row))

# %% Plots
figure, axes = plt.subplots(3, 1, sharex=True, figsize=(7, 8), layout="constrained")
rows = [
    ("rocker.phi", "angle [deg]", np.degrees(1)),
    ("rocker.omega", "velocity [rad/s]", 1),
    ("rocker.alpha", "acceleration [rad/s²]", 1),
]
colours = plt.cm.viridis(np.linspace(0, 0.85, len(results)))
for ax, (name, label, factor) in zip(axes, rows, strict=True):
    for (length, result), colour in zip(results.items(), colours, strict=True):
        ax.plot(360 * time, factor * result[name], color=colour, label=f"{1000 * length:.0f} mm")
    ax.set_ylabel(label)
    ax.grid(alpha=0.3)
axes[0].set_title("Rocker of a four-bar, by the length of its crank")
axes[0].legend(ncols=3, fontsize="small")
axes[-1].set_xlabel("crank angle [deg]")
axes[-1].set_xticks(range(0, 361, 60))
figure.savefig("parameter_sweep.png", dpi=120)
