"""Writes the tables of docs/python.md: speed of sweeps, Dask, errors of gradients, records of synthesis.

    python -m venv env && env/bin/pip install biela.whl fmpy mpmath pylinkage numba casadi dask scipy
    env/bin/python scripts/python_tables.py [speed] [dask] [gradients] [synthesis]

The module must be a release build, such as that of the wheel. Without arguments all tables are
written. A way whose package is missing has no row. Times are those of all processors together, so
that other work on the machine counts little: compare rows of one table only. Errors and costs are
the same everywhere.
"""

from __future__ import annotations

import importlib.util
import itertools
import os
import re
import sys
import tempfile
import time
from pathlib import Path

import biela
import numpy as np

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "python.md"
FOUR_BAR = ROOT / "mechanisms" / "four_bar.toml"
PATH_GENERATOR = ROOT / "examples" / "path_generator.toml"

START = np.pi / 3
THETA = START + np.linspace(0, 2 * np.pi, 361)[:-1]
CRANK, COUPLER, ROCKER, BASE = 0.10, 0.25, 0.30, 0.40
ROUNDS = 3
"""Number of times that each way is measured; the best counts, as other work only adds."""
AGREED = 1e-9
"""Largest difference of two ways [rad, rad/s, rad/s²]: far above rounding, far below a mistake."""


def bases(count: int) -> np.ndarray:
    """Returns lengths of the base with which the crank turns fully."""
    return np.random.default_rng(1).uniform(0.37, 0.43, count)


# ---------------------------------------------------------------------------------------------
# Speed. Each way is made once with its number of variants, and returns a function that gives the
# rocker's angle, velocity and acceleration by variant and pose, at one rad/s of the crank.


def sweep_of_biela(count: int):
    four_bar = biela.load(FOUR_BAR)
    names = ["rocker.phi", "rocker.omega", "rocker.alpha"]

    def run():
        sweep = four_bar.sweep(
            {"base": bases(count)}, drive={"crank_angle": (THETA, 1.0, 0.0)}, variables=names
        )
        assert sweep.ok.all()
        return [sweep[name] for name in names]

    return run


def loop_of_runs(count: int):
    four_bar = biela.load(FOUR_BAR)
    names = ["rocker.phi", "rocker.omega", "rocker.alpha"]

    def run():
        drive = {"crank_angle": (THETA, 1.0, 0.0)}
        results = [
            four_bar.run(drive=drive, parameters={"base": base}, variables=names)
            for base in bases(count)
        ]
        return [np.array([result[name] for result in results]) for name in names]

    return run


def closed_form(count: int):
    """The rocker's pin as the intersection of two circles, in NumPy; rates by its loop equations."""

    def run():
        base = bases(count)[:, None]
        x, y = CRANK * np.cos(THETA) - base, CRANK * np.sin(THETA)
        square = x * x + y * y
        cosine = (ROCKER**2 + square - COUPLER**2) / (2 * ROCKER * np.sqrt(square))
        psi = np.arctan2(y, x) - np.arccos(cosine)
        phi = np.arctan2(ROCKER * np.sin(psi) - y, ROCKER * np.cos(psi) - x)
        det = ROCKER * np.sin(psi - phi)
        omega = CRANK * np.sin(THETA - phi) / det
        omega_phi = CRANK * np.sin(THETA - psi) / (COUPLER * np.sin(psi - phi))
        alpha = (
            CRANK * np.cos(THETA - phi) + COUPLER * omega_phi**2
            - ROCKER * np.cos(psi - phi) * omega**2
        ) / det  # fmt: skip
        return [psi, omega, alpha]

    return run


