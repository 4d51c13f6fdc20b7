"""Gradients of whole motions by parameters, against differences of high order and closed forms."""

from __future__ import annotations

import re
import warnings

import biela
import mpmath
import numpy as np
import pytest
from shipped import small_motion
from numpy.testing import assert_allclose

# Central differences of order 8: the weights of f(+kh) − f(−kh).
WEIGHTS = (4 / 5, -1 / 5, 4 / 105, -1 / 280)
STEP = 1e-3
"""Step of the differences, relative. The truncation is of order STEP^8 = 1e-24 times the ninth
derivative, which a mechanism near a dead point has large; the rounding is 1e-16 / STEP = 1e-13
times the condition of positions, and rates lose some digits more."""
TOLERANCE = 1e-10
FORCES = ("fx", "fy", "torque", "tension", "effort")
"""Last parts of the names of forces."""
TIMES = np.array([0.037, 0.353, 0.617, 0.911])
"""Times away from those at which the pieces of a prescribed motion meet, for all periods tried."""


def differences(mechanism, name, value, scale, **run):
    """Returns the derivative of all variables by a parameter."""
    total = 0.0
    for k, weight in enumerate(WEIGHTS, start=1):
        for sign in (1, -1):
            parameters = {name: value + sign * k * STEP * scale}
            total = total + sign * weight * mechanism.run(parameters=parameters, **run).to_numpy()
    return total / (STEP * scale)


def test_gradients_are_those_of_differences(any_mechanism):
    t = TIMES
    drive = small_motion(any_mechanism, t)
    free = [p for p in any_mechanism.parameters.values() if not p.derived]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", biela.MechanismWarning)
        result = any_mechanism.run(t=t, drive=drive, gradient=[p.name for p in free])
        forces = [name.rpartition(".")[2] in FORCES for name in result]
        for place, parameter in enumerate(free):
            scale = max(abs(parameter.value), 0.01)
            expected = differences(
                any_mechanism, parameter.name, parameter.value, scale, t=t, drive=drive
            )
            found = result.gradient.to_numpy()[:, place]
            # Each variable by its own size, and by that of its gradient.
            size = np.abs(result.to_numpy()).max(axis=0) / scale + np.abs(expected).max(axis=0)
            # Forces that cancel have the rounding of those that do not.
            size[forces] = size[forces].max(initial=0)
            assert np.all(np.abs(found - expected) <= TOLERANCE * (size + 1)), parameter.name


def test_a_four_bar_by_its_lengths_in_fifty_digits(four_bar):
    """The rocker's angle, its rate and its acceleration, by the crank's length and the base."""
    mpmath.mp.dps = 50
    at, omega, alpha = 1.3, 2.0, -0.7

    def angle(crank, base, t):
        theta = mpmath.mpf(at) + omega * t + mpmath.mpf(alpha) * t**2 / 2
        x, y = crank * mpmath.cos(theta) - base, crank * mpmath.sin(theta)
        square = x * x + y * y
        cosine = (mpmath.mpf(3) ** 2 / 100 + square - mpmath.mpf(1) / 16) / (
            2 * mpmath.mpf(3) / 10 * mpmath.sqrt(square)
        )
        return mpmath.atan2(y, x) - mpmath.acos(cosine)

    lengths = mpmath.mpf(1) / 10, mpmath.mpf(4) / 10
    result = four_bar.run(
        drive={"crank_angle": (at, omega, alpha)}, gradient=["crank_length", "base"]
    )
    for order, variable in enumerate(["rocker.phi", "rocker.omega", "rocker.alpha"]):
        for parameter, counts in [("crank_length", (1, 0, order)), ("base", (0, 1, order))]:
            exact = float(mpmath.diff(angle, (*lengths, mpmath.mpf(0)), counts))
            assert_allclose(result.gradient[variable, parameter][0], exact, rtol=1e-12)


