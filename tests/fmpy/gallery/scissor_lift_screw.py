"""Scissor lift with a screw: each pair of arms is a right triangle twice; virtual work."""

from __future__ import annotations

import numpy as np

from . import Case, one_turn
from .plane import body
from .taylor import Taylor

ARM, PITCH, WIDEST, AXLE = 0.800, 0.012, 0.760, -0.25 + 0.12j
LOAD, PLATFORM, PAIR, G = 3000.0, 35.0, 9.0, 9.81
INERTIA = PAIR * ARM**2 / 12


def geometry(u):
    """Width and height of a pair of arms, and how steep the arms are."""
    width = WIDEST - PITCH / (2 * np.pi) * u
    height = ((ARM - width) * (ARM + width)).sqrt()
    return width, height, Taylor.atan2(height, width)


def truth(_time, drivers):
    u = drivers["turn"]
    width, height, phi = geometry(u)
    return (
        body("screw", AXLE, u)
        | body("lower_1", 0, phi)
        | body("lower_2", width, np.pi - phi)
        | body("upper_1", 1j * height, phi)
        | body("upper_2", width + 1j * height, np.pi - phi)
        | body("platform", 2j * height, 0)
        | {"foot": width, "height": 2 * height}
    )


def properties(motion):
    """Virtual work of the load, the weights and the inertia per radian of the screw."""
    u = motion["turn.position"]
    now = geometry(Taylor(u, motion["turn.velocity"], motion["turn.acceleration"]))
    per_radian = geometry(Taylor.time(u))
    effort = LOAD * 2 * per_radian[1].first
    for count, part, mass in ((1, (0, 2), PLATFORM), (2, (0.5, 0.5), PAIR), (2, (0.5, 1.5), PAIR)):
        x, y = (part[0] * now[0].second, part[1] * now[1].second + G)
        by_x, by_y = part[0] * per_radian[0].first, part[1] * per_radian[1].first
        effort = effort + count * mass * (x * by_x + y * by_y)
    effort = effort + 4 * INERTIA * now[2].second * per_radian[2].first
    largest = np.max(np.abs(effort))
    tension = 2 * np.pi / PITCH * effort
    return {
        "effort": (motion["turn.effort"] - effort) / largest,
        "thread": (motion["thread.effort"] + tension) / np.max(tension),
        "thread along the foot": (motion["thread.foot.effort"] + tension) / np.max(tension),
        "thread along the turn": (motion["thread.turn.effort"] + effort) / largest,
    }


CASE = Case(
    source="closed form: right triangles, 35 turns; virtual work",
    drivers=lambda time: {"turn": 4 * np.pi + 35 * one_turn(0)(time)},
    truth=truth,
    properties=properties,
)