def loop_of_fmpy(count: int):
    """An FMU in FMPy, on its functions of FMI 2.0 without its conveniences."""
    from fmpy import extract, read_model_description
    from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions

    folder = tempfile.mkdtemp()
    archive = biela.load(FOUR_BAR).export(Path(folder) / "four_bar.fmu")
    unpacked = extract(str(archive), unzipdir=f"{folder}/four_bar")
    description = read_model_description(unpacked)
    vr = {variable.name: variable.valueReference for variable in description.modelVariables}
    fmu = FMU2Slave(
        guid=description.guid,
        unzipDirectory=unpacked,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="variant",
    )
    fmu.instantiate(callbacks=fmi2CallbackFunctions(), loggingOn=False)
    inputs = [vr[f"crank_angle.{order}"] for order in ("position", "velocity", "acceleration")]
    outputs = [vr[f"rocker.{order}"] for order in ("phi", "omega", "alpha")]

    def run():
        found = np.empty((3, count, len(THETA)))
        for variant, base in enumerate(bases(count)):
            fmu.reset()
            fmu.setupExperiment(startTime=0.0)
            fmu.setReal([vr["base"]], [base])
            fmu.setReal(inputs, [THETA[0], 1.0, 0.0])
            fmu.enterInitializationMode()
            fmu.exitInitializationMode()
            for pose, theta in enumerate(THETA):
                fmu.setReal(inputs, [theta, 1.0, 0.0])
                fmu.doStep(float(pose), 1.0)
                found[:, variant, pose] = fmu.getReal(outputs)
        return list(found)

    return run


def loop_of_pylinkage(count: int):
    from pylinkage.actuators import Crank
    from pylinkage.components import Ground
    from pylinkage.dyads import RRRDyad
    from pylinkage.simulation import Linkage

    step = THETA[1] - THETA[0]

    def run():
        found = []
        for base in bases(count):
            # It moves by a step before it records.
            at = START - step
            crank = Crank(
                anchor=Ground(0.0, 0.0), radius=CRANK, angular_velocity=step, initial_angle=at
            )
            pivot = Ground(base, 0.0)
            dyad = RRRDyad(
                anchor1=crank.output, anchor2=pivot, distance1=COUPLER, distance2=ROCKER
            )
            linkage = Linkage([crank.anchor, pivot, crank, dyad])
            linkage.set_input_velocity(crank, 1.0, 0.0)
            position, velocity, acceleration = (
                each[:, -1] for each in linkage.step_fast_with_kinematics(len(THETA))
            )
            arm = position - [base, 0.0]
            cross = lambda b: (arm[:, 0] * b[:, 1] - arm[:, 1] * b[:, 0]) / ROCKER**2
            found.append([np.arctan2(arm[:, 1], arm[:, 0]), cross(velocity), cross(acceleration)])
        return list(np.moveaxis(np.array(found), 0, 1))

    return run


def map_of_casadi(count: int):
    """Newton's method from pose to pose, mapped over variants on all cores."""
    import casadi

    x = casadi.SX.sym("x", 2)
    p = casadi.SX.sym("p", 2)
    angles = [(CRANK, p[0]), (COUPLER, x[0]), (-ROCKER, x[1])]
    closure = casadi.vertcat(
        sum(length * casadi.cos(angle) for length, angle in angles) - p[1],
        sum(length * casadi.sin(angle) for length, angle in angles),
    )
    newton = casadi.rootfinder("newton", "fast_newton", {"x": x, "p": p, "g": closure})
    jacobian = casadi.jacobian(closure, x)
    velocity = -casadi.solve(jacobian, casadi.jacobian(closure, p[0]))
    along = lambda f: casadi.jacobian(f, x) @ velocity + casadi.jacobian(f, p[0])
    rates = casadi.Function("rates", [x, p], [velocity, along(velocity)])
    last, theta, base = casadi.MX.sym("last", 2), casadi.MX.sym("theta"), casadi.MX.sym("base")
    pose = newton(last, casadi.vertcat(theta, base))
    velocity, acceleration = rates(pose, casadi.vertcat(theta, base))
    outputs = casadi.vertcat(pose[1], velocity[1], acceleration[1])
    turn = casadi.Function("step", [last, theta, base], [pose, outputs]).mapaccum(len(THETA))
    each = casadi.MX.sym("each", 1)
    start = casadi.DM([0.4, 2.0])
    _, outputs = turn(start, casadi.DM(THETA).T, casadi.repmat(each, 1, len(THETA)))
    variant = casadi.Function("variant", [each], [outputs])
    mapped = variant.map(count, "thread", os.cpu_count() or 1)

    def run():
        found = np.array(mapped(casadi.DM(bases(count)).T))
        return list(found.reshape(3, count, len(THETA)))

    return run


