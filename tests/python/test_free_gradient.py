"""Gradients of free motions by parameters and by starts: variational equations beside the motion."""

from __future__ import annotations

import biela
import numpy as np
import pytest
from numpy.testing import assert_allclose
from shipped import ROOT
from test_gradient import differences

BLOCK = """
format = 1
name = "block"
parameters = { stiffness = 30.0, weight = 0.8 }
ground.markers = { O = [0, 0] }
bodies.block = { mass = "weight", markers = { B = [0, 0] } }
joints.guide = { type = "translational", markers = ["ground.O", "block.B"] }
freedoms.x = { coordinate = "x", markers = ["ground.O", "block.B"], start = 0.2, velocity = -0.5 }
forces.spring = { coordinate = "x", markers = ["ground.O", "block.B"], stiffness = "stiffness", free = 0 }
simulation.tolerance = 1e-10
"""


def test_a_block_on_a_spring_in_closed_form():
    """x = x0 cos(w t) + v0/w sin(w t), w = sqrt(k/m), over three periods."""
    k, m, x0, v0 = 30.0, 0.8, 0.2, -0.5
    t = np.linspace(0, 3, 31)
    by = ["stiffness", "weight", "x.position", "x.velocity"]
    result = biela.loads(BLOCK).run(t=t, gradient=by)
    w = np.sqrt(k / m)
    cosine, sine = np.cos(w * t), np.sin(w * t)
    by_w = -x0 * t * sine + v0 / w * t * cosine - v0 / w**2 * sine
    expected = [by_w * w / (2 * k), -by_w * w / (2 * m), cosine, sine / w]
    assert_allclose(result["x.position"], x0 * cosine + v0 / w * sine, atol=1e-9)
    for name, exact in zip(by, expected, strict=True):
        # The tolerance of a step, 1e-13, adds up over some hundred of them.
        assert_allclose(result.gradient["x.position", name], exact, atol=1e-10)
    # Accelerations follow from the equations of motion: a = -k/m x.
    acceleration = -result["x.position"] / m - k / m * result.gradient["x.position", "stiffness"]
    assert_allclose(result.gradient["block.ax", "stiffness"], acceleration, atol=1e-11)


ROCKER = "triple_rocker"
"""Its coordinates meet their dead points: the motion goes through exchanges."""


def text_of(name):
    folder = ROOT / "tests/fmpy/mechanisms" if name == ROCKER else ROOT / "mechanisms"
    text = (folder / f"{name}.toml").read_text(encoding="utf-8")
    if "tolerance = " in text:
        return text
    return text.replace("[simulation]\n", "[simulation]\ntolerance = 1e-10\n")


FREE = {
    "pendulum_free": 1.0,
    "double_pendulum": 0.6,
    "engine_free": 0.1,
    "five_bar_free": 0.4,
    "four_bar_chain": 0.5,
    "four_bar_free": 0.8,
    "slider_crank_motor": 0.5,
    "swinging_tip": 0.6,
    "cart_pole": 0.6,
    ROCKER: 0.5,
}
"""Mechanisms with the ends of their motions, before which neighbours have not gone far apart."""


@pytest.mark.parametrize("name", FREE)
def test_gradients_are_those_of_differences(name):
    """Of order 8 between runs, whose errors of some 1e-11 are divided by a step of 1e-3."""
    mechanism = biela.loads(text_of(name))
    t = np.linspace(0, FREE[name], 6)
    starts = {
        variable: mechanism.run(t=[0.0])[variable][0]
        for variable in mechanism.variables
        if variable.split(".")[0] in mechanism.freedoms
        and variable.endswith((".position", ".velocity"))
    }
    parameters = {p.name: p.value for p in mechanism.parameters.values() if not p.derived}
    # The first and the last of them: a length and a mass, a spring or a friction.
    chosen = [*parameters][:1] + [*parameters][-1:]
    values = {name: parameters[name] for name in chosen} | starts
    drive = {}
    if any(variable == "motor.effort" for variable in mechanism.variables):
        drive["motor.effort"] = "0.5 + 0.3*sin(5*t)"
    result = mechanism.run(t=t, drive=drive, gradient=list(values))
    for place, (parameter, value) in enumerate(values.items()):
        scale = max(abs(value), 0.01)
        difference = differences(mechanism, parameter, value, scale, t=t, drive=drive)
        found = result.gradient.to_numpy()[:, place]
        size = np.abs(difference).max(axis=0) + np.abs(result.to_numpy()).max(axis=0)
        off = np.abs(found - difference) / (1 + size)
        assert off.max() < 1e-7, (parameter, list(mechanism.variables)[off.max(axis=0).argmax()])
    assert np.abs(result.gradient.to_numpy()).max() > 0.1


def test_a_fit_needs_to_know_how_a_freedom_moves():
    mechanism = biela.loads(BLOCK)
    with pytest.raises(biela.UsageError, match="how freedom `x` moves"):
        biela.fit(mechanism, biela.Target({"block.x": [0.3]}), free=["weight"])
