"""Free motion: events, starts, equilibria, linear equations, and what a mechanism is made of."""

from __future__ import annotations

import sys
import types
import warnings

import biela
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

G = 9.81
AT_TOLERANCE = 1e-6
"""Error of motions with a relative tolerance of 1e-8 over some bounces."""

BALL = """
format = 1
name = "ball"
parameters = { bounce = 0.5, weight = { value = 2.0, unit = "kg", description = "Mass of the ball" } }
ground.markers = { O = [0, 0, "90*deg"] }
bodies.ball = { mass = "weight", markers = { C = [0, 0, "90*deg"] } }
joints.way = { type = "translational", markers = ["ground.O", "ball.C"] }
simulation.tolerance = 1e-10

[freedoms]
height = { coordinate = "x", markers = ["ground.O", "ball.C"], start = 1.0, description = "Above the floor" }

[stops]
table = { of = "height", min = 0, restitution = "bounce" }

[forces]
lift = { coordinate = "x", markers = ["ground.O", "ball.C"], description = "Of a hand" }
wind = { coordinate = "x", markers = ["ground.O", "ball.C"], damping = 1e-12, description = "Nearly none" }
"""


@pytest.fixture(scope="module")
def ball():
    return biela.loads(BALL)


def bounces(height, restitution, count):
    """Returns times and speeds of the first impacts of a ball that falls from a height at rest."""
    speed = np.sqrt(2 * G * height)
    times, speeds = [speed / G], [speed]
    for _ in range(count - 1):
        speed *= restitution
        times.append(times[-1] + 2 * speed / G)
        speeds.append(speed)
    return np.array(times), np.array(speeds)


def test_events_have_the_times_and_speeds_of_a_bouncing_ball(ball):
    times, speeds = bounces(1.0, 0.5, 3)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        result = ball.run(t=[0, 1.2])
    assert [(event.kind, event.name) for event in result.events] == [("impact", "table")] * 3
    assert_allclose([event.time for event in result.events], times, rtol=AT_TOLERANCE)
    assert_allclose([event.speed for event in result.events], speeds, rtol=AT_TOLERANCE)
    rest = ball.run(t=[0, 3]).events
    assert rest[-1].kind == "rests" and rest[-1].speed is None
    # 1.0 m · (1 + e)/(1 − e) of fall time in all: the geometric series.
    assert_allclose(rest[-1].time, times[0] * (1 + 0.5) / (1 - 0.5), rtol=1e-3)


def test_a_sweep_has_the_events_of_its_runs(ball):
    bounce = np.array([[0.3, 0.5, 0.7], [0.9, 0.4, 0.2]])
    sweep = ball.sweep({"bounce": bounce, "height.position": 0.8}, t=[0, 1.0], variables="height")
    assert set(sweep.events) == set(np.ndindex(2, 3))
    for place in np.ndindex(2, 3):
        own = ball.run(t=[0, 1.0], parameters={"bounce": bounce[place], "height.position": 0.8})
        assert sweep.events[place] == own.events
        for name in sweep:
            assert_array_equal(sweep[name][place], own[name])
    assert ball.sweep({"bounce": 0.5}, t=[0, 1.0], variables="height").events.keys() == {()}


def test_starts_are_swept(ball):
    heights = np.linspace(0.5, 2, 40)
    sweep = ball.sweep({"height.position": heights, "height.velocity": 0.1}, t=[0, 0.2], variables="height")
    expected = heights + 0.1 * 0.2 - G * 0.2**2 / 2
    assert_allclose(sweep["height.position"][:, -1], expected, rtol=AT_TOLERANCE)
    both = sweep.to_xarray()
    assert both["height.position"].dims == ("start.height.position", "time")
    assert_array_equal(both["start.height.position"], heights)
    assert sweep.to_pandas().index.names == ["start.height.position", "start.height.velocity", "time"]
    nowhere = ball.sweep({"height.velocity": [0.0, np.nan]}, t=[0, 0.2], variables="height")
    assert list(nowhere.ok) == [True, False] and "no start of a freedom" in nowhere.reason(1)


def test_tolerances_of_starts(ball):
    found = biela.tolerance(
        ball, t=[0, 0.2], tolerances={"height.position": 1e-3, "height.velocity": 1e-2}, corners=True,
        variables=["height.position"],
    )  # fmt: skip
    assert_allclose(found.worst["height.position"][-1], 1e-3 + 0.2 * 1e-2, rtol=AT_TOLERANCE)
    low, high = found.extremes("height.position")
    assert_allclose((high - low)[-1] / 2, 1e-3 + 0.2 * 1e-2, rtol=AT_TOLERANCE)


def test_a_changed_mechanism_starts_elsewhere(ball):
    changed = ball.changed({"height.position": "1500*mm", "height.velocity": -2, "bounce": 0.7})
    freedom = changed.freedoms["height"]
    assert (freedom.start, freedom.velocity) == (1.5, -2.0) and changed.parameters["bounce"].value == 0.7
    own = ball.run(t=[0, 0.3], parameters={"height.position": 1.5, "height.velocity": -2, "bounce": 0.7})
    assert_array_equal(changed.run(t=[0, 0.3])["height.position"], own["height.position"])


