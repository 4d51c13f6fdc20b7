"""Positions by Newton's method; their rates and gradients by differences and complex steps."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from .constraints import gap
from .digits import mp
from .mechanism import Mechanism

STEP = mp.mpf("1e-12")
"""Step in time [s] and of parameters, relative. The derivative of an acceleration by a parameter is
a third difference: its rounding is 1e-60 / STEP^3 = 1e-24, its truncation STEP^2 = 1e-24 times two
further derivatives. A complex step has the same truncation and less rounding."""
SOLVED = mp.mpf("1e-57")
"""Correction at which Newton's method ends [m or rad]: 1e-60 times a condition of 1000."""
NEAR = 1e-9
"""Correction up to which the Jacobian is kept: each iteration gains nine digits then."""
JACOBIAN_STEP = mp.mpf("1e-30")
"""Step of the differences of residuals: half the digits are left, twice those of a double."""


class Pose:
    """Pose of a mechanism at the time `t`, with the motions of its drivers.

    `start` has approximate coordinates of each body; `drive` has position, velocity and
    acceleration of each driver whose motion the file does not prescribe. The mechanism has as many
    independent equations as unknowns: redundant ones would make the Jacobian singular.
    """

    def __init__(self, text: str, folder: Path, start: dict, t: float, drive: dict):
        self.text, self.folder = text, folder
        self.t = mp.mpf(t)
        self.drive = {name: [mp.mpf(rate) for rate in rates] for name, rates in drive.items()}
        self.mechanism = Mechanism(text, folder)
        q = [mp.mpf(value) for body in self.mechanism.bodies for value in start[body]]
        self.q = np.array(q + contact_angles(self.mechanism, q))
        self.renew_jacobian(self.mechanism, self.q, self.driven(self.mechanism, mp.zero))
        self.q = self.solve(self.mechanism, mp.zero)
        self.names = list(self.mechanism.place(self.q).positions())

    def driven(self, mechanism: Mechanism, tau) -> dict:
        """Returns the values of all drivers, `tau` after the pose."""
        given = {name: u + v * tau + a * tau**2 / 2 for name, (u, v, a) in self.drive.items()}
        return given | {name: at(self.t + tau) for name, at in mechanism.motions.items()}

    def renew_jacobian(self, mechanism: Mechanism, q, driven: dict):
        """Sets the Jacobian of the residuals and its inverse, in double precision."""
        at = np.array(mechanism.place(q).residual(driven))
        columns = []
        for step in np.diag([JACOBIAN_STEP] * len(q)):
            columns.append((mechanism.place(q + step).residual(driven) - at) / JACOBIAN_STEP)
        self.jacobian = np.array(columns, dtype=float).T
        self.inverse = np.linalg.inv(self.jacobian)

    def solve(self, mechanism: Mechanism, tau):
        """Returns the coordinates `tau` after the pose.

        The residuals have sixty digits, the inverse Jacobian sixteen: that costs iterations, not
        accuracy.
        """
        q, driven = self.q, self.driven(mechanism, tau)
        for _ in range(50):
            correction = self.inverse @ doubles(mechanism.place(q).residual(driven))
            q = q - [mp.convert(x) for x in correction.tolist()]
            size = np.abs(correction).max()
            if size < SOLVED:
                return q
            if size > NEAR:
                self.renew_jacobian(mechanism, q, driven)
        raise ArithmeticError(f"the last correction is {size}")

    def positions(self, mechanism: Mechanism, tau):
        """Returns all positions, `tau` after the pose, in the order of `names`."""
        return np.array(list(mechanism.place(self.solve(mechanism, tau)).positions().values()))

    def motion(self, changed: dict | None = None):
        """Returns positions, velocities and accelerations, with some parameters changed."""
        mechanism = Mechanism(self.text, self.folder, changed) if changed else self.mechanism
        before, now, after = [self.positions(mechanism, k * STEP) for k in (-1, 0, 1)]
        return np.array([now, (after - before) / (2 * STEP), (after - 2 * now + before) / STEP**2])

    def parameter(self, name: str):
        """Returns the value of a parameter and a step for it."""
        value = self.mechanism.names[name]
        return value, STEP * max(abs(value), mp.mpf("0.01"))

    def gradient(self, parameter: str):
        """Returns the derivatives of the motion by a parameter, by central differences."""
        value, step = self.parameter(parameter)
        after, before = [self.motion({parameter: value + sign * step}) for sign in (1, -1)]
        return (after - before) / (2 * step)

    def complex_gradient(self, parameter: str):
        """Returns the derivatives of the motion by a parameter, by the complex step."""
        value, step = self.parameter(parameter)
        motion = self.motion({parameter: mp.mpc(value, step)})
        return np.array([[x.imag for x in row] for row in motion]) / step


def doubles(values):
    """Returns the values in double precision; real and imaginary parts keep their own digits."""
    is_complex = any(isinstance(value, mp.mpc) for value in values)
    return np.array(values, dtype=complex if is_complex else float)


def contact_angles(mechanism: Mechanism, q) -> list:
    """Returns the polar angle of each contact, to a degree, or the place on a curve: the contour is
    nearest there."""
    placed = mechanism.place(q)
    found = []
    for place in sorted([*mechanism.profiles, *mechanism.curves]):
        entry = placed.entry(mechanism.joints[place], place)
        turn = mp.linspace(-mp.pi, mp.pi, 361) if place in mechanism.profiles else mp.linspace(0, 1, 361)
        found.append(min(turn, key=lambda angle: gap(entry._replace(contact=angle))))
    return found
