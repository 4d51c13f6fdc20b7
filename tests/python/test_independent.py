"""Motions of every shipped mechanism and all their gradients, against an independent solution.

The package `independent` solves the equations of docs/constraints.md in sixty digits and
differentiates the solution numerically, by differences and by complex steps.
"""

from __future__ import annotations

import warnings
from pathlib import Path

import biela
import numpy as np
import pytest
from independent import Pose, Rounding
from shipped import MECHANISMS, ROOT

TIMES = np.array([0.353, 0.617, 0.911])
"""Times away from those at which the pieces of a prescribed motion meet."""
SHARES = np.array([0.13, 0.45, 0.78])
"""Poses within the range of a driver."""
NEAR_END = np.array([1e-2, 1e-3])
"""Distances from a dead point, as shares of the range."""
VELOCITIES, ACCELERATIONS = np.array([1.3, -0.8, 2.1]), np.array([-3.0, 2.0, 1.0])
"""Rates of drivers, in radians or in sixths of the range [1/s and 1/s²]."""
SAME = 1e-4
"""Share of the bound of rounding that the error of the reference may take: the difference between
central differences and complex steps."""

RATES = {
    "x": ("vx", "ax"),
    "y": ("vy", "ay"),
    "phi": ("omega", "alpha"),
    "position": ("velocity", "acceleration"),
}
OF_FORCES = set("effort power inertia bias fx fy torque tension kinetic potential".split())
"""Variables of forces, which are no part of the motion."""

NEXT_TO_CHANGE_POINTS = {"four_bar_chain": 4}
"""Factors on the bounds of motions for mechanisms of which a pose is next to a change point, where
polynomials give the outputs."""

COMPUTED = {
    "toggle_press": {"advantage", "pin_force"},
    "gripper": {
        f"{measure}.{order}"
        for measure in ("air", "gap")
        for order in ("position", "velocity", "acceleration")
    },
}
"""Measures that the files compute from other variables, which are compared, and clearances of shapes, which
closed forms are compared with in the gallery and in `tests/solver/contacts.rs`."""

OTHER_JOINTS = """
    format = 1
    name = "other_joints"
    parameters.base = { value = 0.2, unit = "m" }
    parameters.first = { value = 0.03, unit = "m" }
    parameters.second = { value = 0.05, unit = "m" }
    parameters.tilt = { value = 0.3, unit = "rad" }
    parameters.offset = { value = 0.01, unit = "m" }
    parameters.gap = { value = 0.03, unit = "m" }
    [ground.markers]
    A = [0, 0]
    B = ["base", 0]
    C = [0.1, 0.15]
    D = [0.35, 0, 0.1]
    E = [0.3, 0.2]
    F = [0.15, 0.3]
    [bodies]
    crank = { markers = { O = [0, 0] } }
    wheel = { markers = { O = [0, 0], R = ["second", 0.01, "tilt"] }, estimate = ["base", 0, 0] }
    plate = { markers = { R = [0.01, 0.02], Q = [0.05, 0] }, estimate = [0.24, 0, 0.3] }
    lever = { markers = { C = [0, 0], K = [0.04, 0], L = [0, 0, "tilt"] }, estimate = [0.1, 0.15, -1] }
    rider = { markers = { M = [0.01, 0] }, estimate = [0.14, 0.1, 0] }
    carriage = { markers = { M = [0, 0.01] }, estimate = [0.15, 0.1, -1] }
    bead = { markers = { B = [0, 0] }, estimate = [0.27, 0.06, 0] }
    block = { markers = { P = [0, 0], S = [0.02, 0.03] }, estimate = [0.4, 0.02, 0] }
    [joints]
    A = { type = "revolute", markers = ["ground.A", "crank.O"] }
    B = { type = "revolute", markers = ["ground.B", "wheel.O"] }
    C = { type = "revolute", markers = ["ground.C", "lever.C"] }
    R = { type = "weld", markers = ["wheel.R", "plate.R"] }
    Q = { type = "revolute_translational", markers = ["lever.L", "plate.Q"], offset = "offset" }
    on = { type = "translational", markers = ["ground.D", "block.P"] }
    carriage_on = { type = "curve", markers = ["lever.L", "carriage.M"], x = "s", y = "offset + gap*cos(s/base)", from = -0.2, to = "base", offset = "offset", follow = true }
    ring = { type = "curve", markers = ["plate.R", "bead.B"], points = { table = [[30, 0], [5, 40], [-30, 5], [0, -20]], scale = ["mm", "mm"] }, closed = true }
    [joints.rope]
    type = "rope"
    markers = ["lever.K", "ground.E", { marker = "block.S", radius = "second/4", side = "right" },
        { marker = "ground.F", radius = "offset", side = "left" }, "ground.C"]
    length = "6*base"
    parts = ["base/0.1", 1, 1, 1]
    [joints.belt]
    type = "belt"
    markers = ["crank.O", "wheel.O"]
    radii = ["first", "second"]
    crossed = true
    [constraints]
    tilted = { coordinate = "angle", markers = ["lever.L", "rider.M"], value = "2*tilt" }
    ahead = { coordinate = "x", markers = ["plate.Q", "rider.M"], axes = "crank.O", value = "gap" }
    along = { coordinate = "distance", markers = ["lever.C", "carriage.M"], value = "5*gap" }
    upright = { coordinate = "angle", markers = ["ground.A", "bead.B"], value = 0 }
    beside = { coordinate = "x", markers = ["ground.A", "bead.B"], value = "1.3*base" }
    away = { coordinate = "distance", markers = ["plate.Q", "rider.M"], value = "3*gap" }
    [drivers]
    turn = { coordinate = "angle", markers = ["ground.A", "crank.O"], start = 0 }
"""
"""Mechanism with the joints and constraints that no shipped mechanism has."""

