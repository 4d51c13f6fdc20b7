"""A sweep of the Python module under Dask: chunks of variants as tasks, on one machine or many.

Which lengths of coupler and rocker transmit force best? A mechanism goes to other processes with
its file; each task sweeps its own variants. The results are the same bits as those of one call.

    python sweep_on_dask.py

With `Client("scheduler:8786")` from dask.distributed before the call, the same tasks run on the
workers of a cluster, each of which has the wheel of biela installed.
"""

import os
import time
from pathlib import Path

import biela
import dask
import numpy as np

HERE = Path(__file__).resolve().parent
SMALL = os.environ.get("BIELA_EXAMPLE") == "small"

LENGTHS = np.linspace(0.151, 0.60, 12 if SMALL else 200)
THETA = np.pi / 3 + np.linspace(0, 2 * np.pi, 37 if SMALL else 361)
CHUNKS = 8


def least_angles(mechanism, coupler, rocker):
    """The least transmission angle [rad] of each variant on a turn of the crank, or NaN."""
    sweep = mechanism.sweep(
        {"coupler_length": coupler, "rocker_length": rocker},
        drive={"crank_angle": THETA},
        variables=["transmission.position"],
    )
    angle = np.abs(sweep["transmission.position"]) % np.pi
    least = np.minimum(angle, np.pi - angle).min(axis=-1)
    return np.where(sweep.ok, least, np.nan)


def under_dask(mechanism, coupler, rocker, **where):
    """The same in chunks, one Dask task each."""
    parts = zip(np.array_split(coupler, CHUNKS), np.array_split(rocker, CHUNKS))
    tasks = [dask.delayed(least_angles)(mechanism, *part) for part in parts]
    return np.concatenate(dask.compute(*tasks, **where))


def main():
    mechanism = biela.load(HERE.parent / "mechanisms" / "four_bar.toml")
    coupler, rocker = (grid.ravel() for grid in np.meshgrid(LENGTHS, LENGTHS, indexing="ij"))
    print(f"{len(coupler)} variants of {len(THETA)} poses")

    ways = {
        "one call": lambda: least_angles(mechanism, coupler, rocker),
        "Dask, in this process": lambda: under_dask(
            mechanism, coupler, rocker, scheduler="synchronous"
        ),
        "Dask, 2 processes": lambda: under_dask(
            mechanism, coupler, rocker, scheduler="processes", num_workers=2
        ),
    }
    angles, alone = None, None
    for way, evaluate in ways.items():
        start = time.perf_counter()
        found = evaluate()
        seconds = time.perf_counter() - start
        if angles is None:
            angles, alone = found, seconds
        same = np.array_equal(found, angles, equal_nan=True)
        print(
            f"{way:22} {seconds:6.2f} s   {seconds / alone:5.2f} times one call   "
            f"{'same bits' if same else 'OTHER RESULTS'}"
        )

    best = np.nanargmax(angles)
    print(f"{np.count_nonzero(~np.isnan(angles))} cranks turn fully")
    print(
        f"best: coupler {1e3 * coupler[best]:.0f} mm, rocker {1e3 * rocker[best]:.0f} mm, "
        f"never below {np.degrees(angles[best]):.1f} deg"
    )


if __name__ == "__main__":
    main()
