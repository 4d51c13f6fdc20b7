"""Unknowns of a fit, improved by SciPy's least squares.

Free timing follows the parameters: each pose is the nearest to its target. SciPy's optimiser sees
the parameters alone, and the derivatives of residuals whose timing follows (variable projection, in
Kaufman's form).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from . import _biela
from .optional import needed

SETTLED = 1e-9
"""Change of timing [rad or m] that ends its improvement: the cost, at its least value, has squares of
this."""


@dataclass(frozen=True)
class Limits:
    """Bounds of parameters, and ends of a search."""

    low: NDArray
    high: NDArray
    size: NDArray
    """Sizes of the parameters, by which the optimiser scales them."""
    tolerance: float
    """Relative decrease of the cost, and relative step, at which a search ends."""
    stop_at: float
    """Cost that suffices."""


class _Ended(Exception):
    """End of a search that SciPy does not see, with its reason and whether it is a success."""


class Attempt:
    """Parameters that are improved by a method of SciPy's, and the free timing that follows them."""

    def __init__(self, moving: _biela.Attempt, parameters: int, method: str = "trf"):
        self.moving, self.method = moving, method
        self.parameters, self.timing = np.split(np.array(moving.start), [parameters])
        self.residuals: NDArray | None = None
        """Residuals by target, then by variable, then by pose, once the targets were reached."""
        self.evaluations = 0
        """Number of times that residuals were asked for."""
        self._ended = False
        self.success = False
        """Whether the search came to its end."""
        self.message = "the search has not begun"
        """Reason why the search is where it is."""

    @property
    def cost(self) -> float:
        """Sum of squared residuals; infinite if the targets were not reached."""
        return np.inf if self.residuals is None else float(self.residuals @ self.residuals)

    def improve(self, limits: Limits, evaluations: int) -> None:
        """Improves the parameters by this number of evaluations at most."""
        least_squares = needed("scipy.optimize", "fit").least_squares
        if self._ended:
            return
        varied = limits.low < limits.high
        begun = False

        def all_of(some: NDArray) -> NDArray:
            parameters = self.parameters.copy()
            parameters[varied] = some
            return parameters

        def residuals(some: NDArray) -> NDArray:
            nonlocal begun
            found = self._try(all_of(some))
            if found is None:
                if not begun:  # SciPy needs residuals to begin with.
                    raise _Ended("no parameters near these reach all targets", False)
                return np.full_like(self.residuals, np.inf)
            begun = True
            return found

        def derivatives(some: NDArray) -> NDArray:
            found = self._keep(all_of(some))[:, varied]
            if self.cost <= limits.stop_at:
                raise _Ended("the cost is not above `stop_at`", True)
            if not (found.T @ self.residuals).any():
                self._settle(evaluations)
                raise _Ended("no small change of a parameter lowers the cost", True)
            return found

        try:
            if self._try(self.parameters) is None:
                raise _Ended("the mechanism does not reach all targets", False)
            derivatives(self.parameters[varied])  # Ends where there is nothing to improve.
            tolerance = max(limits.tolerance, np.finfo(float).eps)
            found = least_squares(
                residuals,
                self.parameters[varied],
                derivatives,
                bounds=(limits.low[varied], limits.high[varied]),
                x_scale=limits.size[varied],
                ftol=tolerance,
                xtol=tolerance,
                gtol=None,
                method=self.method,
                max_nfev=evaluations,
            )
            # SciPy's status is 0 where it has used up its evaluations.
            self._ended = self.success = found.status != 0
            self.message = found.message
        except _Ended as end:
            self._ended = True
            self.message, self.success = end.args

    def _try(self, parameters: NDArray) -> NDArray | None:
        """Returns the residuals at parameters; `None` where the mechanism does not get to."""
        timing = self.timing
        if self.residuals is not None:
            step = parameters - self.parameters
            if not step.any():
                return self.residuals
            timing = timing + self._off + self._rates @ step
        return self._go(parameters, timing)

    def _settle(self, evaluations: int) -> None:
        """Improves the timing alone."""
        part = 1.0
        for _ in range(evaluations):
            off = part * self._off
            if np.abs(off).max(initial=0.0) < SETTLED:
                return
            residuals = self._go(self.parameters, self.timing + off)
            if residuals is None or residuals @ residuals >= self.cost:
                part /= 2
            else:
                self._linearise()

    def _go(self, parameters: NDArray, timing: NDArray) -> NDArray | None:
        """Returns the residuals at parameters, with the timing nearest to this one; `None` where the
        mechanism does not get to."""
        self.evaluations += 1
        tried = self.moving.go([*parameters, *timing], True)
        if tried is None:
            return None
        self._tried = tried
        return tried[3]

    def _keep(self, parameters: NDArray) -> NDArray:
        """Returns the derivatives that the optimiser sees at the parameters tried last, and keeps
        these parameters."""
        if self.residuals is None or not np.array_equal(parameters, self.parameters):
            self._linearise()
        return self._derivatives

    def _linearise(self) -> None:
        """Keeps the unknowns tried last, and their derivatives."""
        kept = self.moving.keep()
        if kept is None:
            raise _Ended("the residuals have no finite derivatives there", False)
        unknowns, leaders, curvatures, self.residuals = self._tried
        count = len(self.parameters)
        self.parameters, self.timing = np.split(unknowns, [count])
        kept = kept.reshape(len(self.residuals), -1)
        by_parameters, by_timing = np.split(kept, [count], axis=1)
        # Each timing goes where the gap at its pose is smallest, or with the timing that ends its
        # range; it stays at a limit, and where it has no effect.
        seconds = (by_timing**2).sum(axis=0)
        seconds = np.where(curvatures > 2 * seconds, curvatures, seconds)
        nearer = -by_timing.T / np.where(seconds > 0, seconds, np.inf)[:, None]
        nearer = np.vstack([nearer, np.zeros_like(self.residuals)])
        nearer = nearer[[-1 if leader is None else leader for leader in leaders]]
        self._off, self._rates = nearer @ self.residuals, nearer @ by_parameters
        self._derivatives = by_parameters + by_timing @ self._rates
