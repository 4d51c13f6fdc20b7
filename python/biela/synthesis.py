"""Synthesis: parameters with which a mechanism goes through given values.

The optimiser is `scipy.optimize.least_squares` on exact residuals and derivatives of all targets,
which one call computes. It starts from random variants, assembled in all their assembly modes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _biela
from .errors import AssemblyError, Error, UsageError
from .mechanism import Drive, Mechanism, _orders, _reread

REFUSED = 1e6
"""Residual of a mechanism that does not reach a target: the optimiser steps back from it."""
ROUNDS = ((12, 0.25), (30, 0.25), (100, 0.25), (400, 0.0))
"""Evaluations of each attempt in a round, and the part of the attempts that goes on to the next."""


@dataclass(frozen=True)
class Target:
    """Values that variables of a mechanism shall take, one per pose, all of one length.

    `values` are by the names of variables, such as `{"coupler.P.x": […], "coupler.P.y": […]}` for
    points, with `coupler.phi` for poses, or `{"rocker.phi": […]}` for a function. `drive` has the
    drivers' values at these poses. `free` names a driver whose values are free: the points have no
    timing then. `weight` multiplies the residuals.
    """

    values: Mapping[str, ArrayLike]
    drive: Mapping[str, ArrayLike] = field(default_factory=dict)
    free: str | None = None
    weight: float = 1.0

    def arrays(self) -> tuple[list[str], NDArray]:
        """Returns the names, and the values by name, then by pose."""
        names = list(self.values)
        arrays = [np.atleast_1d(np.asarray(value, dtype=float)) for value in self.values.values()]
        if not names or len({array.shape for array in arrays}) != 1 or arrays[0].ndim != 1:
            shapes = ", ".join(f"{n} {a.shape}" for n, a in zip(names, arrays)) or "none"
            raise UsageError(f"target: expected arrays of one length; found {shapes}")
        return names, np.array(arrays)


def points(
    marker: str,
    xy: ArrayLike,
    drive: Mapping[str, ArrayLike] | None = None,
    free: str | None = None,
    weight: float = 1.0,
) -> Target:
    """Returns the target of a marker that shall go through points, rows of x and y [m].

    >>> points("coupler.P", [[3, 3], [2.759, 3.363]], free="crank_angle").values["coupler.P.y"]
    array([3.   , 3.363])
    """
    x, y = np.asarray(xy, dtype=float).T
    return Target({f"{marker}.x": x, f"{marker}.y": y}, drive or {}, free, weight)


@dataclass(frozen=True)
class Fit:
    """Mechanism that was fitted to targets."""

    mechanism: Mechanism
    """The mechanism; `write` makes a file of it."""
    parameters: dict[str, float]
    """Values of the free parameters."""
    cost: float
    """Sum of squared residuals."""
    residuals: NDArray
    """Residuals in the order of the targets: by variable, then by pose."""
    timing: tuple[NDArray | None, ...]
    """Values of the free driver of each target; `None` for prescribed timing."""
    costs: NDArray
    """Costs of all starts where they were left, ascending."""
    evaluations: int
    """Number of times that the optimiser has asked for the residuals of all targets."""

    def __repr__(self) -> str:
        return f"<biela.Fit: cost {self.cost:.3e} from {len(self.costs)} starts>"


def fit(
    mechanism: Mechanism,
    targets: Target | Sequence[Target],
    free: Sequence[str],
    bounds: Mapping[str, tuple[float, float]] | None = None,
    turns: str | None = None,
    starts: int = 1,
    samples: int = 2000,
    seed: int = 0,
    tolerance: float = 1e-15,
    stop_at: float = 0.0,
) -> Fit:
    """Finds values of the free parameters with which the mechanism meets the targets.

    Minimises the sum of squared residuals. With `starts = 1` it improves the file's own values.
    With more, the best of `samples` random variants within `bounds` are improved too, in any of
    their assembly modes; `seed` chooses the variants. Starts that fall behind are given up. It stops
    early at a cost of `stop_at`.

    `turns` names a driver that shall turn fully: mechanisms in which it cannot are refused.

    Raises `AssemblyError` if no start reaches all targets.

    >>> curve = four_bar.run(drive={"crank_angle": [1.0, 1.4, 2.0]},
    ...     parameters={"crank_length": 0.11, "rocker_length": 0.29})
    >>> target = points("coupler.P", np.transpose([curve["coupler.P.x"], curve["coupler.P.y"]]),
    ...     drive={"crank_angle": [1.0, 1.4, 2.0]})
    >>> found = fit(four_bar, target, free=["crank_length", "rocker_length"])
    >>> round(found.parameters["crank_length"], 9), round(found.parameters["rocker_length"], 9)
    (0.11, 0.29)
    """
    problem = Problem(mechanism, targets, free, bounds or {}, turns)
    attempts = problem.attempts(starts, samples, np.random.default_rng(seed))
    going_on = attempts
    for evaluations, part in ROUNDS if len(attempts) > 1 else ROUNDS[-1:]:
        for attempt in going_on:
            attempt.improve(evaluations, tolerance)
            if attempt.cost <= stop_at:
                break
        attempts.sort(key=lambda attempt: attempt.cost)
        if attempts[0].cost <= stop_at:
            break
        going_on = attempts[: max(1, round(part * len(going_on)))]
    return problem.fit(attempts)


class Problem:
    """Targets of a mechanism as a problem of least squares.

    The unknowns are the free parameters, then the free timing of each target.
    """

    def __init__(
        self,
        mechanism: Mechanism,
        targets: Target | Sequence[Target],
        free: Sequence[str],
        bounds: Mapping[str, tuple[float, float]],
        turns: str | None,
    ):
        self.mechanism = mechanism
        self.targets = [targets] if isinstance(targets, Target) else list(targets)
        self.free = list(free)
        known = mechanism.parameters
        for name in [*self.free, *bounds]:
            if name not in known:
                meant = _biela.unknown_name("parameter", name, list(known))
                raise UsageError(f"parameters: {meant}")
        self.own = np.array([known[name].value for name in self.free])
        limits = [bounds.get(name, (known[name].min, known[name].max)) for name in self.free]
        self.low = np.array([-np.inf if low is None else low for low, _ in limits], dtype=float)
        self.high = np.array([np.inf if high is None else high for _, high in limits], dtype=float)
        # The sizes of the parameters, by which the optimiser scales them.
        width = self.high - self.low
        size = np.maximum(np.abs(self.own), np.abs(self.own).max(initial=0.0) * 1e-3)
        self.size = np.where(np.isfinite(width), width, np.where(size > 0, size, 1.0))
        arrays = [target.arrays() for target in self.targets]
        self.poses = [values.shape[1] for _, values in arrays]
        self.residuals = sum(values.size for _, values in arrays)
        columns = list(mechanism.variables)
        rows = []
        for target, (names, values) in zip(self.targets, arrays):
            for name in names:
                if name not in columns:
                    meant = _biela.unknown_name("variable", name, columns)
                    raise UsageError(f"target: {meant}")
            indices = [columns.index(name) for name in names]
            poses, wanted = values.shape[1], values.ravel().tolist()
            rows.append((poses, target.free, indices, wanted, target.weight))
        drive = self.drive()
        if turns is not None:
            driver = self.driver(turns)
            if driver.unit != "rad" or (driver.start is None and turns not in drive):
                raise UsageError(f"turns: `{turns}` is no driver of an angle that is an input")
        times = np.full(sum(self.poses), mechanism._inner.simulation[0])
        motions = mechanism._motions(times, drive)
        self._inner = mechanism._inner.targets(motions, rows, self.free, turns)

    def driver(self, name: str):
        """Returns the driver of a name."""
        drivers = self.mechanism.drivers
        if name not in drivers:
            raise UsageError(f"target: {_biela.unknown_name('driver', name, list(drivers))}")
        return drivers[name]

    def drive(self) -> Drive:
        """Returns the motions of the drivers through the poses of all targets. Free values are
        those at which the search for them begins."""
        names = {name for target in self.targets for name in target.drive}
        names |= {target.free for target in self.targets if target.free is not None}
        drive = {}
        for name in sorted(names):
            start = self.driver(name).start
            parts = []
            for target, poses in zip(self.targets, self.poses):
                if target.free == name:
                    # With unit velocity, velocities are derivatives by the driver's value.
                    given = _orders(name, (start or 0.0, 1.0))
                elif name in target.drive:
                    given = _orders(name, target.drive[name])
                elif start is not None:
                    given = _orders(name, start)
                else:
                    raise UsageError(
                        f"target: driver `{name}` has a prescribed motion; "
                        "give its values in all targets or in none"
                    )
                given += [np.array(0.0)] * (3 - len(given))
                for order in given:
                    if order.ndim and len(order) != poses:
                        raise UsageError(
                            f"target: driver `{name}` has {len(order)} values for {poses} poses"
                        )
                parts.append([np.broadcast_to(order, poses) for order in given])
            drive[name] = tuple(np.concatenate(orders) for orders in zip(*parts))
        return drive

    def attempts(self, count: int, samples: int, random: np.random.Generator) -> list[Attempt]:
        """Returns attempts at the file's own values and at the best of random ones."""
        found = []
        try:
            found.append(Attempt(self, np.clip(self.own, self.low, self.high), None))
        except Error:
            if count == 1:
                raise
        if count > 1:
            infinite = ~np.isfinite(self.high - self.low)
            if infinite.any():
                unbounded = ", ".join(np.array(self.free)[infinite])
                raise UsageError(f"bounds: random starts need limits of {unbounded}")
            values = random.uniform(self.low, self.high, (samples, len(self.free)))
            costs = sorted(self._inner.costs(values.ravel()), key=lambda cost: cost[2])
            chosen = costs[: count - 1]
            found += [Attempt(self, values[variant], mode) for variant, mode, _ in chosen]
        if not found:
            raise AssemblyError(
                "fit: no start reaches all targets; give wider bounds or more starts"
            )
        return found

    def fit(self, attempts: Sequence[Attempt]) -> Fit:
        """Returns the mechanism of the first of these attempts."""
        best = attempts[0]
        # The mechanism goes to the unknowns once more: the last ones tried may be worse.
        residuals, _ = best.evaluate(best.unknowns)
        inner = self.mechanism._inner
        text = inner.fitted(best._inner, self.free)
        places = np.cumsum([len(self.free)] + [
            poses if target.free is not None else 0
            for target, poses in zip(self.targets, self.poses)
        ])  # fmt: skip
        timing = [
            best.unknowns[first:last] if target.free is not None else None
            for target, first, last in zip(self.targets, places, places[1:])
        ]
        return Fit(
            _reread(text, self.mechanism._path, inner.has_tables),
            dict(zip(self.free, best.unknowns.tolist())),
            float(residuals @ residuals),
            residuals,
            tuple(timing),
            np.array([attempt.cost for attempt in attempts]),
            sum(attempt.evaluations for attempt in attempts),
        )


