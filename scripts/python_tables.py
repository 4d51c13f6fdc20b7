"""Writes the tables of docs/python.md: speed of sweeps, and records of synthesis.

    PYTHONPATH=python .venv/bin/python scripts/python_tables.py

The module in python/biela should be a release build. Times are those of the machine that runs the
script; the costs of the fits are the same everywhere.
"""

from __future__ import annotations

import os
import re
import time
from pathlib import Path

import biela
import numpy as np

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "python.md"
THETA = np.radians(60) + np.linspace(0, 2 * np.pi, 361)[:-1]

PATH_GENERATOR = ROOT / "examples" / "path_generator.toml"
LENGTHS = ["r1", "r2", "r3", "r4"]
PLACES = ["px", "py", "x0", "y0"]


def speed() -> list[str]:
    """Returns the rows on sweeps of a four-bar linkage."""
    four_bar = biela.load(ROOT / "mechanisms" / "four_bar.toml")
    rows = ["| way | variants | seconds | per pose |", "|---|---|---|---|"]

    def row(way: str, variants: int, seconds: float) -> None:
        each = seconds / variants / len(THETA)
        rows.append(f"| {way} | {variants:,} | {seconds:.2f} | {1e6 * each:.2f} µs |")

    drive = {"crank_angle": (THETA, 1.0, 0.0)}
    names = ["rocker.phi", "rocker.omega", "rocker.alpha"]
    for count in (1_000, 100_000):
        base = np.random.default_rng(1).uniform(0.37, 0.43, count)
        started = time.perf_counter()
        sweep = four_bar.sweep({"base": base}, drive=drive, variables=names)
        row(f"`sweep` on {os.cpu_count()} cores", count, time.perf_counter() - started)
        assert sweep.ok.all()
    started = time.perf_counter()
    for value in base[:200]:
        four_bar.run(drive=drive, parameters={"base": value}, variables=names)
    row("`run` in a loop", 200, time.perf_counter() - started)
    started = time.perf_counter()
    for value in base[:20]:
        four_bar.run(
            drive=drive, parameters={"base": value}, variables=names, gradient=["base", "crank_length"]
        )
    row("`run` with two gradients", 20, time.perf_counter() - started)
    return rows


def cases():
    """Yields name, target, free parameters, bounds and published cost of each case."""
    near = lambda low, high: {name: (low, high) for name in LENGTHS}
    far = lambda names, reach: {name: (-reach, reach) for name in names}
    timed = [[3, 3], [2.759, 3.363], [2.372, 3.663], [1.890, 3.862], [1.355, 3.943]]
    angles = np.radians([30, 45, 60, 75, 90])
    yield (
        "five timed points",
        biela.points("coupler.P", timed, drive={"theta": angles}),
        [*LENGTHS, "px", "py"],
        {**near(0.01, 50), **far(["px", "py"], 50)},
        1.924e-6,
    )
    line = [[20, y] for y in range(20, 50, 5)]
    yield (
        "six points on a line",
        biela.points("coupler.P", line, free="theta"),
        [*LENGTHS, *PLACES, "tilt"],
        {**near(5, 60), **far(PLACES, 60), "tilt": (0, 2 * np.pi)},
        None,
    )
    circle = [
        [20, 10], [17.66, 15.142], [11.736, 17.878], [5, 16.928], [0.60307, 12.736],
        [0.60307, 7.2638], [5, 3.0718], [11.736, 2.1215], [17.66, 4.8577], [20, 10],
    ]  # fmt: skip
    yield (
        "ten points on a circle",
        biela.points("coupler.P", circle, free="theta"),
        [*LENGTHS, *PLACES, "tilt"],
        {**near(5, 80), **far(PLACES, 80), "tilt": (0, 2 * np.pi)},
        4.2014e-4,
    )


def synthesis(starts: int = 40, samples: int = 20_000) -> list[str]:
    """Returns the rows on published cases."""
    generator = biela.load(PATH_GENERATOR)
    rows = [
        "| case | best published | biela | crank turns | seconds | motions |",
        "|---|---|---|---|---|---|",
    ]
    for name, target, free, bounds, published in cases():
        started = time.perf_counter()
        found = biela.fit(
            generator, target, free, bounds, starts=starts, samples=samples, stop_at=1e-20
        )
        seconds = time.perf_counter() - started
        turns = "yes" if found.mechanism.range("theta").turns else "no"
        record = f"{published:.4g}" if published else "–"
        rows.append(
            f"| {name} | {record} | {found.cost:.4g} | {turns} | {seconds:.1f} "
            f"| {found.evaluations:,} |"
        )
        print(rows[-1], {k: round(v, 6) for k, v in found.parameters.items()}, flush=True)
    return rows


def write(tables: dict[str, list[str]]) -> None:
    """Puts the tables between their marks."""
    page = PAGE.read_text(encoding="utf-8")
    for name, rows in tables.items():
        mark = rf"(<!-- {name} -->\n).*?(<!-- /{name} -->)"
        table = "\n".join(rows)
        page, count = re.subn(mark, lambda m: f"{m[1]}\n{table}\n\n{m[2]}", page, flags=re.DOTALL)
        assert count == 1, f"no marks of {name}"
    PAGE.write_text(page, encoding="utf-8")


if __name__ == "__main__":
    write({"speed": speed(), "synthesis": synthesis()})
