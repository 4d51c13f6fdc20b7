"""Block and tackle: the rope's sloping parts put the block on an ellipse about the two points."""

from __future__ import annotations

import numpy as np

from . import Case, swing
from .plane import body
from .taylor import Taylor

LENGTH, PARTS = 4.00, 2
LEFT, RIGHT = -0.30 + 0j, 0.50 + 0.10j
WAY, ALONG = 0.62 + 0.05j, np.exp(-1j * np.radians(75))
LOAD, HAND, G = 80.0, 1.5, 9.81


def geometry(haul: Taylor):
    """The hand, and the block: the distances to the two points have a given sum M, and the
    difference of their squares is linear in the height y, so that the first is p + q·y."""
    hand = WAY + ALONG * haul
    sum_ = (LENGTH - (hand - RIGHT).length()) / PARTS
    a, b, c = -LEFT.real, RIGHT.real, RIGHT.imag
    p = (sum_ + (a**2 - b**2 - c**2) / sum_) / 2
    q = c / sum_
    square = 1 - q.square()
    y = (p * q - ((p * q).square() + square * (p.square() - a**2)).sqrt()) / square
    return hand, 1j * y


def truth(_time, drivers):
    hand, block = geometry(drivers["haul"])
    return body("hand", hand, 0) | body("block", block, 0) | {"depth": -block.y}


def properties(motion):
    """The rope carries the load; its last part and the hand's weight and inertia make the pull."""
    haul = Taylor(*(motion[f"haul.{o}"] for o in ("position", "velocity", "acceleration")))
    hand, block = geometry(haul)
    upwards = sum(((end - block) / (end - block).length()).y.value for end in (LEFT, RIGHT))
    tension = LOAD * (block.y.second + G) / (PARTS * upwards)
    pulled = (hand - RIGHT) / (hand - RIGHT).length()
    along = (np.conj(ALONG) * pulled.value).real
    weight = HAND * (haul.second + G * ALONG.imag)
    effort = weight + tension * along
    return {
        "tension": (motion["tackle.tension"] - tension) / (LOAD * G),
        "effort": (motion["haul.effort"] - effort) / (LOAD * G),
    }


CASE = Case(
    source="closed form: an ellipse about two points; equilibrium",
    drivers=lambda time: {"haul": swing(0.75, 0.25)(time)},
    truth=truth,
    properties=properties,
)