class Attempt:
    """Unknowns that the optimiser improves from one start, in one assembly mode."""

    def __init__(self, problem: Problem, values: NDArray, mode: int | None):
        self._inner = problem._inner.attempt(values.tolist(), mode)
        self.unknowns = np.concatenate([values, self._inner.timing])
        self.cost = np.inf
        self.evaluations = 0
        self.residuals = problem.residuals
        count = len(values)
        self.low = np.full(len(self.unknowns), -np.inf)
        self.high = np.full(len(self.unknowns), np.inf)
        self.low[:count], self.high[:count] = problem.low, problem.high
        self.scale = np.ones(len(self.unknowns))
        self.scale[:count] = problem.size
        self.last: tuple[bytes, tuple[NDArray, NDArray]] | None = None

    def evaluate(self, unknowns: NDArray) -> tuple[NDArray, NDArray]:
        """Returns the residuals and their derivatives by the unknowns."""
        key = unknowns.tobytes()
        if self.last is None or self.last[0] != key:
            self.evaluations += 1
            found = self._inner.evaluate(unknowns.tolist())
            if found is None:
                refused = np.full(self.residuals, REFUSED)
                return refused, np.zeros((self.residuals, len(unknowns)))
            residuals, derivatives = found
            self.last = key, (residuals, derivatives.reshape(len(residuals), -1))
        return self.last[1]

    def improve(self, evaluations: int, tolerance: float) -> None:
        """Improves the unknowns by least squares."""
        from scipy.optimize import least_squares

        solution = least_squares(
            lambda z: self.evaluate(z)[0],
            # The optimiser starts inside the bounds.
            np.clip(self.unknowns, self.low, self.high),
            jac=lambda z: self.evaluate(z)[1],
            bounds=(self.low, self.high),
            x_scale=self.scale,
            xtol=tolerance,
            ftol=tolerance,
            gtol=tolerance,
            max_nfev=evaluations,
        )
        self.unknowns, self.cost = solution.x, 2 * solution.cost
