"""Charts of results, drawn by Matplotlib."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from .errors import UsageError
from .optional import needed

STILL = 1e-12
"""Change that is rounding, as part of the largest value of the same unit: lines of bodies are drawn
in metres and radians, where rounding is 1e-16 times the condition of the pose."""
PANEL_HEIGHT = 2.2
"""Height of a panel [inch]; two of them are as high as Matplotlib's own figures."""


def label(name: str, unit: str) -> str:
    """Returns a name with its unit."""
    return f"{name} [{unit}]" if unit else name


def changing(lines: Mapping[str, NDArray], units: Mapping[str, str]) -> dict[str, NDArray]:
    """Returns the lines that are not constant.

    >>> lines = {"a.x": np.array([1.0, 2.0]), "b.x": np.array([1e-17, -1e-17])}
    >>> list(changing(lines, {"a.x": "m", "b.x": "m"}))
    ['a.x']
    """
    largest: dict[str, float] = {}
    for name, values in lines.items():
        largest[units[name]] = max(largest.get(units[name], 0.0), float(np.abs(values).max()))
    return {n: v for n, v in lines.items() if np.ptp(v) > STILL * largest[units[n]]}


def panels(
    along: tuple[str, NDArray], lines: Mapping[str, NDArray], units: Mapping[str, str], axes=None
):
    """Draws lines in a panel per unit, over the values of `along` with their label, and returns the
    panels' axes."""
    pyplot = needed("matplotlib.pyplot", "plot")
    by_unit: dict[str, list[str]] = {}
    for name in lines:
        by_unit.setdefault(units[name], []).append(name)
    count = len(by_unit)
    place = {}
    if axes is None:
        _, axes = pyplot.subplots(
            count, sharex=True, layout="constrained", figsize=(8, max(2, count) * PANEL_HEIGHT)
        )
        # Beside the panel, where it hides no line; the layout makes room for it.
        place = {"loc": "upper left", "bbox_to_anchor": (1, 1)}
    axes = np.atleast_1d(axes).reshape(-1)
    if len(axes) != count:
        found = ", ".join(by_unit)
        raise UsageError(f"plot: expected {count} axes, for {found}; found {len(axes)}")
    at, values = along
    for panel, (unit, names) in zip(axes, by_unit.items()):
        for name in names:
            panel.plot(values, lines[name], label=name)
        panel.set_ylabel(label(names[0], unit) if len(names) == 1 else f"[{unit}]")
        if len(names) > 1:
            panel.legend(**place)
    axes[-1].set_xlabel(at)
    return axes
