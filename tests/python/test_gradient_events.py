"""Gradients of free motions through events: impacts, rest, elastic stops, friction that sticks and slides."""

from __future__ import annotations

import biela
import numpy as np
import pytest
from numpy.testing import assert_allclose
from shipped import ROOT
from test_gradient import differences

STEP = 1e-30
"""Step of complex differentiation: its square is no number."""

BALL = """
format = 1
name = "ball"
[parameters]
ledge = 0.1
part = 0.6
weight = 2.0
load = 3.0
[ground]
markers = { O = [0, 0], V = [0, 0, "90*deg"] }
[bodies.ball]
mass = "weight"
markers = { C = [0, 0, "90*deg"] }
[joints]
shaft = { type = "translational", markers = ["ground.V", "ball.C"] }
[freedoms]
y = { coordinate = "x", markers = ["ground.V", "ball.C"], start = 0.5 }
[forces]
push = { coordinate = "x", markers = ["ground.V", "ball.C"], value = "-load" }
[stops]
landing = { of = "y", min = "ledge", restitution = "part" }
[simulation]
tolerance = 1e-10
"""


def gradient_of(closed, values):
    """Returns the derivatives of a closed form by each of its values."""
    rows = []
    for name in values:
        moved = {key: value + 0j for key, value in values.items()}
        moved[name] += 1j * STEP
        rows.append(np.imag(closed(**moved)) / STEP)
    return rows


def bouncing(t, height, ledge, part, weight, load):
    """Height of a ball that falls from rest and bounces; it rests after infinitely many impacts."""
    g = 9.81 + load / weight
    first = np.sqrt(2 * (height - ledge) / g)
    y = height - g * t**2 / 2
    at, speed = first, part * g * first
    for _ in range(60):
        behind = np.real(t) > np.real(at)
        y = np.where(behind, ledge + speed * (t - at) - g * (t - at) ** 2 / 2, y)
        at, speed = at + 2 * speed / g, part * speed
    return np.where(np.real(t) > np.real(at), ledge, y)


def test_a_ball_bounces_until_it_rests():
    values = {"height": 0.5, "ledge": 0.1, "part": 0.6, "weight": 2.0, "load": 3.0}
    by = ["y.position", *list(values)[1:]]
    t = np.linspace(0, 1.5, 31)
    result = biela.loads(BALL).run(t=t, gradient=by)
    assert_allclose(result["ball.y"], bouncing(t, **values), atol=1e-9)
    assert [event.kind for event in result.events].count("rests") == 1
    for name, exact in zip(by, gradient_of(lambda **v: bouncing(t, **v), values), strict=True):
        assert_allclose(result.gradient["ball.y", name], exact, atol=1e-9, err_msg=name)
    # It rests on the ledge in the end, wherever this is, and however it has come there.
    assert_allclose([result.gradient["ball.y", name][-1] for name in by], [0, 1, 0, 0, 0], atol=1e-9)


SLEDGE = """
format = 1
name = "sledge"
[parameters]
stiffness = 40.0
weight = 2.0
rub = 0.2
hold = 0.35
speed = 0.4
[ground]
markers = { O = [0, 0] }
[bodies.sledge]
mass = "weight"
markers = { C = [0, 0] }
[bodies.puller]
markers = { C = [0, 0] }
[joints]
guide = { type = "translational", markers = ["ground.O", "sledge.C"] }
rail = { type = "translational", markers = ["ground.O", "puller.C"] }
[drivers]
pull = { coordinate = "x", markers = ["ground.O", "puller.C"], motion = "speed*t" }
[freedoms]
x = { coordinate = "x", markers = ["ground.O", "sledge.C"], start = 0 }
[forces]
spring = { coordinate = "x", markers = ["sledge.C", "puller.C"], stiffness = "stiffness", free = 0 }
[friction]
rubbing = { FRICTION }
[simulation]
tolerance = 1e-10
"""
ALONG = """of = "x", force = "rub*weight*9.81", static = "hold*weight*9.81" """
IN_JOINT = """joint = "guide", coefficient = "rub", static = "hold" """


