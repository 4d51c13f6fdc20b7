"""Synthesis: parameters with which a mechanism goes through given values.

SciPy's least squares improve parameters, on exact derivatives of all residuals. The search starts
from random variants, assembled in all their assembly modes, and from random changes of the best.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import cycle

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _biela
from .arguments import Drive, count_of, mapping, names_of, numbers, orders_of
from .attempt import Attempt, Limits
from .errors import AssemblyError, UsageError
from .mechanism import Mechanism, _reread

METHODS = ("dogbox", "trf")
"""SciPy's methods for bounds, which random starts and changes use in turn: `dogbox` goes along the
bounds, `trf` between them, and each often goes on where the other is stuck."""
ROUNDS = ((12, 0.1), (40, 1.0))
"""Evaluations of each attempt in a round, and the part of the attempts that goes on to the next."""
MOST_VARIED = 20
"""Largest number of attempts that are varied."""
VARIANTS = 4
"""Number of random changes of each attempt that is varied, per variation."""
CHANGES = (0.01, 0.3)
"""Smallest and largest standard deviation of random changes, as part of the bounds' width."""
PATIENCE = 25
"""Evaluations of each change, which then replaces what it changed or is given up."""
LAST = 400
"""Evaluations of the best attempt at the end."""


@dataclass(frozen=True)
class Target:
    """Values that variables of a mechanism shall take, one per pose, all of one length.

    `values` are by the names of variables, such as `{"coupler.P.x": […], "coupler.P.y": […]}` for
    points, with `coupler.phi` for poses, or `{"rocker.phi": […]}` for a function. `drive` has the
    drivers' values at these poses. `free` names a driver whose values are free: the points have no
    timing then. With `in_order` these values ascend or descend from pose to pose, within a turn.
    `weight` multiplies the residuals.
    """

    values: Mapping[str, ArrayLike]
    drive: Mapping[str, ArrayLike] = field(default_factory=dict)
    free: str | None = None
    weight: float = 1.0
    in_order: bool = False

    def arrays(self) -> tuple[list[str], NDArray]:
        """Returns the names, and the values by name, then by pose."""
        names = list(mapping("target", self.values))
        arrays = [np.atleast_1d(numbers("target", v, n)) for n, v in self.values.items()]
        if not names or len({array.shape for array in arrays}) != 1 or arrays[0].ndim != 1:
            shapes = ", ".join(f"{n} {a.shape}" for n, a in zip(names, arrays)) or "none"
            raise UsageError(f"target: expected arrays of one length; found {shapes}")
        if not arrays[0].size or not np.isfinite(arrays).all():
            raise UsageError(f"target: expected finite values of `{names[0]}` at one pose or more")
        weight = numbers("target", self.weight, "weight")
        if weight.ndim or not np.isfinite(weight):
            raise UsageError(f"target: expected a finite number as `weight`; found {self.weight!r}")
        return names, np.array(arrays)


def points(
    marker: str,
    xy: ArrayLike,
    drive: Mapping[str, ArrayLike] | None = None,
    free: str | None = None,
    weight: float = 1.0,
    in_order: bool = False,
) -> Target:
    """Returns the target of a marker that shall go through points, rows of x and y [m].

    >>> points("coupler.P", [[3, 3], [2.759, 3.363]], free="crank_angle").values["coupler.P.y"]
    array([3.   , 3.363])
    """
    xy = numbers("points", xy, marker)
    if xy.ndim != 2 or xy.shape[1] != 2:
        raise UsageError(f"points: expected rows of x and y; found an array of shape {xy.shape}")
    x, y = xy.T
    return Target({f"{marker}.x": x, f"{marker}.y": y}, drive or {}, free, weight, in_order)


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
    success: bool
    """Whether the last search came to an end by itself. The cost tells how well the targets are met."""
    message: str
    """Reason why the last search ended, in the words of SciPy where it is the one to end it."""

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
    variations: int = 10,
    seed: int = 0,
    tolerance: float = 1e-15,
    stop_at: float = 0.0,
) -> Fit:
    """Finds values of the free parameters with which the mechanism meets the targets.

    Minimises the sum of squared residuals. With `starts = 1` it improves the file's own values.
    With more, the best of `samples` random variants within `bounds` are improved too, in any of
    their assembly modes. Starts that fall behind are given up; the others are changed at random and
    improved again, `variations` times. `seed` chooses variants and changes. It stops early at a cost
    of `stop_at`.

    `turns` names a driver that shall turn fully: mechanisms in which it cannot are refused. Equal
    bounds keep a parameter at their value.

    Raises `AssemblyError` if no start reaches all targets, with finite derivatives. Needs the
    package SciPy.

    >>> curve = four_bar.run(drive={"crank_angle": [1.0, 1.4, 2.0]},
    ...     parameters={"crank_length": 0.11, "rocker_length": 0.29})
    >>> target = points("coupler.P", np.transpose([curve["coupler.P.x"], curve["coupler.P.y"]]),
    ...     drive={"crank_angle": [1.0, 1.4, 2.0]})
    >>> found = fit(four_bar, target, free=["crank_length", "rocker_length"])
    >>> round(found.parameters["crank_length"], 9), round(found.parameters["rocker_length"], 9)
    (0.11, 0.29)
    """
    starts, samples = count_of("starts", starts, 1), count_of("samples", samples)
    variations, seed = count_of("variations", variations), count_of("seed", seed)
    for name, value in {"tolerance": tolerance, "stop_at": stop_at}.items():
        number = numbers("fit", value, name)
        if number.ndim or not np.isfinite(number):
            raise UsageError(f"fit: expected a finite number as `{name}`; found {value!r}")
    problem = Problem(mechanism, targets, free, mapping("bounds", bounds), turns, tolerance, stop_at)
    random = np.random.default_rng(seed)
    attempts = problem.attempts(starts, samples, random)
    if starts > 1:
        search(problem, attempts, variations, random)
    problem.improve(attempts[:1], LAST)
    return problem.fit(attempts)