OTHER_COUPLINGS = """
    format = 1
    name = "other_couplings"
    parameters.base = { value = 0.2, unit = "m" }
    parameters.offset = { value = 0.04, unit = "m" }
    parameters.arm = { value = 0.15, unit = "m" }
    parameters.tilt = { value = 0.3, unit = "rad" }
    parameters.rise = { value = 0.7, unit = "rad" }
    ground.markers = { A = [0, 0], B = ["base", 0], C = [0.1, 0.12] }
    [bodies]
    crank = { markers = { O = [0, 0] } }
    wheel = { markers = { O = [0, 0, "tilt"] }, estimate = ["base", 0, 0] }
    slide = { markers = { S = [0, 0.01] }, estimate = ["base", 0, 0] }
    lever = { markers = { C = [0, 0], L = ["arm", 0.01] }, estimate = [0.1, 0.12, 1] }
    [joints]
    A = { type = "revolute", markers = ["ground.A", "crank.O"] }
    B = { type = "revolute", markers = ["ground.B", "wheel.O"] }
    C = { type = "revolute", markers = ["ground.C", "lever.C"] }
    way = { type = "translational", markers = ["ground.A", "slide.S"] }
    product = { type = "coupling", equation = "travel = base + offset*sin(turn)*cos(2*spin)" }
    swing = { type = "coupling", equation = "far^2 = arm*(travel + offset*spin)" }
    [joints.table]
    type = "coupling"
    equation = "spin = law(turn + tilt)/2 - max(0, sin(turn))^3"
    [joints.table.law]
    table = [[-3, 0], [1, 1], [2, -1], [4, 0]]
    scale = [1, "rise"]
    law = "modified_sine"
    ends = "periodic"
    [drivers]
    turn = { coordinate = "angle", markers = ["ground.A", "crank.O"], start = 0.2 }
    [measures]
    travel = { coordinate = "x", markers = ["ground.A", "slide.S"] }
    spin = { coordinate = "angle", markers = ["crank.O", "wheel.O"] }
    far = { coordinate = "distance", markers = ["slide.S", "lever.L"] }
"""
"""Mechanism with couplings that are not linear: products of coordinates, a distance, a table."""


def rate(name: str, order: int) -> str:
    """Returns the name of the velocity or acceleration of a position."""
    if order == 0:
        return name
    of, _, kind = name.rpartition(".")
    return f"{of}.{RATES[kind][order - 1]}"


def span(mechanism, driver):
    """Returns the ends of a driver's range, at most half a turn from its start [m or rad]."""
    found = mechanism.range(driver.name)
    low, high = -np.pi, np.pi
    if found.lower.value is not None:
        low = max(low, found.lower.value - driver.start)
    if found.upper.value is not None:
        high = min(high, found.upper.value - driver.start)
    return driver.start + low, driver.start + high


