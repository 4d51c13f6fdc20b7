"""Impacts and friction: the FMU in co-simulation and CVode in model exchange meet the closed form."""

from __future__ import annotations

import numpy as np
import pytest
from fmpy import simulate_fmu
from numpy.testing import assert_allclose

G, RESTITUTION = 9.81, 0.8
OWN = ["height.position", "height.velocity", "way.position", "way.velocity"]
END = 2.8


def ball(times):
    """Height and velocity of a ball that falls from 1 m, and the instants of its impacts."""
    instants, speed = [np.sqrt(2 / G)], np.sqrt(2 * G)
    places = np.empty((len(times), 2))
    for row, time in enumerate(times):
        start, up = 0.0, 0.0
        fall, rise = np.sqrt(2 / G), np.sqrt(2 * G)
        height = 1.0
        while time > start + fall:
            start, height = start + fall, 0.0
            rise *= RESTITUTION
            up, fall = rise, 2 * rise / G
        tau = time - start
        places[row] = height + up * tau - G * tau**2 / 2, up - G * tau
    while instants[-1] < END:
        speed *= RESTITUTION
        instants.append(instants[-1] + 2 * speed / G)
    return places, instants[:-1]


def block(times):
    """Place and velocity of a block whose amplitude falls by 2 F / k in each half period."""
    omega, shift = 10.0, 12 / 200
    places = np.empty((len(times), 2))
    for row, time in enumerate(times):
        half = min(int(time * omega / np.pi), 8)
        amplitude, sign = 1 - (2 * half + 1) * shift, (-1.0) ** half
        angle = omega * time - half * np.pi
        center = sign * shift
        places[row] = (
            (center + sign * amplitude * np.cos(angle), -sign * amplitude * omega * np.sin(angle))
            if half < 8
            else (1 - 16 * shift, 0.0)
        )
    return places


# In one a floor throws the ball back, and the rail has a given force; in the other a rope does, and the
# guide's friction is a part of its reaction.
@pytest.mark.parametrize("name", ["ball_and_block", "ball_on_rope"])
@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("interface", ["CoSimulation", "ModelExchange"])
def test_either_interface_meets_the_closed_form(fmu, fmu3, version, interface, name):
    exported = {2: fmu, 3: fmu3}[version](name)
    result = simulate_fmu(
        exported.folder,
        model_description=exported.description,
        fmi_type=interface,
        solver="CVode",
        stop_time=END,
        output_interval=0.07,
        step_size=0.07,
        relative_tolerance=1e-10,
        output=OWN,
        record_events=True,
    )
    # Samples at events come twice, before and after: the last one at a time counts.
    times, last = np.unique(result["time"][::-1], return_index=True)
    rows = result[::-1][last]
    wanted = np.hstack([ball(times)[0], block(times)])
    _, instants = ball([])
    # An instant that is known to 1e-8 s moves what bounces there by its speed.
    calm = np.array([np.abs(np.subtract(instants, time)).min() > 1e-6 for time in times])
    tolerance = 1e-8 if interface == "CoSimulation" else 1e-6
    for column, name in enumerate(OWN):
        assert_allclose(rows[name][calm], wanted[calm, column], rtol=0, atol=tolerance)
    if interface == "ModelExchange":
        # The host has found each impact, and the first of the block's turns.
        found = times[~calm]
        assert len(found) == len(instants)
        assert_allclose(found, instants, rtol=0, atol=1e-7)