WAYS = [
    # Way, package that it needs besides, number of variants, whether it uses all cores.
    ("`sweep`", sweep_of_biela, None, 100_000, True),
    ("`run` in a loop", loop_of_runs, None, 500, False),
    ("closed form of this four-bar in NumPy", closed_form, None, 2_000, False),
    ("CasADi, `map` over Newton's method", map_of_casadi, "casadi", 1_000, True),
    ("pylinkage with numba, in a loop", loop_of_pylinkage, "pylinkage", 200, False),
    ("the FMU in FMPy, in a loop", loop_of_fmpy, "fmpy", 20, False),
]


def speed() -> list[str]:
    """Returns the rows on sweeps of a four-bar linkage."""
    rows = ["| way | cores | variants | CPU seconds | per pose | ratio |", "|---|---|---|---|---|---|"]
    ready = []
    for name, make, package, count, parallel in WAYS:
        if package is not None and importlib.util.find_spec(package) is None:
            print(f"no {package}: `{name}` is left out")
            continue
        # Compiles what it has to; and its numbers are those of the closed form.
        reference, found = closed_form(5)(), make(5)()
        for ours, theirs in zip(found, reference, strict=True):
            error = np.abs(np.exp(1j * ours) - np.exp(1j * theirs)).max()
            assert error < AGREED, (name, error)
        ready.append((name, make(count), count, parallel))
    best = [np.inf] * len(ready)
    for _ in range(ROUNDS):
        for place, (_, run, _, _) in enumerate(ready):
            started = time.process_time()
            run()
            best[place] = min(best[place], time.process_time() - started)
    each = [seconds / count / len(THETA) for seconds, (_, _, count, _) in zip(best, ready)]
    for (name, _, count, parallel), seconds, own in zip(ready, best, each):
        cores = os.cpu_count() if parallel else 1
        cells = name, cores, f"{count:,}", f"{seconds:.2f}", f"{1e6 * own:.2f} µs"
        rows.append(f"| {' | '.join(map(str, cells))} | {own / each[0]:.3g} |")
        print(rows[-1], flush=True)
    return rows


# ---------------------------------------------------------------------------------------------
# Dask

DASK_CHUNKS = 8
TASKS = 200
"""Number of tasks whose share of Dask's own work is measured."""


def rocker_of(mechanism, base):
    """Returns the rocker's angle of variants, for a task of Dask."""
    return mechanism.sweep({"base": base}, drive={"crank_angle": THETA}, variables=["rocker.phi"])[
        "rocker.phi"
    ]


def under_dask() -> list[str]:
    """Returns the rows on one sweep in tasks of Dask."""
    if importlib.util.find_spec("dask") is None:
        print("no dask: its table is left out")
        return []
    import dask

    four_bar = biela.load(FOUR_BAR)
    base = bases(5_000)

    def in_tasks(**where):
        parts = np.array_split(base, DASK_CHUNKS)
        tasks = [dask.delayed(rocker_of)(four_bar, part) for part in parts]
        return lambda: np.concatenate(dask.compute(*tasks, **where))

    ways = {
        "one call of `sweep`": lambda: rocker_of(four_bar, base),
        "8 tasks, in threads": in_tasks(scheduler="threads"),
        "8 tasks, in 2 processes": in_tasks(scheduler="processes", num_workers=2),
    }

    def spent() -> float:
        """Returns the time of this process and of those that have ended [s]."""
        return sum(os.times()[:4])

    rows = ["| way | CPU seconds | ratio |", "|---|---|---|"]
    best = dict.fromkeys(ways, np.inf)
    expected = rocker_of(four_bar, base)
    for _ in range(ROUNDS):
        for way, run in ways.items():
            started = spent()
            assert np.array_equal(run(), expected)
            best[way] = min(best[way], spent() - started)
    alone = best["one call of `sweep`"]
    for way, seconds in best.items():
        rows.append(f"| {way} | {seconds:.2f} | {seconds / alone:.2f} |")
        print(rows[-1], flush=True)
    nothing = [dask.delayed(abs)(1)] + [dask.delayed(abs)(n) for n in range(TASKS)]
    started = spent()
    dask.compute(*nothing, scheduler="threads")
    rows.append(f"| a task that does nothing, in threads | {(spent() - started) / TASKS:.1g} | |")
    print(rows[-1], flush=True)
    return rows