def test_times_mean_the_same_in_free_and_in_driven_motion(ball):
    """Height and speed at 0.3 s, whatever the rows before."""
    fallen = ball.run(t=[0.3, 0.4])
    assert_allclose(fallen["height.position"], 1 - G * np.array([0.3, 0.4]) ** 2 / 2, rtol=AT_TOLERANCE)
    late = ball.run(t=[1.0])
    assert len(late.events) == 2 and late["time"][0] == 1.0
    assert_allclose(late["height.position"], ball.run(t=[0, 0.2, 1.0])["height.position"][-1:], rtol=1e-6)
    swept = ball.sweep({"bounce": [0.5]}, t=[1.0], variables="height")
    assert_array_equal(swept["height.position"][0], late["height.position"])
    for arguments, message in [
        ({"t": [-0.1, 0.2]}, r"t\[0\] = -0.1 is before 0, the `start` of the file"),
        ({"t": [0.1, 0.2], "inputs": {"lift.effort": [0.0, 1.0]}}, "give the values of `lift.effort` from"),
        ({"inputs": {"lift.effort": [0.0, 1.0]}}, "`lift.effort` has values without times"),
        (
            {"t": [0.1], "drive": {"height": "1"}, "parameters": {"height.position": 1}},
            "the start of `height` has no effect",
        ),
    ]:
        with pytest.raises(biela.UsageError, match=message):
            ball.run(**arguments)


def test_a_mechanism_tells_its_parts(ball, mechanism):
    assert ball.drivers == {} and list(ball.freedoms) == ["height"]
    assert ball.freedoms["height"] == biela.Freedom("height", "Above the floor", "m", 1.0, 0.0)
    weight = ball.parameters["weight"]
    assert (weight.value, weight.unit, weight.description) == (2.0, "kg", "Mass of the ball")
    assert list(ball.inputs) == ["lift.effort"] and ball.inputs["lift.effort"].unit == "N"
    assert "Of a hand" in ball.inputs["lift.effort"].description
    forces = ball.forces
    assert {"wind.effort", "table.effort"} <= set(forces) and "lift.effort" not in forces
    assert forces["table.effort"].value == 0.0 and forces["table.effort"].unit == "N"
    goal = mechanism("servo_arm").inputs["goal"]
    assert (goal.unit, goal.start, goal.min, goal.max) == ("rad", *np.radians([60, -60, 60]))
    four_bar = mechanism("four_bar")
    assert list(four_bar.drivers) == ["crank_angle"] and four_bar.freedoms == four_bar.inputs == {}
    measure = four_bar.measures["transmission"]
    assert (measure.unit, measure.variable) == ("rad", "transmission.position")
    # Law of cosines for the angle between coupler and rocker at a crank of 60 degrees.
    diagonal = np.hypot(0.4 - 0.1 * np.cos(np.pi / 3), 0.1 * np.sin(np.pi / 3))
    expected = np.arccos((0.25**2 + 0.3**2 - diagonal**2) / (2 * 0.25 * 0.3))
    assert_allclose(measure.value, expected, rtol=1e-13)


def test_equilibria_of_a_pendulum(mechanism):
    pendulum = mechanism("pendulum_free")
    down = pendulum.balance(parameters={"swing.position": 0.5})
    assert_allclose(down.values["swing"], 0, atol=1e-9)
    (only,) = pendulum.balance(all=True)
    assert_allclose(np.sin(only.values["swing"]), 0, atol=1e-9)
    assert down.held == {} and down.left_out == () and set(down.poses) == {"rod"}
    # A spring-loaded bar with two sides has more than one.
    hinge = mechanism("bonnet_hinge")
    with pytest.raises(biela.Error, match="no freedom"):
        hinge.balance()


def test_a_ball_rests_on_the_floor(ball):
    at = ball.balance(drive={"lift.effort": 5.0})
    assert_allclose(at.values["height"], 0, atol=1e-9)
    assert_allclose(at.held["table"], 2 * G - 5, rtol=1e-9)


def test_linear_equations_take_starts_and_tell_what_drive_takes_away(mechanism):
    pendulum = mechanism("double_pendulum")
    first, second = pendulum.freedoms
    here = pendulum.linearize(parameters={f"{first}.position": -1.2})
    moved = pendulum.changed({f"{first}.position": -1.2}).linearize()
    assert_allclose(here.A, moved.A, rtol=1e-9, atol=1e-9)
    with pytest.warns(biela.MechanismWarning, match=f"`drive` moves freedom `{first}`, which has no states"):
        held = pendulum.linearize(drive={first: -1.2})
    assert held.taken == (f"{first}.position", f"{first}.velocity") and len(held.states) == 2
    assert here.taken == ()


def test_linear_equations_go_to_control_with_their_names(mechanism, monkeypatch):
    made = {}
    control = types.ModuleType("control")
    control.ss = lambda *matrices, **names: made.update(matrices=matrices, names=names)
    monkeypatch.setitem(sys.modules, "control", control)
    space = mechanism("pendulum_free").linearize(balance=True, variables=["rod.phi"])
    space.to_control()
    assert made["matrices"] is not None and len(made["matrices"]) == 4
    assert made["names"]["states"] == ["swing_position", "swing_velocity"]
    assert made["names"]["outputs"] == ["rod_phi"]
