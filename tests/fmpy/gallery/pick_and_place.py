"""Pick and place: modified sine and polynomial 3-4-5 through the tables, three cycles."""

from __future__ import annotations

import numpy as np

from . import Case
from .plane import body, point
from .taylor import Taylor

PERIOD, STROKE, LIFT, RAIL, TOOL = 1.5, 0.5, 0.12, 0.3, 0.1
TRAVEL = [(0, 0), (0.15, 0), (0.45, 1), (0.65, 1), (0.95, 0), (1, 0)]
REACH = [(0, 2), (0.05, 2), (0.2, 1), (0.4, 1), (0.5, 2), (0.6, 2), (0.7, 1), (0.9, 1), (1, 2)]


def polynomial_345(tau):
    return tau * tau * tau * (10 + tau * (6 * tau - 15))


def modified_sine(tau):
    """The law's three pieces, as its acceleration is written down: sine waves of 1/2 and 3/2 of
    the stroke's time, joined at an eighth and seven eighths."""
    pieces = [
        np.pi * tau - 0.25 * (4 * np.pi * tau).sin(),
        2 + np.pi * tau - 2.25 * ((np.pi + 4 * np.pi * tau) / 3).sin(),
        4 + np.pi * tau - 0.25 * (4 * np.pi * tau).sin(),
    ]
    place = np.digitize(tau.value, [0.125, 0.875])
    return choose(pieces, place) / (np.pi + 4)


def choose(pieces, place):
    """Returns for each sample its value among several."""
    orders = ("value", "first", "second")
    return Taylor(*(np.choose(place, [getattr(p, o) for p in pieces]) for o in orders))


def follow(table, law, time):
    """A periodic table in parts of the cycle."""
    part = time / PERIOD
    part = part - np.floor(part.value)
    times, values = np.transpose(table)
    k = np.clip(np.searchsorted(times, part.value, side="right") - 1, 0, len(times) - 2)
    stroke = law((part - times[k]) / (times[k + 1] - times[k]))
    return values[k] + (values[k + 1] - values[k]) * stroke


def truth(time, _drivers):
    travel = STROKE * follow(TRAVEL, modified_sine, time)
    reach = LIFT * follow(REACH, polynomial_345, time)
    gripper = travel + 1j * (RAIL - reach)
    return (
        body("carriage", travel + 1j * RAIL, 0)
        | body("gripper", gripper, 0)
        | point("gripper.tip", gripper - 1j * TOOL)
        | {"travel": travel, "reach": reach}
    )


CASE = Case(
    source="closed form: modified sine and polynomial 3-4-5, three cycles",
    drivers=lambda time: {},
    truth=truth,
    duration=4.5,
    steps=1000,
    parameters={"period": PERIOD, "stroke": STROKE},
)