# ---------------------------------------------------------------------------------------------
# Gradients


def exact_rocker(parameter: str):
    """Returns derivatives of the rocker's angle, velocity and acceleration in fifty digits, by the
    closed form, at each of some poses."""
    import mpmath

    mpmath.mp.dps = 50

    def angle(crank, base, theta):
        x, y = crank * mpmath.cos(theta) - base, crank * mpmath.sin(theta)
        square = x * x + y * y
        cosine = (mpmath.mpf(3) ** 2 / 100 + square - mpmath.mpf(1) / 16) / (
            2 * mpmath.mpf(3) / 10 * mpmath.sqrt(square)
        )
        return mpmath.atan2(y, x) - mpmath.acos(cosine)

    at = mpmath.mpf(1) / 10, mpmath.mpf(4) / 10
    by = (1, 0) if parameter == "crank_length" else (0, 1)
    # The crank turns by one rad/s, so that derivatives by time are those by its angle.
    return np.array(
        [
            [float(mpmath.diff(angle, (*at, mpmath.mpf(theta)), (*by, n))) for theta in POSES]
            for n in range(3)
        ]
    )


POSES = THETA[::24]
ROCKER_ORDERS = ["rocker.phi", "rocker.omega", "rocker.alpha"]


def complex_step(parameter: str) -> np.ndarray:
    """Returns derivatives of the rocker's angle by a complex step on the closed form."""
    size = 1e-30
    crank = CRANK + (1j * size if parameter == "crank_length" else 0)
    base = BASE + (1j * size if parameter == "base" else 0)
    x, y = crank * np.cos(POSES) - base, crank * np.sin(POSES)
    distance = np.sqrt(x * x + y * y)
    cosine = (ROCKER**2 + x * x + y * y - COUPLER**2) / (2 * ROCKER * distance)
    # Another branch of the arc tangent differs by a real number.
    return (np.arctan(y / x) - np.arccos(cosine)).imag / size


def gradients() -> list[str]:
    """Returns the rows on errors of derivatives by the crank's length and the base."""
    four_bar = biela.load(FOUR_BAR)
    drive = {"crank_angle": (POSES, 1.0, 0.0)}
    own = {"crank_length": CRANK, "base": BASE}

    def values(**parameters):
        result = four_bar.run(drive=drive, parameters=parameters, variables=ROCKER_ORDERS)
        return np.array([result[name] for name in ROCKER_ORDERS])

    def differences(parameter: str, step: float) -> np.ndarray:
        up, down = (values(**{parameter: own[parameter] + sign * step}) for sign in (1, -1))
        return (up - down) / (2 * step)

    run = four_bar.run(drive=drive, variables=ROCKER_ORDERS, gradient=list(own))
    exact = {parameter: exact_rocker(parameter) for parameter in own}

    def errors(ways) -> list[str]:
        """Returns the largest error of each order, relative to the largest derivative."""
        sizes = [
            max(
                np.abs(ways(parameter)[order] - exact[parameter][order]).max()
                / np.abs(exact[parameter][order]).max()
                for parameter in own
            )
            for order in range(3)
        ]
        return [f"{size:.0e}" for size in sizes]

    rows = ["| way | angle | velocity | acceleration |", "|---|---|---|---|"]

    def row(name: str, cells: list[str]) -> None:
        rows.append(f"| {name} | {' | '.join(cells)} |")
        print(rows[-1], flush=True)

    analytic = lambda p: np.array([run.gradient[name, p] for name in ROCKER_ORDERS])
    row("`gradient`", errors(analytic))
    for step in (1e-8, 1e-6, 1e-4):
        row(f"central differences, step {1e3 * step:g} mm", errors(lambda p: differences(p, step)))
    error = max(
        np.abs(complex_step(p) - exact[p][0]).max() / np.abs(exact[p][0]).max() for p in own
    )
    row("complex step on the closed form", [f"{error:.0e}", "–", "–"])
    return rows


