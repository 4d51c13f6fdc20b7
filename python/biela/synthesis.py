"""Synthesis: parameters with which a mechanism goes through given values.

The optimiser is `scipy.optimize.least_squares` with exact gradients. Starts come from a sweep over
random variants; the best of them are improved one after another.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import AssemblyError, Error, UsageError
from .mechanism import Mechanism

TURN = 2 * np.pi
VELOCITIES = {"x": "vx", "y": "vy", "phi": "omega", "position": "velocity"}
"""Last parts of the names of velocities by those of positions."""
CURVE = 72
"""Number of poses per turn among which the nearest to each target is taken at the start."""
CHECKED = 24
"""Number of poses per turn at which a full turn is checked."""
REFUSED = 1e6
"""Residual of a mechanism that does not reach a target: the optimiser steps back from it."""


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


def velocity_of(name: str) -> str:
    """Returns the variable that is the velocity of another.

    >>> velocity_of("coupler.P.x")
    'coupler.P.vx'
    """
    owner, _, last = name.rpartition(".")
    if last not in VELOCITIES:
        raise UsageError(f"target: `{name}` is no position, so that its timing cannot be free")
    return f"{owner}.{VELOCITIES[last]}"


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
    """Costs of all starts that were improved, ascending."""
    evaluations: int
    """Number of motions that the optimiser has asked for."""

    def __repr__(self) -> str:
        return f"<biela.Fit: cost {self.cost:.3e} from {len(self.costs)} starts>"


def fit(
    mechanism: Mechanism,
    targets: Target | Sequence[Target],
    free: Sequence[str],
    bounds: Mapping[str, tuple[float, float]] | None = None,
    turns: str | None = None,
    starts: int = 1,
    samples: int = 5000,
    seed: int = 0,
    tolerance: float = 1e-15,
    stop_at: float = 0.0,
) -> Fit:
    """Finds values of the free parameters with which the mechanism meets the targets.

    Minimises the sum of squared residuals. With `starts = 1` it improves the file's own values.
    With more, the best of `samples` random variants within `bounds` are improved too, in both
    their own assembly mode and that of the file; `seed` chooses the variants. It stops early at a
    cost of `stop_at`.

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
    best = None
    costs = []
    for start in problem.starts(starts, samples, np.random.default_rng(seed)):
        try:
            found = problem.improve(*start, tolerance)
        except Error:
            continue
        costs.append(found.cost)
        if best is None or found.cost < best.cost:
            best = found
        if best.cost <= stop_at:
            break
    if best is None:
        raise AssemblyError("fit: no start reaches all targets; give wider bounds or more starts")
    return Fit(
        best.mechanism,
        best.parameters,
        best.cost,
        best.residuals,
        best.timing,
        np.sort(costs),
        problem.evaluations,
    )


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
        self.arrays = [target.arrays() for target in self.targets]
        self.free = list(free)
        self.turns = turns
        self.evaluations = 0
        known = mechanism.parameters
        for name in [*self.free, *bounds]:
            if name not in known:
                # The message has the name that may be meant.
                mechanism.run(t=[0.0], parameters={name: 0.0})
        self.own = np.array([known[name].value for name in self.free])
        limits = [bounds.get(name, (known[name].min, known[name].max)) for name in self.free]
        self.low = np.array([-np.inf if low is None else low for low, _ in limits], dtype=float)
        self.high = np.array([np.inf if high is None else high for _, high in limits], dtype=float)
        # The sizes of the unknowns, by which the optimiser scales them.
        width = self.high - self.low
        size = np.maximum(np.abs(self.own), np.abs(self.own).max(initial=0.0) * 1e-3)
        self.size = np.where(np.isfinite(width), width, np.where(size > 0, size, 1.0))

    def starts(self, count: int, samples: int, random: np.random.Generator):
        """Yields mechanisms at start values, and the timing of each target there."""
        own = np.clip(self.own, self.low, self.high)
        try:
            yield self.placed(self.mechanism, own)
        except Error:
            if count == 1:
                raise
        if count == 1:
            return
        if not np.all(np.isfinite(self.high - self.low)):
            unbounded = [n for n, w in zip(self.free, self.high - self.low) if not np.isfinite(w)]
            raise UsageError(f"bounds: random starts need limits of {', '.join(unbounded)}")
        candidates = []
        for mode in self.modes():
            values = random.uniform(self.low, self.high, (samples, len(self.free)))
            costs = self.rough_costs(mode, values)
            candidates += [(cost, mode, value) for cost, value in zip(costs, values)]
        candidates = [candidate for candidate in candidates if np.isfinite(candidate[0])]
        candidates.sort(key=lambda candidate: candidate[0])
        for _, mode, value in candidates[: count - 1]:
            try:
                yield self.placed(mode, value)
            except Error:
                continue

    def modes(self) -> list[Mechanism]:
        """Returns the mechanism in each of its assembly modes."""
        found = [self.mechanism]
        for mode in self.mechanism.modes().others:
            found.append(self.mechanism.posed(mode))
        return found

    def rough_costs(self, mechanism: Mechanism, values: NDArray) -> NDArray:
        """Returns the costs of variants; without timing those of the nearest poses of a turn."""
        series = dict(zip(self.free, values.T))
        total = np.zeros(len(values))
        for target, (names, wanted) in zip(self.targets, self.arrays):
            if target.free is None:
                sweep = mechanism.sweep(series, drive=target.drive, variables=names)
                found = np.stack([sweep[name] for name in names], axis=1)
                total += target.weight**2 * ((found - wanted) ** 2).sum(axis=(1, 2))
            else:
                drive = {**self.held(target), target.free: self.turn(target.free, CURVE)}
                sweep = mechanism.sweep(series, drive=drive, variables=names)
                found = np.stack([sweep[name] for name in names], axis=1)
                # By variant, pose of the turn and target; a part of the turn may be out of reach.
                gaps = ((found[:, :, :, None] - wanted[None, :, None, :]) ** 2).sum(axis=1)
                gaps = np.where(np.isnan(gaps), np.inf, gaps)
                total += target.weight**2 * gaps.min(axis=1).sum(axis=1)
        if self.turns is not None:
            sweep = mechanism.sweep(
                series, drive={self.turns: self.turn(self.turns, CHECKED)}, variables=[self.turns]
            )
            total[~sweep.ok] = np.inf
        return np.where(np.isnan(total), np.inf, total)

    def turn(self, driver: str, count: int) -> NDArray:
        """Returns values of a driver over a full turn from its start."""
        start = self.mechanism.drivers[driver].start or 0.0
        return start + TURN * np.arange(count + 1) / count

    def held(self, target: Target) -> dict[str, Any]:
        """Returns the drivers of a target that are held, for motions of any length."""
        return {n: float(v) for n, v in target.drive.items() if np.ndim(v) == 0}

    def placed(self, mechanism: Mechanism, values: NDArray):
        """Returns the mechanism assembled at values, the values, and the timing nearest the
        targets."""
        placed = mechanism.changed(dict(zip(self.free, values)))
        timing: list[NDArray] = []
        for target, (names, wanted) in zip(self.targets, self.arrays):
            if target.free is None:
                continue
            angles = self.turn(target.free, CURVE)
            drive = {**self.held(target), target.free: angles}
            curve = placed.run(drive=drive, variables=names, stop="keep")
            found = np.stack([curve[name] for name in names])
            gaps = ((found[:, :, None] - wanted[:, None, :]) ** 2).sum(axis=0)
            timing.append(angles[gaps.argmin(axis=0)])
        return placed, values, timing

    def improve(
        self, mechanism: Mechanism, values: NDArray, timing: list[NDArray], tolerance: float
    ) -> Fit:
        """Improves a start by least squares."""
        from scipy.optimize import least_squares

        count = len(self.free)
        unknowns = np.concatenate([values, *timing])
        low = np.full(len(unknowns), -np.inf)
        high = np.full(len(unknowns), np.inf)
        low[:count], high[:count] = self.low, self.high
        scale = np.ones(len(unknowns))
        scale[:count] = self.size
        evaluate = self.evaluator(mechanism)
        evaluate(unknowns, raises=True)
        # The optimiser starts inside the bounds.
        inside = np.clip(unknowns, low, high)
        solution = least_squares(
            lambda z: evaluate(z)[0],
            inside,
            jac=lambda z: evaluate(z)[1],
            bounds=(low, high),
            x_scale=scale,
            xtol=tolerance,
            ftol=tolerance,
            gtol=tolerance,
            max_nfev=400,
        )
        residuals = evaluate(solution.x, raises=True)[0]
        parameters = {name: float(v) for name, v in zip(self.free, solution.x)}
        return Fit(
            mechanism.changed(parameters),
            parameters,
            float(residuals @ residuals),
            residuals,
            tuple(self.timings(solution.x)),
            np.array([]),
            self.evaluations,
        )

    def timings(self, unknowns: NDArray) -> list[NDArray | None]:
        """Returns the free timing of each target."""
        place = len(self.free)
        found: list[NDArray | None] = []
        for target, (_, wanted) in zip(self.targets, self.arrays):
            if target.free is None:
                found.append(None)
            else:
                found.append(unknowns[place : place + wanted.shape[1]])
                place += wanted.shape[1]
        return found

    def evaluator(self, mechanism: Mechanism) -> Callable[..., tuple[NDArray, NDArray]]:
        """Returns the function of residuals and their derivatives; it keeps the last result."""
        last: tuple[bytes, tuple[NDArray, NDArray]] | None = None

        def evaluate(unknowns: NDArray, raises: bool = False) -> tuple[NDArray, NDArray]:
            nonlocal last
            key = unknowns.tobytes()
            if last is None or last[0] != key:
                try:
                    last = key, self.evaluate(mechanism, unknowns)
                except Error:
                    if raises:
                        raise
                    size = sum(wanted.size for _, wanted in self.arrays)
                    return np.full(size, REFUSED), np.zeros((size, len(unknowns)))
            return last[1]

        return evaluate

    def evaluate(self, mechanism: Mechanism, unknowns: NDArray) -> tuple[NDArray, NDArray]:
        """Returns the residuals and their derivatives by the unknowns."""
        self.evaluations += 1
        count = len(self.free)
        parameters = dict(zip(self.free, unknowns[:count].tolist()))
        residuals, rows = [], []
        place = count
        for target, (names, wanted), timing in zip(
            self.targets, self.arrays, self.timings(unknowns)
        ):
            variables = names
            drive: dict[str, Any] = dict(target.drive)
            if timing is not None:
                drive[target.free] = (timing, 1.0, 0.0)
                # With a driver of unit velocity, velocities are derivatives by its value.
                variables = names + [velocity_of(name) for name in names]
            result = mechanism.run(
                drive=drive, parameters=parameters, variables=variables, gradient=self.free
            )
            poses = wanted.shape[1]
            for name, values in zip(names, wanted):
                residuals.append(target.weight * (result[name] - values))
                row = np.zeros((poses, len(unknowns)))
                for column, parameter in enumerate(self.free):
                    row[:, column] = target.weight * result.gradient[name, parameter]
                if timing is not None:
                    speed = target.weight * result[velocity_of(name)]
                    row[np.arange(poses), place + np.arange(poses)] = speed
                rows.append(row)
            if timing is not None:
                place += poses
        if self.turns is not None:
            drive = {self.turns: self.turn(self.turns, CHECKED)}
            mechanism.run(drive=drive, parameters=parameters, variables=[self.turns])
        return np.concatenate(residuals), np.concatenate(rows)
