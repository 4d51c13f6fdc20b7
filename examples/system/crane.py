"""A hydraulic cylinder lifts a load: two FMUs of different origin, coupled by an SSP file.

The cylinder with its valve (`cylinder.c`, an FMU of its own) moves a crane (`crane.toml`, an FMU of
biela). The crane tells what inertia and what bias its cylinder feels, the cylinder integrates

    (piston + inertia) speed' = area pressure - friction speed - bias

with the pressure of its oil, and no master has to iterate. FMPy and Ecos simulate the same SSP file.
The same equations with the crane's own by hand, a body that turns about its pivot, are integrated as
a whole by Runge-Kutta. The table shows the largest differences: they shrink with the step.

Cells begin with `# %%`, as VS Code, Spyder and Jupytext have them; as a script it runs as well.
"""

# %% Build the two FMUs and pack the SSP file
import matplotlib.pyplot as plt
import numpy as np
from coupling import HERE, build, export, pack, runge_kutta, with_ecos, with_fmpy

STOP = 1.0
STEPS = (0.002, 0.001)
NAMES = ("cylinder.stroke", "cylinder.speed", "cylinder.pressure")

build("cylinder")
export(HERE / "crane.toml")
pack("crane", "cylinder", "crane")

# %% The same by hand: the jib with its load turns about the pivot

JIB, JIB_INERTIA, LOAD, LENGTH, G = 160.0, 165.0, 800.0, 3.50, 9.81
TOTAL = JIB_INERTIA + JIB * (LENGTH / 2) ** 2 + LOAD * LENGTH**2
MOMENT = (JIB * LENGTH / 2 + LOAD * LENGTH) * G
FOOT, LUG = 0.30 - 1.30j, 1.30 - 0.10j  # from the pivot; the lug in the frame of the jib
SHORTEST = 0.12 + 1.25
AREA, VOLUME, MODULUS, FLOW, FRICTION, PISTON, PRESSURE = 0.005, 1e-3, 1.2e9, 7.5e-4, 2e4, 15.0, 5.28e6


def ramp(time, start):
    return min(max((time - start) / 0.2, 0.0), 1.0)


def rate(time, state):
    """Rates of stroke, speed and pressure. The law of cosines gives the angle at the pivot."""
    stroke, speed, pressure = state
    length, a, b = SHORTEST + stroke, abs(FOOT), abs(LUG)
    angle = np.arccos((a**2 + b**2 - length**2) / (2 * a * b))
    lift = angle + np.angle(FOOT) - np.angle(LUG)
    lift1 = length / (a * b * np.sin(angle))
    lift2 = 1 / (a * b * np.sin(angle)) - lift1**2 / np.tan(angle)
    inertia = TOTAL * lift1**2
    bias = TOTAL * lift1 * lift2 * speed**2 + MOMENT * np.cos(lift) * lift1
    force = AREA * pressure - FRICTION * speed - bias
    flow = FLOW * (ramp(time, 0.2) - ramp(time, 1.6))
    growth = MODULUS * (flow - AREA * speed) / (VOLUME + AREA * stroke)
    return np.array([speed, force / (PISTON + inertia), growth])


FINE = 1e-4
alone = runge_kutta(rate, (0.0, 0.0, PRESSURE), FINE, round(STOP / FINE))

# %% Both masters, and how far they are off

print("host  crane              step [ms]  stroke [um]  pressure [bar]")
for h in STEPS:
    runs = {
        ("FMPy", "hold"): with_fmpy("crane", NAMES, STOP, h),
        ("FMPy", "extrapolation = 2"): with_fmpy(
            "crane", NAMES, STOP, h, {"crane.extrapolation": 2}
        ),
        ("Ecos", "hold"): with_ecos("crane", NAMES, STOP, h),
    }
    exact = alone[:: round(h / FINE)].T
    for (host, crane), found in runs.items():
        stroke, _, pressure = np.max(np.abs(found - exact[:, 1:]), axis=1)
        print(f"{host}  {crane:17}  {1e3 * h:9.1f}  {1e6 * stroke:11.3f}  {1e-5 * pressure:14.3f}")

# %% A plot

time = FINE * np.arange(len(alone))
fig, axes = plt.subplots(2, 1, sharex=True, figsize=(7, 5))
for axis, column, factor, label in ((axes[0], 1, 1.0, "speed [m/s]"), (axes[1], 2, 1e-5, "pressure [bar]")):
    axis.plot(STEPS[-1] * np.arange(1, found.shape[1] + 1), factor * found[column], label="two FMUs")
    axis.plot(time, factor * alone[:, column], "--", label="by hand")
    axis.set_ylabel(label)
axes[0].legend()
axes[1].set_xlabel("time [s]")
fig.tight_layout()
fig.savefig("crane.png", dpi=120)