# ---------------------------------------------------------------------------------------------
# Synthesis

LENGTHS = ["r1", "r2", "r3", "r4"]
PLACES = ["px", "py", "x0", "y0"]
SUFFICIENT = 1e-26
"""Cost at which a search ends: 12 values of about 40 m, each rounded by 7e-15, have 6e-28."""


def cases():
    """Yields name, target, free parameters, bounds, best published cost of each case, and the effort
    that its fit takes.

    The costs are the best in the records of doi:10.3390/sym14020381. There the points without
    timing are passed in their order.
    """
    near = lambda low, high: {name: (low, high) for name in LENGTHS}
    far = lambda names, reach: {name: (-reach, reach) for name in names}
    timed = [[3, 3], [2.759, 3.363], [2.372, 3.663], [1.890, 3.862], [1.355, 3.943]]
    yield (
        "five timed points",
        biela.points("coupler.P", timed, drive={"theta": np.radians([30, 45, 60, 75, 90])}),
        [*LENGTHS, "px", "py"],
        {**near(0.01, 50), **far(["px", "py"], 50)},
        "1.924e-6",
        {"starts": 20, "samples": 1000},
    )
    line = [[20, y] for y in range(20, 50, 5)]
    yield (
        "six points on a line",
        biela.points("coupler.P", line, free="theta", in_order=True),
        [*LENGTHS, *PLACES, "tilt"],
        {**near(5, 60), **far(PLACES, 60), "tilt": (0, 2 * np.pi)},
        "8.8e-29",
        {"starts": 100, "samples": 3000, "variations": 40},
    )
    ellipse = [
        [20, 10], [17.66, 15.142], [11.736, 17.878], [5, 16.928], [0.60307, 12.736],
        [0.60307, 7.2638], [5, 3.0718], [11.736, 2.1215], [17.66, 4.8577], [20, 10],
    ]  # fmt: skip
    yield (
        "ten points on an ellipse",
        biela.points("coupler.P", ellipse, free="theta", in_order=True),
        [*LENGTHS, *PLACES, "tilt"],
        {**near(5, 80), **far(PLACES, 80), "tilt": (0, 2 * np.pi)},
        "4.02e-4",
        {"starts": 60, "samples": 5000},
    )


def synthesis() -> list[str]:
    """Returns the rows on published cases."""
    generator = biela.load(PATH_GENERATOR)
    rows = [
        "| case | best published | `fit` | crank turns | CPU seconds | evaluations |",
        "|---|---|---|---|---|---|",
    ]
    for (name, target, free, bounds, published, effort), turns in itertools.product(
        cases(), (None, "theta")
    ):
        started = time.process_time()
        found = biela.fit(generator, target, free, bounds, turns=turns, stop_at=SUFFICIENT, **effort)
        seconds = time.process_time() - started
        fully = "asked for" if turns else "yes" if found.mechanism.range("theta").turns else "no"
        cells = name, published, f"{found.cost:.3g}", fully, f"{seconds:.1f}", f"{found.evaluations:,}"
        rows.append(f"| {' | '.join(cells)} |")
        print(rows[-1], {k: round(v, 6) for k, v in found.parameters.items()}, flush=True)
    return rows


def write(name: str, rows: list[str]) -> None:
    """Puts a table between its marks."""
    if not rows:
        return
    page = PAGE.read_text(encoding="utf-8")
    mark = rf"(<!-- {name} -->\n).*?(<!-- end -->)"
    table = "".join(f"{row}\n" for row in rows)
    page, count = re.subn(mark, lambda m: f"{m[1]}{table}{m[2]}", page, flags=re.DOTALL)
    assert count == 1, f"no marks of {name}"
    PAGE.write_text(page, encoding="utf-8")


if __name__ == "__main__":
    tables = {"speed": speed, "dask": under_dask, "gradients": gradients, "synthesis": synthesis}
    for name in sys.argv[1:] or tables:
        write(name, tables[name]())