def search(
    problem: Problem,
    attempts: list[Attempt],
    variations: int,
    random: np.random.Generator,
) -> None:
    """Improves attempts, the best of them longest; the best comes first."""
    going_on = attempts
    for evaluations, part in ROUNDS:
        problem.improve(going_on, evaluations)
        attempts.sort(key=lambda attempt: attempt.cost)
        if attempts[0].cost <= problem.limits.stop_at:
            return
        going_on = attempts[: max(1, min(MOST_VARIED, round(part * len(attempts))))]
    varied = len(going_on)
    for _ in range(variations):
        children, parents = problem.variants(attempts[:varied], random)
        problem.improve([attempts[0], *children], PATIENCE)
        for child, parent in zip(children, parents):
            if child.cost < attempts[parent].cost:
                problem.spent += attempts[parent].evaluations
                attempts[parent] = child
            else:
                problem.spent += child.evaluations
        attempts.sort(key=lambda attempt: attempt.cost)
        if attempts[0].cost <= problem.limits.stop_at:
            return


def _limits(name: str, ends: tuple[float | None, float | None]) -> tuple[float, float]:
    """Returns the limits of a parameter, infinite where there is none."""
    try:
        low, high = ends
        low = -np.inf if low is None else float(low)
        high = np.inf if high is None else float(high)
    except (TypeError, ValueError, OverflowError):
        low, high = np.nan, np.nan
    if not low <= high:
        raise UsageError(
            f"bounds: expected two numbers for `{name}`, the smaller first; found {ends}"
        )
    return low, high


