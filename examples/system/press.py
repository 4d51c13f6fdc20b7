"""A motor with a speed controller drives a press: torque goes in, the motion comes out.

The crank of the press (`press.toml`, an FMU of biela) is a freedom: the FMU integrates its motion
under the motor's torque, the work piece, friction and gravity. The motor with its controller
(`drive.c`, an FMU of its own) integrates its current and takes the speed that comes out. An SSP
file couples the two, which FMPy and Ecos simulate.

The same system by hand is Lagrange's equation of the slider-crank in the angle of its crank,

    J speed' + J' speed^2 / 2 + V' = torque + forces,    ' of J and V by the angle,

together with current and integral, integrated as a whole by Runge-Kutta. With the acceleration from
the FMU in model exchange instead, the result is the same to rounding. The masters hold torque and
speed over each step, so their largest differences are in proportion to the step.

Cells begin with `# %%`, as VS Code, Spyder and Jupytext have them; as a script it runs as well.
"""

# %% Build the two FMUs and pack the SSP file
from ctypes import c_double
from math import asin, cos, sin, tanh

import matplotlib.pyplot as plt
import numpy as np
from coupling import HERE, build, export, pack, runge_kutta, with_ecos, with_fmpy
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Model

STOP = 2.0
STEPS = (0.002, 0.001, 0.0005)
FINE = 2.5e-4
NAMES = ("press.crank_angle.velocity", "drive.current", "press.way.position")

build("drive")
export(HERE / "press.toml")
pack("press", "drive", "press")

# %% The same by hand

R, L, CENTER, G = 0.04, 0.20, 0.08, 9.81
CRANK_INERTIA, ROD, ROD_INERTIA, RAM = 2.5, 3.0, 0.012, 12.0
OIL, HEIGHT, STRENGTH, CREEP = 60.0, 0.010, 12e3, 0.02
TARGET, PROPORTIONAL, INTEGRAL = 10.0, 3.0, 10.0
RESISTANCE, INDUCTANCE, CONSTANT = 0.5, 0.01, 2.0


def way(angle):
    """Way of the ram below the crank's pivot."""
    return R * np.cos(angle) + L * np.sqrt(1 - (R / L * np.sin(angle)) ** 2)


def by_hand(angle, speed, torque):
    """Acceleration of the crank. The real axis of the complex plane points down."""
    # The rod's angle with its derivatives by the crank's.
    tilt = -asin(R * sin(angle) / L)
    tilt1 = -R * cos(angle) / (L * cos(tilt))
    tilt2 = (R * sin(angle) / L + sin(tilt) * tilt1**2) / cos(tilt)
    pin = R * complex(cos(angle), sin(angle))
    rod = complex(cos(tilt), sin(tilt))
    rod1, rod2 = 1j * tilt1 * rod, (1j * tilt2 - tilt1**2) * rod
    center1, center2 = 1j * pin + CENTER * rod1, -pin + CENTER * rod2
    ram1, ram2 = (1j * pin + L * rod1).real, (-pin + L * rod2).real
    inertia = CRANK_INERTIA + ROD * abs(center1) ** 2 + ROD_INERTIA * tilt1**2 + RAM * ram1**2
    half_inertia1 = ROD * (center1.conjugate() * center2).real + ROD_INERTIA * tilt1 * tilt2
    half_inertia1 += RAM * ram1 * ram2
    weight = (ROD * center1.real + RAM * ram1) * G
    depth = max((pin + L * rod).real - (R + L - HEIGHT), 0.0) / HEIGHT
    ram_speed = ram1 * speed
    force = -OIL * ram_speed - STRENGTH * depth**2 * tanh(max(ram_speed, 0.0) / CREEP)
    return (torque + weight + force * ram1 - half_inertia1 * speed**2) / inertia


def run(acceleration):
    """Angle, speed, current and integral over time."""

    def rate(_time, state):
        angle, speed, current, integral = state
        error = TARGET - speed
        voltage = PROPORTIONAL * error + INTEGRAL * integral - CONSTANT * speed
        growth = (voltage - RESISTANCE * current) / INDUCTANCE
        return np.array([speed, acceleration(angle, speed, CONSTANT * current), growth, error])

    return runge_kutta(rate, (np.radians(-170), 0.0, 0.0, 0.0), FINE, round(STOP / FINE))


alone = run(by_hand)
angle, speed, current, _ = alone.T
exact = np.array([speed, current, way(angle)])

# %% The press in model exchange: its states are angle and speed of the crank

description = read_model_description("press.fmu")
vr = {variable.name: variable.valueReference for variable in description.modelVariables}
fmu = FMU2Model(
    guid=description.guid,
    unzipDirectory=extract("press.fmu"),
    modelIdentifier=description.modelExchange.modelIdentifier,
    instanceName="press",
)
fmu.instantiate()
fmu.setupExperiment(startTime=0.0)
fmu.enterInitializationMode()
fmu.exitInitializationMode()
fmu.enterContinuousTimeMode()


def from_fmu(angle, speed, torque):
    """Acceleration of the crank."""
    fmu.setContinuousStates((c_double * 2)(angle, speed), 2)
    fmu.setReal([vr["motor.effort"]], [torque])
    return fmu.getReal([vr["crank_angle.acceleration"]])[0]


off = np.max(np.abs(run(from_fmu) - alone))
print(f"model exchange, integrated as by hand: off by {off:.0e} at most")
fmu.terminate()
fmu.freeInstance()

# %% Both masters, and how far they are off

print("host  step [ms]  speed [rad/s]  current [A]  ram [mm]")
for h in STEPS:
    for host, simulate in (("FMPy", with_fmpy), ("Ecos", with_ecos)):
        found = simulate("press", NAMES, STOP, h)
        every = round(h / FINE)
        off = np.max(np.abs(found - exact[:, every::every]), axis=1)
        print(f"{host}  {1e3 * h:9.1f}  {off[0]:13.4f}  {off[1]:11.4f}  {1e3 * off[2]:8.4f}")

# %% A plot

time = FINE * np.arange(len(alone))
fig, axes = plt.subplots(3, 1, sharex=True, figsize=(7, 6))
labels = ("speed of the crank [rad/s]", "current [A]", "way of the ram [mm]")
for axis, coupled, hand, factor, label in zip(axes, found, exact, (1, 1, 1e3), labels, strict=True):
    axis.plot(h * np.arange(1, len(coupled) + 1), factor * coupled, label="two FMUs")
    axis.plot(time, factor * hand, "--", label="by hand")
    axis.set_ylabel(label)
axes[0].legend()
axes[2].axhline(1e3 * (R + L - HEIGHT), color="gray", linewidth=0.8)  # the work piece
axes[2].invert_yaxis()
axes[2].set_xlabel("time [s]")
fig.tight_layout()
fig.savefig("press.png", dpi=120)