def pulled(t, stiffness, weight, rub, hold, speed):
    """Way of a sledge that a spring pulls: it holds until it slips, and holds again when it rests."""
    most = hold * weight * 9.81 / stiffness
    slides = rub * weight * 9.81 / stiffness
    slips, frequency = most / speed, np.sqrt(stiffness / weight)
    s = t - slips
    angle = frequency * s
    x = speed * s + (most - slides) * (1 - np.cos(angle)) - speed / frequency * np.sin(angle)
    # The rate vanishes when tan(angle/2) is minus the ratio of the two amplitudes.
    rest = 2 * (np.pi - np.arctan((most - slides) * frequency / speed)) / frequency
    end = speed * rest + (most - slides) * (1 - np.cos(frequency * rest))
    end = end - speed / frequency * np.sin(frequency * rest)
    x = np.where(np.real(s) > np.real(rest), end, x)
    return np.where(np.real(s) > 0, x, 0)


@pytest.mark.parametrize("friction", [ALONG, IN_JOINT], ids=["along", "in_joint"])
def test_a_sledge_holds_slips_and_holds(friction):
    values = {"stiffness": 40.0, "weight": 2.0, "rub": 0.2, "hold": 0.35, "speed": 0.4}
    mechanism = biela.loads(SLEDGE.replace("FRICTION", friction))
    t = np.linspace(0, 1.6, 33)
    result = mechanism.run(t=t, gradient=list(values))
    assert [event.kind for event in result.events] == ["slides", "sticks"]
    assert_allclose(result["sledge.x"], pulled(t, **values), atol=1e-9)
    for name, exact in zip(values, gradient_of(lambda **v: pulled(t, **v), values), strict=True):
        assert_allclose(result.gradient["sledge.x", name], exact, atol=1e-7, err_msg=name)


PENDULUM = """
format = 1
name = "struck"
[parameters]
length = 0.4
part = 0.7
limit = 0.15
offset = 0.05
stiffness = 800.0
damping = 3.0
[ground]
markers = { O = [0, 0], W = [0, 0] }
[bodies.upper]
mass = 1.0
inertia = 0.02
center = [0.2, 0]
markers = { O = [0, 0], P = ["length", 0] }
[bodies.lower]
mass = 0.6
inertia = 0.01
center = [0.15, "offset"]
markers = { P = [0, 0], T = [0.3, 0] }
estimate = [0.4, 0, 0]
[joints]
fixed = { type = "revolute", markers = ["ground.O", "upper.O"] }
elbow = { type = "revolute", markers = ["upper.P", "lower.P"] }
[freedoms]
first = { coordinate = "angle", markers = ["ground.O", "upper.O"], start = 0.1 }
second = { coordinate = "angle", markers = ["upper.O", "lower.P"], start = 0.3 }
[measures]
reach = { coordinate = "x", markers = ["ground.W", "lower.T"] }
[stops]
STOP
[simulation]
tolerance = 1e-10
"""
STOPS = {
    "bounces": 'wall = { of = "reach", min = "limit", restitution = "part" }',
    "stays": 'wall = { of = "reach", min = "limit" }',
    "yields": 'wall = { of = "reach", min = "limit", stiffness = "stiffness", damping = "damping" }',
    "folds": 'fold = { of = "second", min = "-limit", max = 0.8, restitution = "part" }',
}
DISC = """
format = 1
name = "disc"
[parameters]
radius = 0.1
part = 0.6
drop = 0.3
spin = 4.0
[ground]
markers = { Z = [0, 0], L = [-3, "3*tan(10*deg)"], R = [3, "-3*tan(10*deg)"] }
shapes = { slope = { wall = ["R", "L"], depth = 0.1 } }
[bodies.disc]
mass = 1
inertia = 0.005
markers = { O = [0, 0] }
shapes = { rim = { disc = "O", radius = "radius" } }
estimate = [0, 0.4, 0]
[freedoms]
x = { coordinate = "x", markers = ["ground.Z", "disc.O"], start = 0 }
y = { coordinate = "y", markers = ["ground.Z", "disc.O"], start = "radius + drop" }
turn = { coordinate = "angle", markers = ["ground.Z", "disc.O"], start = 0, velocity = "spin" }
[contacts]
slope = { shapes = ["ground.slope", "disc.rim"], restitution = "part" }
[simulation]
tolerance = 1e-10
"""
MOVING = ('"block.C"], start = 1 }', '"block.C"], start = 1, velocity = -0.5 }')


