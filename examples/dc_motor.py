"""A DC motor starts an engine: how uneven does its speed become?

The motor's equation needs what the mechanism does to its shaft. With `.inertia` and `.bias` of the
crank's driver it is explicit, without a loop over accelerations:

    (J_motor + inertia) alpha = k i - bias,    R i = U - k omega

The FMU is asked at any angle and speed through model exchange, and Runge-Kutta integrates. The
same start, from Lagrange's equation of the slider-crank written by hand, agrees to rounding.

Then the motor is an FMU too, written in C, and both are coupled by an SSP file, which FMPy and Ecos
simulate: the difference shrinks with the step.

The crank is driven here, and the motor integrates the motion of both. In `system/press.py` the
crank is a freedom, which the motor's torque moves.

    python dc_motor.py
"""

import os
import subprocess
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Model

sys.path.append(str(Path(__file__).resolve().parent / "system"))
from coupling import build, pack, runge_kutta, with_ecos, with_fmpy

SMALL = os.environ.get("BIELA_EXAMPLE") == "small"

VOLTAGE, RESISTANCE, CONSTANT, MOTOR_INERTIA = 24.0, 0.1, 0.12, 0.004
STEP, STEPS = 2e-4, 500 if SMALL else 5000
HEAT, PRESSURE = 0.0, 2e4

# %% The FMU: a compressor, as nothing burns in it

subprocess.run(["biela", "new", "compressor", "--from", "engine"], check=True)
file = Path("compressor.toml")
text = file.read_text(encoding="utf-8")
for engine, compressor in [
    ('start = "40*deg"', "start = 0"),
    ("heat         = { value = 2.5", f"heat = {{ value = {HEAT}"),
    ("pressure     = { value = 1e5", f"pressure = {{ value = {PRESSURE}"),
]:
    assert engine in text
    text = text.replace(engine, compressor)
file.write_text(text, encoding="utf-8")
subprocess.run(["biela", "export", "compressor.toml"], check=True)
folder = extract("compressor.fmu")
description = read_model_description(folder)
vr = {variable.name: variable.valueReference for variable in description.modelVariables}
fmu = FMU2Model(
    guid=description.guid,
    unzipDirectory=folder,
    modelIdentifier=description.modelExchange.modelIdentifier,
    instanceName="compressor",
)
fmu.instantiate()
fmu.setupExperiment(startTime=0.0)
inputs = [vr["crank_angle.position"], vr["crank_angle.velocity"]]
outputs = [vr["crank_angle.inertia"], vr["crank_angle.bias"]]
fmu.enterInitializationMode()
fmu.exitInitializationMode()
fmu.enterContinuousTimeMode()


def from_fmu(angle, speed):
    """Inertia and bias of the crank at an angle and a speed."""
    fmu.setReal(inputs, [angle, speed])
    return fmu.getReal(outputs)


# %% The same by hand

R, L, CLEARANCE, AREA, EXPONENT, G = 0.030, 0.110, 0.008, 0.0025, 1.3, 9.81
#: Mass and moment of inertia of crank, rod and piston.
BODIES = [(1.2, 0.0012), (0.25, 0.0004), (0.20, 0.0)]


def by_hand(angle, speed):
    """Inertia J and bias J' omega^2 / 2 + V' - Q, by Lagrange's equation."""
    sin, cos = np.sin(angle), np.cos(angle)
    # The rod's angle with its derivatives by the crank's.
    tilt = -np.arcsin(R * sin / L)
    tilt1 = -R * cos / (L * np.cos(tilt))
    tilt2 = (R * sin / L + np.sin(tilt) * tilt1**2) / np.cos(tilt)
    pin = R * np.exp(1j * angle)
    rod = np.exp(1j * tilt)
    rod1, rod2 = 1j * tilt1 * rod, (1j * tilt2 - tilt1**2) * rod
    piston1, piston2 = 1j * pin + L * rod1, -pin + L * rod2
    crank = np.exp(1j * angle)  # its centre of mass is 5 mm behind the axle
    turns = [(1.0, 0.0), (tilt1, tilt2), (0.0, 0.0)]
    places = [
        (-0.005j * crank, 0.005 * crank),
        (1j * pin + 0.3 * L * rod1, -pin + 0.3 * L * rod2),
        (piston1, piston2),
    ]
    inertia, bias = 0.0, 0.0
    for (mass, own), (turn1, turn2), (way1, way2) in zip(BODIES, turns, places, strict=True):
        inertia += mass * abs(way1) ** 2 + own * turn1**2
        bias += (mass * (way1.conjugate() * way2).real + own * turn1 * turn2) * speed**2
        bias += mass * G * way1.imag
    length = R + L + CLEARANCE - (pin + L * rod).real
    gas = -AREA * PRESSURE * ((2 * R + CLEARANCE) / length) ** EXPONENT
    return inertia, bias - gas * piston1.real


# %% The start


def acceleration(model, angle, speed):
    inertia, bias = model(angle, speed)
    torque = CONSTANT * (VOLTAGE - CONSTANT * speed) / RESISTANCE
    return (torque - bias) / (MOTOR_INERTIA + inertia)


def run(model):
    """Angle and speed over time."""

    def rate(_time, state):
        return np.array([state[1], acceleration(model, *state)])

    return runge_kutta(rate, (0.0, 0.0), STEP, STEPS)


with_fmu, alone = run(from_fmu), run(by_hand)
difference = np.max(np.abs(with_fmu - alone)) / np.max(np.abs(alone))
speed = with_fmu[-STEPS // 4 :, 1]
print(f"largest difference from the equations by hand: {difference:.1e}")
print(f"the speed swings between {speed.min():.2f} and {speed.max():.2f} rad/s")
fmu.terminate()
fmu.freeInstance()

# %% The motor as an FMU beside the compressor's, in two masters

build("dc_motor")
pack("compressor", "dc_motor", "compressor")
stop = STEP * STEPS
for refine in (1, 2):
    h = STEP / refine
    for host, simulate in (("FMPy", with_fmpy), ("Ecos", with_ecos)):
        (coupled,) = simulate("compressor", ["motor.speed"], stop, h)
        off = np.max(np.abs(coupled[refine - 1 :: refine] - alone[1:, 1]))
        print(f"{host} with a step of {1e3 * h:.1f} ms: speed off by {off:.3f} rad/s at most")

# %% A plot

time = STEP * np.arange(STEPS + 1)
plt.figure(figsize=(7, 3.5))
plt.plot(time, with_fmu[:, 1], label="with the FMU")
plt.plot(time, alone[:, 1], "--", label="by hand")
plt.xlabel("time [s]")
plt.ylabel("speed of the crank [rad/s]")
plt.legend()
plt.tight_layout()
plt.savefig(Path("dc_motor.png"), dpi=120)
