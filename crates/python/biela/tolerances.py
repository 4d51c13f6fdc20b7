"""Tolerances: deviations of a motion for deviations of parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .arguments import Drive, Parameters, count_of, given_values, mapping
from .errors import UsageError
from .mechanism import Mechanism
from .optional import needed
from .results import Result, Sweep

MOST_CORNERS = 12
"""Largest number of parameters whose corners are all tried: 4096 variants."""


@dataclass(frozen=True)
class Tolerances:
    """Deviations of a motion, by the variables' names, each over time, in SI units."""

    result: Result
    """Motion of the nominal mechanism, with its gradients."""
    tolerances: dict[str, float]
    """Largest deviations of the parameters."""
    worst: dict[str, NDArray]
    """Worst case: the sum of |derivative| times tolerance."""
    statistical: dict[str, NDArray]
    """Root of the sum of squares: three standard deviations, if the tolerances are."""
    corners: Sweep | None
    """Motions of all corners of the box of tolerances, without linearisation."""
    samples: Sweep | None
    """Motions of random variants, normally distributed with the tolerances as three standard
    deviations, cut there."""

    def __repr__(self) -> str:
        tried = sum(0 if sweep is None else sweep.ok.size for sweep in (self.corners, self.samples))
        return (
            f"<biela.Tolerances of {', '.join(self.tolerances)}: {len(self.result.t)} rows of "
            f"{len(self.worst)} variables, {tried} variants>"
        )

    def parts(self, variable: str) -> dict[str, NDArray]:
        """Returns the part of each parameter in the worst case of a variable."""
        gradient = self.result.gradient
        return {n: np.abs(gradient[variable, n]) * t for n, t in self.tolerances.items()}

    def extremes(self, variable: str) -> tuple[NDArray, NDArray]:
        """Returns the smallest and the largest value of a variable over all corners; not a number
        where a corner has stopped."""
        if self.corners is None:
            raise UsageError("tolerances: the corners were not asked for")
        values = self.corners[variable]
        return values.min(axis=0), values.max(axis=0)

    def deviation(self, variable: str) -> NDArray:
        """Returns the standard deviation of a variable over the random variants; not a number where
        one has stopped."""
        if self.samples is None:
            raise UsageError("tolerances: no samples were asked for")
        return self.samples[variable].std(axis=0)

    def plot(self, marker: str, axes=None, scale: float = 1.0):
        """Draws the path of a marker with the band of its worst case, `scale` times wider.

        The band's half width is the worst case along the normal of the path. Needs Matplotlib.
        """
        pyplot = needed("matplotlib.pyplot", "plot")
        if len(self.result.t) < 2:
            raise UsageError("tolerances: a path needs two poses")
        axes = pyplot.gca() if axes is None else axes
        x, y = self.result[f"{marker}.x"], self.result[f"{marker}.y"]
        along = np.stack([np.gradient(x), np.gradient(y)])
        length = np.hypot(*along)
        normal = np.stack([-along[1], along[0]]) / np.where(length > 0, length, 1.0)
        gradient = self.result.gradient
        half = scale * sum(
            tolerance
            * np.abs(
                normal[0] * gradient[f"{marker}.x", name]
                + normal[1] * gradient[f"{marker}.y", name]
            )
            for name, tolerance in self.tolerances.items()
        )
        band = np.concatenate(
            [[x, y] + half * normal, np.flip([x, y] - half * normal, axis=1)], axis=1
        )
        axes.fill(*band, alpha=0.3, linewidth=0, label=f"worst case × {scale:g}")
        axes.plot(x, y, label=marker)
        axes.set(aspect="equal", xlabel="x [m]", ylabel="y [m]")
        axes.legend()
        return axes


def tolerance(
    mechanism: Mechanism,
    t: ArrayLike | None = None,
    drive: Drive | None = None,
    tolerances: Mapping[str, float] | None = None,
    parameters: Parameters | None = None,
    variables: Sequence[str] | None = None,
    corners: bool = False,
    samples: int = 0,
    seed: int = 0,
) -> Tolerances:
    """Finds the deviations of a motion for deviations of parameters.

    `tolerances` are by the names of parameters and of starts of freedoms, such as `swing.velocity`
    [SI], by default those of the file. `corners` also
    runs all corners of the box of tolerances; `samples` is the number of random variants to run.

    >>> found = tolerance(four_bar, drive={"crank_angle": [1.0]}, corners=True,
    ...     tolerances={"base": 1e-4, "crank_length": 5e-5})
    >>> low, high = found.extremes("rocker.phi")
    >>> worst = found.worst["rocker.phi"]
    >>> bool(np.allclose((high - low) / 2, worst, rtol=1e-3))
    True
    """
    samples = count_of("samples", samples)
    known = mechanism.parameters
    if tolerances is None:
        tolerances = {n: p.tolerance for n, p in known.items() if p.tolerance is not None}
        if not tolerances:
            raise UsageError(
                'no parameter has a tolerance; add for example `tolerance = "0.05*mm"` to one'
            )
    sizes_given = mapping("tolerances", tolerances)
    tolerances = {name: _size(name, value) for name, value in sizes_given.items()}
    names = list(tolerances)
    result = mechanism.run(t, drive, parameters, variables, gradient=names)
    sizes = np.array([tolerances[name] for name in names])
    deviations = np.abs(result.gradient.to_numpy()) * sizes[None, :, None]
    worst = deviations.sum(axis=1)
    statistical = np.sqrt((deviations**2).sum(axis=1))
    given = given_values(parameters)
    values = dict(mechanism._inner.values(given))
    nominal = np.array([values[name] for name in names])

    def variants(factors: NDArray) -> Sweep:
        swept = dict(zip(names, (nominal + factors * sizes).T))
        return mechanism.sweep({**dict(given), **swept}, t, drive, variables)

    if corners and len(names) > MOST_CORNERS:
        raise UsageError(
            f"corners: {len(names)} tolerances have 2^{len(names)} corners; "
            f"expected at most {MOST_CORNERS} tolerances"
        )
    signs = np.array(list(product((-1.0, 1.0), repeat=len(names))))
    random = np.random.default_rng(seed).normal(0.0, 1 / 3, (samples, len(names)))
    return Tolerances(
        result,
        tolerances,
        {name: worst[:, place] for place, name in enumerate(result)},
        {name: statistical[:, place] for place, name in enumerate(result)},
        variants(signs) if corners else None,
        variants(np.clip(random, -1.0, 1.0)) if samples else None,
    )


def _size(name: str, tolerance: float) -> float:
    """Returns the tolerance of a parameter, a number that is not negative."""
    try:
        size = float(tolerance)
    except (TypeError, ValueError, OverflowError):
        size = np.nan
    if not 0 <= size < np.inf:
        raise UsageError(
            f"tolerances: `{name}` has {tolerance!r}; expected a number in SI units, not negative"
        )
    return size
