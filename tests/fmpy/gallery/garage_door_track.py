"""Garage door: the upper roller is where a natural spline through the points meets a circle."""

from __future__ import annotations

import numpy as np
from harness import ROOT

from . import Case, swing
from .plane import body, point
from .taylor import Taylor

LENGTH, HANDLE, CENTER = 1.80, 0.9 + 0.05j, 0.9
MASS, INERTIA, RATE, FREE, G = 48.0, 13.0, 330.0, 1.5, 9.81
POINTS = np.loadtxt(ROOT / "mechanisms" / "garage_door_track.csv", delimiter=",", skiprows=1)


def spline() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The knots, the points and the second derivatives there, from one dense linear system."""
    at = POINTS @ [1, 1j]
    knots = np.concatenate([[0], np.cumsum(abs(np.diff(at)))])
    h, slope = np.diff(knots), np.diff(at) / np.diff(knots)
    matrix, side = np.eye(len(at)), np.zeros(len(at), dtype=complex)
    for k in range(1, len(at) - 1):
        matrix[k, k - 1 : k + 2] = h[k - 1], 2 * (h[k - 1] + h[k]), h[k]
        side[k] = 6 * (slope[k] - slope[k - 1])
    return knots, at, np.linalg.solve(matrix, side)


KNOTS, AT, BENDS = spline()


def on_track(way: Taylor) -> tuple[Taylor, Taylor]:
    """The point after a way along the chords, and its derivative by the way."""
    k = np.clip(np.searchsorted(KNOTS, way.value, side="right") - 1, 0, len(AT) - 2)
    h = KNOTS[k + 1] - KNOTS[k]
    third = (BENDS[k + 1] - BENDS[k]) / h
    first = (AT[k + 1] - AT[k]) / h - h * (2 * BENDS[k] + BENDS[k + 1]) / 6
    d = way.value - KNOTS[k]
    value = AT[k] + d * (first + d * (BENDS[k] / 2 + d * third / 6))
    slope = first + d * (BENDS[k] + d * third / 2)
    bend = BENDS[k] + d * third
    return way.chain(value, slope, bend), way.chain(slope, bend, third)


def geometry(lift: Taylor) -> tuple[Taylor, Taylor]:
    """The upper roller, and the direction of the door: Newton's method on jets."""
    way = lift + (LENGTH - AT[0].imag)
    for _ in range(60):
        roller, slope = on_track(way)
        door = roller - 1j * lift
        rest = door.length_squared() - LENGTH**2
        rate = 2 * (door.x * slope.x + door.y * slope.y)
        # Half of the way at first: the track bends.
        way = way - 0.7 * (rest / rate)
    for _ in range(8):
        roller, slope = on_track(way)
        door = roller - 1j * lift
        rest = door.length_squared() - LENGTH**2
        way = way - rest / (2 * (door.x * slope.x + door.y * slope.y))
    roller, _ = on_track(way)
    return roller, (roller - 1j * lift) / LENGTH


def truth(_time, drivers):
    lift = drivers["lift"]
    _, along = geometry(lift)
    return body("door", 1j * lift, along.angle()) | point(
        "door.handle", 1j * lift + along * HANDLE
    )


def properties(motion):
    """Virtual work: the hand lifts what weight, inertia and springs ask for per metre."""
    lift = Taylor(*(motion[f"lift.{o}"] for o in ("position", "velocity", "acceleration")))
    _, along = geometry(Taylor.time(lift.value))
    centre = 1j * Taylor.time(lift.value) + along * CENTER
    phi = along.angle()
    v, a = lift.first, lift.second
    needed = MASS * (centre.first * a + centre.second * v**2 + 1j * G)
    turning = INERTIA * (phi.first * a + phi.second * v**2)
    effort = (np.conj(centre.first) * needed).real + phi.first * turning
    effort -= RATE * (FREE - lift.value)
    return {"effort": (motion["lift.effort"] - effort) / np.max(abs(effort))}


CASE = Case(
    source="natural spline and a circle, by Newton's method; virtual work",
    drivers=lambda time: {"lift": swing(1.05, 1.0)(time)},
    truth=truth,
    properties=properties,
)
