"""Shipped mechanisms and small motions of theirs, for all tests here."""

from __future__ import annotations

from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
MECHANISMS = sorted((ROOT / "mechanisms").glob("*.toml"))


def small_motion(mechanism, t):
    """Returns motions of all inputs and freedoms by a few hundredths of a radian or of their length, with rates
    that do not vanish."""
    drive = {}
    for place, driver in enumerate([*mechanism.drivers.values(), *mechanism.freedoms.values()]):
        if driver.start is None:
            continue
        size = 0.03 if driver.unit == "rad" else 0.01 * max(abs(driver.start), 0.01)
        phase = 0.3 + 0.7 * place
        drive[driver.name] = (
            driver.start + size * (np.sin(t + phase) - np.sin(phase)),
            size * np.cos(t + phase),
            -size * np.sin(t + phase),
        )
    return drive