class Problem:
    """Targets of a mechanism as a problem of least squares.

    The unknowns are the free parameters, and the free timing of each target.
    """

    def __init__(
        self,
        mechanism: Mechanism,
        targets: Target | Sequence[Target],
        free: Sequence[str],
        bounds: Mapping[str, tuple[float, float]],
        turns: str | None,
        tolerance: float = 1e-15,
        stop_at: float = 0.0,
    ):
        self.mechanism = mechanism
        self.spent = 0  # Evaluations of attempts that were given up.
        self.targets = [targets] if isinstance(targets, Target) else list(targets)
        if not self.targets:
            raise UsageError("targets: there are none")
        for target in self.targets:
            if not isinstance(target, Target):
                raise UsageError(f"targets: expected instances of `Target`; found {target!r}")
        self.free = names_of("free", free)
        known = mechanism.parameters
        for name in [*self.free, *bounds]:
            if name not in known:
                meant = _biela.unknown_name("parameter", name, list(known))
                raise UsageError(f"parameters: {meant}")
        for name in self.free:
            if self.free.count(name) > 1:
                raise UsageError(f"free: `{name}` is named twice")
        for name in bounds:
            if name not in self.free:
                raise UsageError(f"bounds: `{name}` is not free; name it in `free` too")
        self.own = np.array([known[name].value for name in self.free])
        limits = [
            _limits(name, bounds.get(name, (known[name].min, known[name].max))) for name in self.free
        ]
        low, high = np.array(limits).reshape(-1, 2).T
        size = np.maximum(np.abs(self.own), np.abs(self.own).max(initial=0.0) * 1e-3)
        bounded = np.isfinite(high - low)
        size = np.where(bounded, high - low, np.where(size > 0, size, 1.0))
        self.limits = Limits(low, high, size, tolerance, stop_at)
        arrays = [target.arrays() for target in self.targets]
        self.poses = [values.shape[1] for _, values in arrays]
        columns = list(mechanism.variables)
        rows = []
        for target, (names, values) in zip(self.targets, arrays):
            for name in names:
                if name not in columns:
                    meant = _biela.unknown_name("variable", name, columns)
                    raise UsageError(f"target: {meant}")
            indices = [columns.index(name) for name in names]
            poses, wanted = values.shape[1], values.ravel().tolist()
            free_driver = None if target.free is None else (target.free, target.in_order)
            rows.append((poses, free_driver, indices, wanted, target.weight))
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
        drivers = {**self.mechanism.drivers, **self.mechanism.freedoms}
        if name not in drivers:
            raise UsageError(f"target: {_biela.unknown_name('driver', name, list(drivers))}")
        return drivers[name]

    def drive(self) -> Drive:
        """Returns the motions of the drivers through the poses of all targets. Free values are
        those at which the search for them begins."""
        names = {name for target in self.targets for name in mapping("target", target.drive)}
        names |= {target.free for target in self.targets if target.free is not None}
        drive = {}
        for name in sorted(names):
            start = self.driver(name).start
            parts = []
            for target, poses in zip(self.targets, self.poses):
                if target.free == name:
                    # With unit velocity, velocities are derivatives by the driver's value.
                    given = orders_of(name, (start or 0.0, 1.0))
                elif name in target.drive:
                    given = orders_of(name, target.drive[name])
                elif start is not None:
                    given = orders_of(name, start)
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

    def attempts(
        self, count: int, samples: int, random: np.random.Generator
    ) -> list[Attempt]:
        """Returns attempts at the file's own values and at the best of random ones."""
        found = []
        try:
            own = np.clip(self.own, self.limits.low, self.limits.high).tolist()
            found.append(Attempt(self._inner.attempt(own), len(own)))
        except AssemblyError:
            if count == 1:
                raise
        if count > 1:
            low, high = self.limits.low, self.limits.high
            infinite = ~np.isfinite(high - low)
            if not self.free:
                raise UsageError("free: random starts need the name of a parameter")
            if infinite.any():
                unbounded = ", ".join(np.array(self.free)[infinite])
                raise UsageError(f"bounds: random starts need limits of {unbounded}")
            values = random.uniform(low, high, (samples, len(self.free)))
            costs = sorted(self._inner.costs(values.ravel()), key=lambda cost: cost[2])
            chosen = costs[: count - 1]
            found += self.begin(values, chosen)
        if not found:
            raise AssemblyError(
                "fit: no start reaches all targets; give wider bounds or more starts"
            )
        return found

    def begin(
        self, values: NDArray, chosen: Sequence[tuple[int, int, float]]
    ) -> list[Attempt]:
        """Returns attempts at variants in assembly modes, by their indices."""
        variants = [variant for variant, _, _ in chosen]
        modes = [mode for _, mode, _ in chosen]
        begun = self._inner.attempts(values[variants].ravel(), modes)
        return [
            Attempt(moving, len(self.free), method) for moving, method in zip(begun, cycle(METHODS))
        ]

    def variants(
        self, parents: Sequence[Attempt], random: np.random.Generator
    ) -> tuple[list[Attempt], list[int]]:
        """Returns attempts at random changes of the parents, each in the assembly mode in which it
        fits best, and the indices of their parents."""
        indices = np.repeat(np.arange(len(parents)), VARIANTS)
        count = len(indices)
        values = np.array([parent.parameters for parent in parents])[indices]
        sizes = np.exp(random.uniform(*np.log(CHANGES), (count, 1)))
        low, width = self.limits.low, self.limits.high - self.limits.low
        values += sizes * width * random.normal(size=(count, len(self.free)))
        # Values beyond a bound are reflected by it; equal bounds fix a parameter.
        values = (values - low) % np.where(width > 0, 2 * width, 1.0)
        values = low + np.minimum(values, 2 * width - values)
        best = {}
        for found in self._inner.costs(values.ravel()):
            if found[0] not in best or found[2] < best[found[0]][2]:
                best[found[0]] = found
        return self.begin(values, list(best.values())), [int(indices[variant]) for variant in best]

    def improve(self, attempts: Sequence[Attempt], evaluations: int) -> None:
        """Improves attempts by this number of evaluations each, at most."""
        for attempt in attempts:
            attempt.improve(self.limits, evaluations)

    def fit(self, attempts: Sequence[Attempt]) -> Fit:
        """Returns the mechanism of the first of these attempts."""
        best = attempts[0]
        if best.residuals is None:
            raise AssemblyError(
                "fit: the mechanism does not reach all targets with finite derivatives"
            )
        inner = self.mechanism._inner
        text = inner.fitted(best.moving, self.free)
        free = [0 if target.free is None else poses for target, poses in zip(self.targets, self.poses)]
        timing = np.split(best.timing, np.cumsum(free)[:-1])
        return Fit(
            _reread(text, *self.mechanism._origin()),
            dict(zip(self.free, best.parameters.tolist())),
            best.cost,
            best.residuals,
            tuple(part if count else None for part, count in zip(timing, free)),
            np.array([attempt.cost for attempt in attempts]),
            self.spent + sum(attempt.evaluations for attempt in attempts),
            best.success,
            best.message,
        )