def test_a_motion_that_depends_on_a_parameter_carries_it(mechanism):
    pendulum = biela.loads(
        """
        format = 1
        name = "wheel"
        parameters.rate = 3.0
        ground.markers = { O = [0, 0] }
        bodies.wheel = { markers = { O = [0, 0] }, estimate = [0, 0, 0] }
        joints.O = { type = "revolute", markers = ["ground.O", "wheel.O"] }
        drivers.turn = { coordinate = "angle", markers = ["ground.O", "wheel.O"], motion = "rate*t^2" }
        """
    )
    t = np.array([0.0, 0.5, 2.0])
    gradient = pendulum.run(t=t, gradient="rate").gradient
    assert_allclose(gradient["wheel.phi", "rate"], t**2, rtol=1e-15)
    assert_allclose(gradient["wheel.omega", "rate"], 2 * t, rtol=1e-15)
    assert_allclose(gradient["wheel.alpha", "rate"], 2.0, rtol=1e-15)


def test_unknown_names_are_told(four_bar):
    gradient = four_bar.run(t=[0.0], gradient=["base"]).gradient
    with pytest.raises(biela.UsageError, match="no variable `rocker.psi`"):
        gradient["rocker.psi", "base"]
    with pytest.raises(biela.UsageError, match="no parameter among `gradient` `bas`"):
        gradient["rocker.phi", "bas"]
    with pytest.raises(biela.UsageError, match=r"gradient\[variable, parameter\]"):
        gradient["rocker.phi"]


def test_a_gradient_is_a_mapping(four_bar):
    result = four_bar.run(t=[0.0, 0.1], variables=["rocker.phi"], gradient=["base", "crank_length"])
    gradient = result.gradient
    assert list(gradient) == [("rocker.phi", "base"), ("rocker.phi", "crank_length")]
    assert len(gradient) == len(gradient.keys()) == 2
    assert ("rocker.phi", "base") in gradient and ("rocker.phi", "rocker_length") not in gradient
    assert "rocker.phi" not in gradient
    for (variable, parameter), values in gradient.items():
        assert values is not None and (values == gradient[variable, parameter]).all()
    assert gradient.get(("rocker.phi", "rocker_length")) is None
    assert not four_bar.run(t=[0.0]).gradient
    with pytest.raises(KeyError, match="^no parameter among `gradient` `bas`"):
        gradient["rocker.phi", "bas"]


def test_all_parameters_are_those_that_can_be_set(any_mechanism):
    t = [0.0]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", biela.MechanismWarning)
        drive = small_motion(any_mechanism, np.array(t))
        gradient = any_mechanism.run(t=t, drive=drive, gradient="all").gradient
    free = [p.name for p in any_mechanism.parameters.values() if not p.derived]
    assert gradient.parameters == free and np.isfinite(gradient.to_numpy()).all()


def test_a_parameter_that_calls_a_function_is_derived():
    """The length follows from the load by a curve, whose slope the gradient has."""
    text = """
format = 1
name = "arm"
[parameters]
load = { value = 3, unit = "N", tunable = true }
length = { value = "stretched(load)", unit = "m" }
[functions]
stretched = { of = ["force"], value = "curve(force) + 0.01*load^2" }
curve = { table = [[0, 1], [2, 1.5], [6, 1.7]], law = "linear" }
[ground.markers]
O = [0, 0]
[bodies.arm]
markers = { O = [0, 0], P = ["length", 0] }
[joints]
O = { type = "revolute", markers = ["ground.O", "arm.O"] }
[drivers]
turn = { coordinate = "angle", markers = ["ground.O", "arm.O"], start = 0 }
[outputs]
markers = ["arm.P"]
"""
    arm = biela.loads(text)
    found = arm.run(drive={"turn": [0.0]}, gradient=["load"])
    assert_allclose(found["arm.P.x"], 1.5 + 0.05 + 0.09, rtol=1e-15)
    assert_allclose(found.gradient["arm.P.x", "load"], 0.05 + 0.06, rtol=1e-14)
    moved = arm.run(drive={"turn": [0.0]}, parameters={"load": 1.0})
    assert_allclose(moved["arm.P.x"], 1.25 + 0.01, rtol=1e-15)
    with pytest.raises(biela.UsageError, match="`length` is derived from other parameters"):
        arm.run(drive={"turn": [0.0]}, parameters={"length": 1.0})
    line = re.search(r'<ScalarVariable name="length"[^>]*>', arm.model_description())[0]
    assert 'causality="calculatedParameter"' in line and 'variability="tunable"' in line