def text_of(path):
    return (ROOT / f"{path}.toml").read_text(encoding="utf-8")


COMBINED = {name: (PENDULUM.replace("STOP", stop), 0.85) for name, stop in STOPS.items()} | {
    "disc": (DISC, 0.7),
    # At rest friction changes its sign with the velocity: the block moves at the start.
    "rope": (text_of("tests/fmpy/mechanisms/ball_on_rope").replace(*MOVING), 2.8),
    "servo": (text_of("mechanisms/servo_arm"), 0.3),
}


@pytest.mark.parametrize("name", COMBINED)
def test_gradients_through_events_are_those_of_differences(name):
    """Of order 8 between runs, whose errors of some 1e-11 are divided by a step of 1e-3."""
    text, end = COMBINED[name]
    mechanism = biela.loads(text)
    t = np.linspace(0, end, 10)
    values = {p.name: p.value for p in mechanism.parameters.values() if not p.derived}
    first = mechanism.run(t=[0.0])
    values |= {(start := f"{name}.velocity"): first[start][0] for name in mechanism.freedoms}
    result = mechanism.run(t=t, gradient=list(values))
    assert result.events
    for place, (parameter, value) in enumerate(values.items()):
        scale = max(abs(value), 0.01)
        difference = differences(mechanism, parameter, value, scale, t=t)
        found = result.gradient.to_numpy()[:, place]
        size = np.abs(difference).max(axis=0) + np.abs(result.to_numpy()).max(axis=0)
        off = np.abs(found - difference) / (1 + size)
        assert off.max() < 1e-6, (parameter, list(result)[off.max(axis=0).argmax()])


def test_what_has_no_derivative_is_refused():
    corner = SLEDGE.replace("FRICTION", ALONG).replace('"speed*t"', '"abs(speed*(t - 0.1))"')
    with pytest.raises(biela.Error, match="t = 0.1.* s, where the velocity of a driver jumps"):
        biela.loads(corner).run(t=[0, 1], gradient=["speed"])


PAIR = """
format = 1
name = "pair"
[ground]
markers = { V = [0, 0, "90*deg"], W = [1, 0, "90*deg"] }
[bodies]
left = { mass = 1, markers = { C = [0, 0, "90*deg"] } }
right = { mass = 1, markers = { C = [0, 0, "90*deg"] }, estimate = [1, 0, 0] }
[joints]
first = { type = "translational", markers = ["ground.V", "left.C"] }
second = { type = "translational", markers = ["ground.W", "right.C"] }
[freedoms]
a = { coordinate = "x", markers = ["ground.V", "left.C"], start = 0.5 }
b = { coordinate = "x", markers = ["ground.W", "right.C"], start = 0.5 }
[stops]
under_a = { of = "a", min = 0 }
under_b = { of = "b", min = 0 }
"""


def test_events_that_come_apart_are_refused():
    mechanism = biela.loads(PAIR)
    with pytest.raises(biela.Error, match="at t = 0.319.* s, where several things happen at once"):
        mechanism.run(t=[0, 1], gradient=["a.position"])
