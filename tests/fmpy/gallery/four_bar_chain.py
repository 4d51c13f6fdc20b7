"""Chain of four-bars that turns over: a pendulum, whose angle is Jacobi's amplitude.

All posts turn alike and no beam turns. From the upright, with one angle phi and for N beams,
phi'' = omega² sin(phi), where omega² is g (N + 1)/2 + g N over (N + 1)/3 + N in metres.
"""

import numpy as np
from scipy.special import ellipj, ellipk

from . import Case
from .free import LIMITS
from .plane import body, point
from .taylor import Taylor

BEAMS = 2
VELOCITY = 1.0
SQUARE = 9.81 * ((BEAMS + 1) / 2 + BEAMS) / ((BEAMS + 1) / 3 + BEAMS)


def turning(time: Taylor) -> Taylor:
    """The angle from the upright: phi'² = v² + 4 omega² sin²(phi/2), by the energy."""
    fast = SQUARE + VELOCITY**2 / 4
    modulus = SQUARE / fast
    *_, amplitude = ellipj(np.sqrt(fast) * time.value - ellipk(modulus), modulus)
    phi = np.pi + 2 * amplitude
    velocity = np.sqrt(VELOCITY**2 + 4 * SQUARE * np.sin(phi / 2) ** 2)
    return Taylor(phi, velocity, SQUARE * np.sin(phi))


def truth(time, _drivers):
    angle = np.pi / 2 - turning(time)
    tip = Taylor.polar(1.0, angle)
    still = Taylor(*(np.zeros_like(time.value) for _ in range(3)))
    posts = [body(f"post{k}", float(k), angle) for k in range(BEAMS + 1)]
    beams = [body(f"beam{k}", tip + (k - 1), still) for k in range(1, BEAMS + 1)]
    bodies = {name: value for found in posts + beams for name, value in found.items()}
    return bodies | point("post0.A", tip) | {"post_angle": angle}


def properties(motion):
    energy = motion["energy.kinetic"] + motion["energy.potential"]
    beam = np.abs(motion["beam1.phi"]) + np.abs(motion["beam2.phi"])
    return {"energy": energy / energy[0] - 1, "beams do not turn": beam}


CASE = Case(
    source="closed form: Jacobi's amplitude",
    drivers=lambda time: {},
    truth=truth,
    duration=10.0,
    limits=LIMITS,
    properties=properties,
)
