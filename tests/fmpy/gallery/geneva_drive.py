"""Geneva drive: a slot points at the pin while the pin is in it; otherwise the wheel stands."""

from __future__ import annotations

import numpy as np

from . import Case, one_turn
from .plane import body, point
from .taylor import Taylor

DISTANCE = 0.100
PIN = DISTANCE * np.sin(np.pi / 4)


def truth(_time, drivers):
    u = drivers["crank_angle"]
    pin = Taylor.polar(PIN, u)
    turns = np.floor((u.value + np.pi) / (2 * np.pi))
    within = u.value - 2 * np.pi * turns
    # The direction from the wheel's pivot to the pin, against the way to the crank's.
    lean = Taylor.atan2(pin.y, DISTANCE - pin.x)
    engaged = np.abs(within) < np.pi / 4
    held = np.sign(within) * np.pi / 4
    wheel = -np.pi / 2 * turns - Taylor(
        np.where(engaged, lean.value, held),
        np.where(engaged, lean.first, 0.0),
        np.where(engaged, lean.second, 0.0),
    )
    mouth = Taylor.polar(PIN, wheel)
    return (
        body("crank", 0, u)
        | body("wheel", DISTANCE, wheel)
        | body("cross", DISTANCE, wheel)
        | point("crank.pin", pin)
        | point("wheel.A", DISTANCE - mouth)
        | point("cross.B", DISTANCE - 1j * mouth)
        | point("wheel.C", DISTANCE + mouth)
        | point("cross.D", DISTANCE + 1j * mouth)
        | {"wheel_angle": wheel}
    )


CASE = Case(
    source="closed form: slot towards the pin, three turns",
    # The wheel's acceleration jumps where the pin enters and leaves; no sample is within 1e-3 rad.
    drivers=lambda time: {"crank_angle": 3 * one_turn(-0.7)(time)},
    truth=truth,
)
