"""Thousands of variants of a four-bar on Dask: which lengths transmit force best?

For each pair of coupler and rocker lengths the crank is turned once, and the least transmission
angle on the way is kept; a variant whose crank cannot turn has none. The variants are divided
into chunks, which Dask gives to processes. Each process loads the FMU once a chunk and resets it
from variant to variant.

    python dask_sweep.py

As processes read this file again, all that runs stands below `if __name__ == "__main__"`.
"""

import os
import subprocess
import time
from pathlib import Path

import dask.bag
import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions

HERE = Path(__file__).resolve().parent
SMALL = os.environ.get("BIELA_EXAMPLE") == "small"

CRANK, BASE = 0.10, 0.40
LENGTHS = np.linspace(0.151, 0.60, 10 if SMALL else 128)
STEPS = 36 if SMALL else 360


# %% One chunk of variants, in one process


def least_transmission_angles(folder, variants):
    """The least transmission angle [rad] of each variant (coupler, rocker), or NaN."""
    description = read_model_description(folder)
    vr = {variable.name: variable.valueReference for variable in description.modelVariables}
    fmu = FMU2Slave(
        guid=description.guid,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="variant",
    )
    # Without a logger: cranks that cannot turn are expected here.
    fmu.instantiate(callbacks=fmi2CallbackFunctions(), loggingOn=False)
    lengths = [vr["coupler_length"], vr["rocker_length"]]
    crank, transmission = [vr["crank_angle.position"]], [vr["transmission.position"]]
    found = []
    for variant in variants:
        least = np.inf
        try:
            fmu.setupExperiment(startTime=0.0)
            fmu.setReal(lengths, variant)
            fmu.enterInitializationMode()
            fmu.exitInitializationMode()
            for step in range(STEPS):
                fmu.setReal(crank, [np.pi / 3 + 2 * np.pi * (step + 1) / STEPS])
                fmu.doStep(step / STEPS, 1 / STEPS)
                angle = abs(fmu.getReal(transmission)[0]) % np.pi
                least = min(least, angle, np.pi - angle)
        except FMICallException:  # it does not close, or meets a dead point
            least = np.nan
        found.append(least)
        fmu.reset()
    fmu.freeInstance()
    return found


def evaluate(folder, variants, workers):
    """All variants on so many processes; on none of its own with `workers` = 0."""
    chunks = np.array_split(variants, max(1, 8 * workers))
    bag = dask.bag.from_sequence(chunks, npartitions=len(chunks))
    bag = bag.map(lambda chunk: least_transmission_angles(folder, chunk)).flatten()
    if workers == 0:
        return np.array(bag.compute(scheduler="synchronous"))
    return np.array(bag.compute(scheduler="processes", num_workers=workers, chunksize=1))


# %% The closed form, to compare with


def closed_form(coupler, rocker):
    """The least transmission angle is where the crank lies on the base (law of cosines), if the
    crank turns fully (Grashof)."""
    turns = (np.abs(coupler - rocker) < BASE - CRANK) & (BASE + CRANK < coupler + rocker)
    least = np.full(coupler.shape, np.inf)
    for side in (BASE - CRANK, BASE + CRANK):
        with np.errstate(invalid="ignore"):
            angle = np.arccos((coupler**2 + rocker**2 - side**2) / (2 * coupler * rocker))
        least = np.minimum(least, np.minimum(angle, np.pi - angle))
    return np.where(turns, least, np.nan)


def plot(angles):
    import matplotlib.pyplot as plt

    figure, ax = plt.subplots(figsize=(6, 5), layout="constrained")
    mesh = ax.pcolormesh(1e3 * LENGTHS, 1e3 * LENGTHS, np.degrees(angles), shading="nearest")
    figure.colorbar(mesh, label="least transmission angle [deg]")
    ax.set(xlabel="rocker [mm]", ylabel="coupler [mm]", aspect="equal")
    ax.set_title("Four-bars whose crank turns fully")
    figure.savefig("dask_sweep.png", dpi=120)


def main():
    mechanism = HERE.parent / "mechanisms" / "four_bar.toml"
    subprocess.run(["biela", "export", mechanism, "-o", "four_bar.fmu"], check=True)
    folder = extract("four_bar.fmu")
    coupler, rocker = (grid.ravel() for grid in np.meshgrid(LENGTHS, LENGTHS, indexing="ij"))
    variants = np.column_stack([coupler, rocker])
    cores = os.cpu_count() or 1
    print(f"{len(variants)} variants of {STEPS} steps on {cores} cores")

    counts = [0, 2] if SMALL else [0] + [2**n for n in range(cores.bit_length())]
    serial = None
    for workers in counts:
        start = time.perf_counter()
        angles = evaluate(folder, variants, workers)
        seconds = time.perf_counter() - start
        if serial is None:
            serial, alone = angles, seconds
            print(f"in this process   {seconds:6.2f} s")
        else:
            same = np.array_equal(angles, serial, equal_nan=True)
            print(
                f"{workers:2} processes      {seconds:6.2f} s   speed-up {alone / seconds:4.2f}"
                f"   {'same bits' if same else 'OTHER RESULTS'}"
            )

    expected = closed_form(coupler, rocker)
    turns = ~np.isnan(serial)
    agreed = "as" if np.array_equal(turns, ~np.isnan(expected)) else "NOT as"
    print(f"{np.count_nonzero(turns)} cranks turn fully, {agreed} Grashof says")
    error = np.nanmax(np.abs(serial - expected))
    print(f"largest difference from the closed form {error:.0e} rad")
    best = np.nanargmax(serial)
    print(
        f"best: coupler {1e3 * coupler[best]:.0f} mm, rocker {1e3 * rocker[best]:.0f} mm, "
        f"never below {np.degrees(serial[best]):.1f} deg"
    )
    plot(serial.reshape(len(LENGTHS), -1))


if __name__ == "__main__":
    main()
