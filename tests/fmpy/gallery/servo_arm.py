"""Positioned arm: one equation, integrated from corner to corner and from bounce to bounce."""

import numpy as np
from scipy.integrate import solve_ivp

from . import Case
from .free import LIMITS, TOLERANCE
from .plane import body
from .taylor import Taylor

GOAL, END, RESTITUTION = np.radians(60), np.radians(62), 0.4
SUPPLY, GAIN, RATE_GAIN, CONSTANT, RESISTANCE = 24.0, 90.0, 0.3, 2.4, 1.6
MASS, ARM = 1.2, 0.15
INERTIA = 0.073 + MASS * ARM**2


def asked(x):
    return GAIN * (GOAL - x[0]) - RATE_GAIN * x[1]


def rates(piece):
    """The rates where the voltage is at a limit (-1, 1) or between them (0)."""

    def of(_t, x):
        voltage = asked(x) if piece == 0 else piece * SUPPLY
        torque = CONSTANT * (voltage - CONSTANT * x[1]) / RESISTANCE
        weight = MASS * 9.81 * ARM * np.cos(x[0])
        return [x[1], (torque - weight) / INERTIA]

    return of


def integrated(times):
    def ends(of):
        of.terminal = True
        return of

    events = [
        ends(lambda t, x: asked(x) - SUPPLY),
        ends(lambda t, x: asked(x) + SUPPLY),
        ends(lambda t, x: END - x[0]),
    ]
    t, x = 0.0, np.array([0.0, 0.0])
    piece = 1
    found = {0.0: (x.copy(), rates(piece)(0.0, x)[1])}
    while t < times[-1]:
        run = solve_ivp(
            rates(piece), (t, times[-1]), x, method="DOP853", dense_output=True,
            events=events, rtol=TOLERANCE, atol=TOLERANCE,
        )
        for time in times[(times > t) & (times <= run.t[-1])]:
            state = run.sol(time)
            found[time] = (state, rates(piece)(time, state)[1])
        t, x = run.t[-1], run.y[:, -1].copy()
        if run.status != 1:
            break
        which = next(k for k, at in enumerate(run.t_events) if at.size)
        if which == 2:
            x[1] *= -RESTITUTION
        # On from a little behind, by the rates there.
        piece = 0
        ahead = asked(x + 1e-9 * np.array(rates(0)(t, x)))
        piece = int(np.sign(ahead)) if abs(ahead) > SUPPLY else 0
        step = 1e-12
        x = x + step * np.array(rates(piece)(t, x))
        t += step
    values = [found[time] for time in times]
    return Taylor(
        np.array([state[0] for state, _ in values]),
        np.array([state[1] for state, _ in values]),
        np.array([second for _, second in values]),
    )


KNOWN: dict[bytes, Taylor] = {}


def truth(time, _drivers):
    key = time.value.tobytes()
    if key not in KNOWN:
        KNOWN[key] = integrated(time.value)
    angle = KNOWN[key]
    return body("arm", 0, angle) | {"angle": angle}


CASE = Case(
    source="equation of motion, integrated from event to event",
    drivers=lambda time: {},
    truth=truth,
    duration=0.5,
    steps=500,
    limits=LIMITS,
)
