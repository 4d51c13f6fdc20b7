"""Rates of motions that are given by samples."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

STENCIL = 5
"""Number of samples per derivative: the errors of smooth motions are of order h^4 and h^3."""


def differentiate(t: ArrayLike, values: ArrayLike) -> tuple[NDArray, NDArray]:
    """Returns first and second derivatives of samples at ascending times, not necessarily even, along
    the last axis.

    Each derivative is that of the polynomial through the nearest five samples.

    >>> t = np.array([0.0, 0.1, 0.3, 0.4, 0.6, 1.0])
    >>> velocity, acceleration = differentiate(t, t**4)
    >>> bool(np.allclose(velocity, 4 * t**3) and np.allclose(acceleration, 12 * t**2))
    True
    """
    t = np.asarray(t, dtype=float)
    values = np.asarray(values, dtype=float)
    count = min(STENCIL, len(t))
    if count < 2:
        return np.zeros_like(values), np.zeros_like(values)
    first = np.clip(np.arange(len(t)) - count // 2, 0, len(t) - count)
    index = first[:, None] + np.arange(count)
    # Offsets in units of the stencil's width, so that powers do not overflow.
    offset = t[index] - t[:, None]
    width = np.abs(offset).max(axis=1)
    powers = (offset / width[:, None])[:, :, None] ** np.arange(count)
    coefficients = np.linalg.solve(powers, values[..., index][..., None])[..., 0]
    velocity = coefficients[..., 1] / width
    acceleration = 2 * coefficients[..., 2] / width**2 if count > 2 else np.zeros_like(values)
    return velocity, acceleration