def inputs(mechanism):
    """Returns the drivers whose motion the file does not prescribe, and the freedoms."""
    coordinates = [*mechanism.drivers.values(), *mechanism.freedoms.values()]
    return [driver for driver in coordinates if driver.start is not None]


def lively(mechanism):
    """Returns motions of all inputs through much of their ranges."""
    drive = {}
    for place, driver in enumerate(inputs(mechanism)):
        low, high = span(mechanism, driver)
        # Several drivers together meet dead points that each one alone does not.
        way = (low + SHARES * (high - low) - driver.start) / len(inputs(mechanism)) ** 2
        unit = 1.0 if driver.unit == "rad" else (high - low) / 6
        rates = [unit * np.roll(rate, place) for rate in (VELOCITIES, ACCELERATIONS)]
        drive[driver.name] = (driver.start + way, *rates)
    return drive


def assert_within(found, exact, bounds, names):
    """Checks that the errors of these variables are within their bounds."""
    errors = np.abs((found - exact).astype(float))
    wrong = {
        name: (error, bound)
        for name, error, bound in zip(np.ravel(names), errors.ravel(), bounds.ravel())
        if not error <= bound
    }
    assert not wrong


def check(mechanism, t, drive, folder=Path()):
    """Compares all positions, velocities, accelerations and gradients at the times `t`."""
    free = [parameter for parameter in mechanism.parameters.values() if not parameter.derived]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", biela.MechanismWarning)
        result = mechanism.run(t=t, drive=drive, gradient=[parameter.name for parameter in free])
    for row, time in enumerate(t):
        start = {
            body: [result[f"{body}.{x}"][row] for x in ("x", "y", "phi")]
            for body in mechanism.bodies
        }
        rates = {name: [orders[row] for orders in motion] for name, motion in drive.items()}
        pose = Pose(mechanism.text, folder, start, time, rates)
        motion = pose.motion()
        rounding = Rounding(pose, motion, [mechanism.variables[name] for name in pose.names])
        names = np.array([[rate(name, order) for name in pose.names] for order in range(3)])
        found = np.vectorize(lambda name: result[name][row])(names)
        factor = NEXT_TO_CHANGE_POINTS.get(mechanism.name, 1)
        assert_within(found, motion, factor * rounding.of_motion(), names)
        for parameter in free:
            exact = pose.gradient(parameter.name)
            bounds = rounding.of_gradient(exact, parameter.value, parameter.unit)
            assert_within(pose.complex_gradient(parameter.name), exact, SAME * bounds, names)
            found = np.vectorize(lambda name: result.gradient[name, parameter.name][row])(names)
            assert_within(found, exact, bounds, names)
    return set(result), set(names.ravel())


def test_motions_and_gradients_of_shipped_mechanisms(any_mechanism):
    variables, compared = check(any_mechanism, TIMES, lively(any_mechanism), ROOT / "mechanisms")
    moved = variables - compared - set(any_mechanism.inputs)
    left = {name for name in moved if name.rpartition(".")[2] not in OF_FORCES}
    assert left == COMPUTED.get(any_mechanism.name, set())


def test_exceptions_are_of_shipped_mechanisms():
    assert set(COMPUTED) | set(NEXT_TO_CHANGE_POINTS) <= {path.stem for path in MECHANISMS}


@pytest.mark.parametrize("text", [OTHER_JOINTS, OTHER_COUPLINGS])
def test_motions_and_gradients_of_other_joints(text):
    mechanism = biela.loads(text)
    check(mechanism, TIMES, lively(mechanism))


@pytest.mark.parametrize(
    "name", ["hart_inversor", "pantograph", "peaucellier", "platform_3rpr", "tlv"]
)
def test_motions_and_gradients_next_to_dead_points(mechanism, name):
    """One driver goes to a dead point, the others keep their starts."""
    moved = mechanism(name)
    first, *others = inputs(moved)
    end = moved.range(first.name).upper
    assert end.kind == "singular"
    drive = {driver.name: (np.full(2, driver.start), 1.0, 0.3) for driver in others}
    drive[first.name] = (end.value + NEAR_END * (first.start - end.value), 0.7, -0.4)
    check(moved, TIMES[:2], {name: np.broadcast_arrays(*drive[name]) for name in {**moved.drivers, **moved.freedoms}})
