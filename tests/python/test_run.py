"""Runs: closed forms, motions in all forms, and the same numbers as the program."""

from __future__ import annotations

import csv
import io
import os
import re
import subprocess
import sys
import threading
import warnings

import biela
import numpy as np
import pytest
from shipped import ROOT
from numpy.testing import assert_allclose, assert_array_equal

AT_ROUNDING = 1e-13
"""Relative error of some ten operations on numbers of order one, with the condition of the
four-bar linkage, which is above 0.01."""


def rocker(theta, crank=0.10, coupler=0.25, rocker=0.30, base=0.40):
    """Returns the rocker's angle by the law of cosines."""
    # From the rocker's pivot to the crank's pin, turned by half a turn: the angle stays off its cut.
    x, y = base - crank * np.cos(theta), -crank * np.sin(theta)
    diagonal = np.hypot(x, y)
    inner = np.arccos((rocker**2 + diagonal**2 - coupler**2) / (2 * rocker * diagonal))
    return np.pi + np.arctan2(y, x) - inner


def test_a_four_bar_follows_the_law_of_cosines_over_a_turn(four_bar):
    theta = np.radians(60) + np.linspace(0, 2 * np.pi, 361)
    result = four_bar.run(drive={"crank_angle": theta})
    assert_allclose(result["rocker.phi"], rocker(theta), rtol=AT_ROUNDING)
    assert_array_equal(result["crank_angle.position"], theta)
    assert result.stopped is None and len(result.t) == 361


def test_parameters_are_numbers_or_expressions(four_bar):
    theta = np.linspace(1.0, 2.0, 5)
    for length in (0.31, "310*mm"):
        result = four_bar.run(drive={"crank_angle": theta}, parameters={"rocker_length": length})
        assert_allclose(result["rocker.phi"], rocker(theta, rocker=0.31), rtol=AT_ROUNDING)


def test_expressions_and_exact_samples_give_the_same_motion(four_bar):
    t = np.linspace(0, 1, 11)
    angle = 1 + 2 * t + 3 * t**2
    sampled = four_bar.run(t=t, drive={"crank_angle": (angle, 2 + 6 * t, 6.0)})
    told = four_bar.run(t=t, drive={"crank_angle": "1 + 2*t + 3*t^2"})
    for name in told:
        # Accelerations grow with the square of the rates, which reach 8 rad/s.
        assert_allclose(sampled[name], told[name], rtol=1e-11, atol=1e-11, err_msg=name)


def test_samples_without_rates_are_differentiated(four_bar):
    t = np.linspace(0, 1, 201)
    exact = four_bar.run(t=t, drive={"crank_angle": "1 + sin(2*t)"})
    sampled = four_bar.run(t=t, drive={"crank_angle": 1 + np.sin(2 * t)})
    with_velocity = four_bar.run(
        t=t, drive={"crank_angle": (1 + np.sin(2 * t), 2 * np.cos(2 * t))}
    )
    # h = 0.005: at the ends the errors are h^4/5 d5 and some h^3 d5, with d5 up to 32.
    assert_allclose(sampled["rocker.omega"], exact["rocker.omega"], atol=1e-8)
    assert_allclose(sampled["rocker.alpha"], exact["rocker.alpha"], atol=1e-5)
    assert_allclose(with_velocity["rocker.omega"], exact["rocker.omega"], rtol=AT_ROUNDING, atol=1e-15)
    assert_allclose(with_velocity["rocker.alpha"], exact["rocker.alpha"], atol=1e-7)


def test_constant_rates_fit_arrays(four_bar):
    theta = np.linspace(1.0, 2.0, 5)
    result = four_bar.run(drive={"crank_angle": (theta, 1.0, 0.0)})
    h = 1e-6
    slope = (rocker(theta + h) - rocker(theta - h)) / (2 * h)
    assert_allclose(result["rocker.omega"], slope, rtol=1e-8)


@pytest.mark.parametrize(
    "name",
    ["four_bar", "slider_crank", "tlv", "cam_points", "andrews", "engine", "hatch", "valve_train"],
)
def test_a_run_has_the_numbers_of_the_program(mechanism, name):
    own = mechanism(name)
    file = ROOT / "mechanisms" / f"{name}.toml"
    command = [sys.executable, "-m", "biela", "run", file, "--stop", "0.2", "--step", "0.02"]
    motions = {}
    for driver in own.drivers.values():
        if driver.start is not None:
            rate = 0.3 if driver.unit == "rad" else 0.1 * driver.start
            motions[driver.name] = f"{driver.start!r} + {rate!r}*t"
            command += ["--drive", f"{driver.name} = {motions[driver.name]}"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "crates/python")}
    ran = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    rows = list(csv.reader(io.StringIO(ran.stdout)))
    written = np.array(rows[1:], dtype=float)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", biela.MechanismWarning)
        result = own.run(t=written[:, 0], drive=motions)
    for name, column in zip(rows[0], written.T):
        assert_array_equal(result[name], column, err_msg=name)
    assert set(result) <= set(rows[0])


def test_a_result_is_a_mapping(four_bar):
    result = four_bar.run(t=[0, 0.5], drive={"crank_angle": "1 + t"}, variables=["rocker"])
    assert result.get("rocker.psi") is None and "rocker.psi" not in result
    with pytest.raises(KeyError, match="^no variable `rocker.psi`"):
        result["rocker.psi"]


def test_a_dead_point_stops_a_run_with_the_rows_up_to_it(mechanism):
    triangle = mechanism("tlv")
    drive = {name: f"{d.start!r} + 0.5*t" for name, d in triangle.drivers.items()}
    with pytest.raises(biela.StoppedError, match="the mechanism cannot go on") as stopped:
        triangle.run(t=np.linspace(0, 10, 101), drive=drive)
    kept = triangle.run(t=np.linspace(0, 10, 101), drive=drive, stop="keep")
    assert 1 < len(kept.t) < 101 and kept.stopped in str(stopped.value)
    assert_array_equal(stopped.value.result.to_numpy(), kept.to_numpy())


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"drive": {"crank_angel": [1.0]}}, "did you mean `crank_angle`"),
        ({"drive": {"crank_angle": [1.0, 2.0]}, "t": [0.0]}, "2 values for 1 times"),
        ({"drive": {"crank_angle": [1.0, np.nan]}}, "expected a finite number"),
        ({"drive": {"crank_angle": "1 +"}}, "drive: "),
        ({"drive": {"crank_angle": (1.0, 2.0, 3.0, 4.0)}}, "expected .position, velocity, acceleration"),
        ({"t": [1.0, 0.0]}, "ascending order"),
        ({"t": []}, "no times"),
        ({"t": ["soon"]}, "t: expected numbers; found"),
        ({"drive": {"crank_angle": ["far"]}}, "drive: expected numbers as `crank_angle`"),
        ({"drive": {"crank_angle": [[1, 2], [3]]}}, "drive: expected numbers as `crank_angle`"),
        ({"parameters": {"crank": 0.1}}, "no parameter `crank`"),
        ({"parameters": {"crank_length": -1}}, "at least 0.001"),
        ({"parameters": {"crank_length": "1*furlong"}}, "furlong"),
        ({"variables": ["rocker.psi"]}, "no variable `rocker.psi`"),
        ({"gradient": ["bas"]}, "did you mean `base`"),
        ({"stop": "never"}, "expected 'raise' or 'keep'"),
    ],
)
def test_wrong_arguments_are_told(four_bar, arguments, message):
    with pytest.raises(biela.UsageError, match=message) as raised:
        four_bar.run(**arguments)
    assert isinstance(raised.value, biela.Error) and isinstance(raised.value, ValueError)


def test_a_mechanism_that_does_not_close_raises(four_bar):
    with pytest.raises(biela.AssemblyError, match="the mechanism cannot close"):
        four_bar.run(t=[0.0], parameters={"base": 5.0})


def test_what_has_no_value_at_the_start_is_told_with_the_time():
    """A force 1/(t − 3) has no value at 3 s, and a motion sqrt(2 − t) none after 2 s."""
    along = "coordinate = 'x', markers = ['ground.O', 'slide.O']"
    mechanism = biela.loads(f"""
        format = 1
        name = "pusher"
        [ground.markers]
        O = [0, 0]
        [bodies.slide]
        markers = {{ O = [0, 0] }}
        [joints]
        way = {{ type = "translational", markers = ["ground.O", "slide.O"] }}
        [drivers]
        x = {{ {along}, motion = "sqrt(2 - t)" }}
        [forces]
        push = {{ {along}, value = "1/(t - 3)" }}
        """)
    with pytest.raises(biela.AssemblyError, match="^at t = 3 s: driver `x` has no finite value$"):
        mechanism.run(t=[3.0, 4.0])
    with pytest.raises(biela.AssemblyError, match="^at t = 3 s: force `push` has no finite value"):
        mechanism.run(t=[3.0, 4.0], drive={"x": "t"})


def test_threads_run_at_the_same_time(four_bar):
    """While a thread computes in Rust, others go on: the lock is released."""
    ticks = 0
    done = threading.Event()

    def compute():
        four_bar.run(t=np.linspace(0, 1, 20_000), drive={"crank_angle": "1 + 6*t"})
        done.set()

    thread = threading.Thread(target=compute)
    thread.start()
    while not done.wait(0.001):
        ticks += 1
    thread.join()
    assert ticks >= 3


@pytest.mark.filterwarnings("ignore::biela.MechanismWarning")
def test_reactions_that_are_no_outputs_stop_nothing(mechanism):
    """At the change point the forces in the pins grow without bound; the effort does not."""
    text = mechanism("parallelogram").text
    mass = "mass = 2\ninertia = 0.01\ncenter = [0.1, 0]"
    heavy = text.replace("[bodies.coupler]", f"[bodies.coupler]\n{mass}")
    drive = {"crank_angle": (np.radians([170.0, 180.0, 190.0]), 3.0, 0.0)}
    with pytest.raises(biela.StoppedError, match="no limit"):
        biela.loads(heavy).run(drive=drive)
    without = biela.loads(heavy.replace("[outputs]", "[outputs]\nreactions = []"))
    result = without.run(drive=drive)
    # The coupler goes on a circle of 0.1 m without turning: its weight alone has power.
    expected = 2 * 9.81 * 0.1 * np.cos(np.radians([170.0, 180.0, 190.0]))
    assert_allclose(result["crank_angle.effort"], expected, rtol=1e-9)


def test_inputs_are_entries_of_drive(mechanism):
    crank = mechanism("slider_crank_motor")
    t = np.linspace(0, 0.3, 4)
    torque = {"motor.effort": "1 + t"}
    driven = crank.run(t=t, drive=torque)
    assert_array_equal(crank.run(t=t, inputs=torque).to_numpy(), driven.to_numpy())
    sampled = crank.run(t=t, inputs={"motor.effort": 1 + t})
    assert_allclose(sampled["crank_angle.position"], driven["crank_angle.position"], rtol=1e-9)
    assert abs(driven["crank_angle.position"][-1] - crank.run(t=t)["crank_angle.position"][-1]) > 0.1
    with pytest.raises(biela.UsageError, match="`motor.effort` is in `drive` too"):
        crank.run(t=t, drive=torque, inputs=torque)


def test_inputs_have_columns(mechanism):
    crank = mechanism("slider_crank_motor")
    t = np.linspace(0, 0.3, 4)
    assert_array_equal(crank.run(t=t)["motor.effort"], 0.0 * t)
    assert_array_equal(crank.run(t=t, drive={"motor.effort": 1 + t})["motor.effort"], 1 + t)
    with pytest.raises(biela.UsageError, match="give the values of `voltage` from there on"):
        mechanism("wiper_motor").run(t=1 + t, drive={"voltage": 1 + t})


FOLLOWER = """
format = 1
name = "follower"
[parameters]
gain = 2
[inputs]
setpoint = { start = 0.1 }
[ground.markers]
O = [0, 0]
[bodies.block]
markers = { B = [0, 0] }
mass = 2
[joints]
guide = { type = "translational", markers = ["ground.O", "block.B"] }
[drivers]
x = { coordinate = "x", markers = ["ground.O", "block.B"], motion = "gain*setpoint" }
"""


def test_a_driver_that_follows_an_input_takes_its_array():
    follower = biela.loads(FOLLOWER)
    driven = biela.loads(re.sub(r"(?s)\[parameters].*(?=\[ground)", "", FOLLOWER).replace('motion = "gain*setpoint"', "start = 0.2"))
    t = np.linspace(0, 1, 21)
    setpoint = 0.1 + 0.3 * np.sin(2 * t)
    variables = ["block.x", "block.vx", "block.ax", "x.effort"]
    found = follower.run(t=t, drive={"setpoint": setpoint}, variables=variables, gradient=["gain"])
    truth = driven.run(t=t, drive={"x": 2 * setpoint}, variables=variables)
    for name in variables:
        assert_allclose(found[name], truth[name], rtol=1e-13, atol=1e-13)
        # The motion is in proportion to the gain.
        assert_allclose(found.gradient[name, "gain"], found[name] / 2, rtol=1e-13, atol=1e-13)
    # The input has a column behind all others, and a gradient where an expression gives it.
    assert list(follower.run(t=t, drive={"setpoint": setpoint}))[-1] == "setpoint"
    assert_array_equal(follower.run(t=t, drive={"setpoint": setpoint})["setpoint"], setpoint)
    given = follower.run(t=t, drive={"setpoint": "gain*t"}, variables=["setpoint"], gradient=["gain"])
    assert_allclose(given["setpoint"], 2 * t, rtol=1e-15)
    assert_allclose(given.gradient["setpoint", "gain"], t, rtol=1e-15)
    # Rates that are given count, and the chain rule makes those of a square.
    square = biela.loads(FOLLOWER.replace("gain*setpoint", "gain*setpoint^2"))
    s, v, a = np.array([0.1, 0.4]), np.array([1.0, -2.0]), np.array([3.0, 0.5])
    at = square.run(drive={"setpoint": (s, v, a)}, variables=variables)
    assert_allclose(at["block.vx"], 4 * s * v, rtol=1e-14)
    assert_allclose(at["block.ax"], 4 * (v * v + s * a), rtol=1e-14)
    swept = follower.sweep({"gain": [2.0, 3.0]}, t=t, drive={"setpoint": setpoint}, variables=variables)
    assert_allclose(swept["block.x"], np.outer([2.0, 3.0], setpoint), rtol=1e-13)
    # The driver's own entry goes before what it follows.
    own = follower.run(t=t, drive={"x": 2 * setpoint, "setpoint": 0 * t}, variables=variables)
    assert_allclose(own["block.x"], truth["block.x"], rtol=1e-13)


def test_a_free_motion_has_no_gradient_by_what_follows_arrays():
    free = FOLLOWER + """
[bodies.bob]
markers = { B = [0, 0] }
mass = 1
[joints.rail]
type = "translational"
markers = ["block.B", "bob.B"]
[freedoms]
slip = { coordinate = "x", markers = ["block.B", "bob.B"], start = 0 }
"""
    t = np.linspace(0, 1, 21)
    # Nothing pushes the bob, which keeps the velocity that it begins with.
    drive = {"setpoint": (0.1 + 0.3 * np.sin(2 * t), 0.6 * np.cos(2 * t), -1.2 * np.sin(2 * t))}
    mechanism = biela.loads(free)
    moved = mechanism.run(t=t, drive=drive, variables=["bob.x"])
    assert_allclose(moved["bob.x"], 0.2 + 1.2 * t, rtol=1e-8)
    with pytest.raises(biela.UsageError, match="driver `x` follows an input with an array"):
        mechanism.run(t=t, drive=drive, variables=["bob.x"], gradient=["gain"])


def test_the_start_of_a_freedom_is_set(mechanism):
    pendulum = mechanism("pendulum_free")
    t = [0.0, 0.1, 0.5]
    start = {"swing.position": "-30*deg", "swing.velocity": 2.5}
    result = pendulum.run(t=t, parameters=start)
    assert result["swing.position"][0] == np.radians(-30)
    assert result["swing.velocity"][0] == 2.5
    line = next(line for line in pendulum.text.splitlines() if line.startswith("swing ="))
    edited = re.sub(r'start = .*', 'start = "-30*deg", velocity = 2.5 }', line)
    same = biela.loads(pendulum.text.replace(line, edited)).run(t=t)
    assert_array_equal(same["rod.phi"], result["rod.phi"])
    with pytest.raises(biela.UsageError, match="`swing.velocity`: .*not finite"):
        pendulum.run(t=t, parameters={"swing.velocity": np.nan})


def test_a_start_beyond_a_rope_is_warned_of():
    """The ball goes to the nearest place that the rope leaves."""
    ball = biela.loads(
        "format = 1\nname = 'ball'\n[ground.markers]\nA = [0, 0]\n[bodies.ball]\nmass = 2\n"
        "markers = { C = [0, 0] }\n[joints]\n"
        "rope = { type = 'rope', markers = ['ground.A', 'ball.C'], length = 1, unilateral = true }\n"
        "[constraints]\n"
        "upright = { coordinate = 'angle', markers = ['ground.A', 'ball.C'], value = 0 }\n"
        "[freedoms]\nx = { coordinate = 'x', markers = ['ground.A', 'ball.C'], start = 0.9 }\n"
        "y = { coordinate = 'y', markers = ['ground.A', 'ball.C'], start = -1.2 }\n"
    )
    message = "rope `rope` is too short by 0.5 m; moved apart: `x` from 0.9 m to 0.6 m, `y` from -1.2 m to"
    with pytest.warns(biela.MechanismWarning, match=message):
        result = ball.run(t=[0.0, 0.01])
    place = [result["x.position"][0], result["y.position"][0]]
    assert_allclose(place, [0.6, -0.8], rtol=AT_ROUNDING)


def test_limits_and_ropes_off_their_pulleys_are_warned_of_once_per_excursion():
    """The rope passes below the pulley until its straight line would, at a height of -0.3 m or so."""
    lowered = biela.loads(
        "format = 1\nname = 'lowered'\n[ground.markers]\ntrack = [0, 0]\nF = [1, 0]\n"
        "guide = [2, 0, '90*deg']\n[bodies]\nnear = { markers = { P = [0, 0] } }\n"
        "far = { markers = { Q = [0, 0, '90*deg'] }, estimate = [2, 0.5, 0] }\n[joints]\n"
        "track = { type = 'translational', markers = ['ground.track', 'near.P'] }\n"
        "guide = { type = 'translational', markers = ['ground.guide', 'far.Q'] }\n"
        "rope = { type = 'rope', length = 2.1, markers = ['near.P', "
        "{ marker = 'ground.F', radius = 0.1, side = 'left' }, 'far.Q'] }\n[drivers]\n"
        "height = { coordinate = 'x', markers = ['ground.guide', 'far.Q'], start = 0.5, min = -0.2 }\n"
    )
    heights = [0.2, -0.15, -0.4, -0.6, 0.1, -0.5]
    with pytest.warns(biela.MechanismWarning) as warned:
        lowered.run(t=np.arange(6.0), drive={"height": heights})
    texts = [str(warning.message) for warning in warned]
    for what in ["driver `height` is at", "rope `rope` would leave its pulley"]:
        times = [text.split(" s:")[0] for text in texts if what in text]
        assert times == ["t = 2", "t = 5"], texts


def test_arrays_that_look_like_degrees_are_warned_of(mechanism):
    four_bar = mechanism("four_bar")
    turn = np.linspace(0, 360, 8)
    message = "drive: `crank_angle`: an angle of 360 rad is 20626.5 deg; NumPy has `np.radians`"
    with pytest.warns(biela.MechanismWarning, match=message):
        four_bar.run(drive={"crank_angle": turn})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        four_bar.run(drive={"crank_angle": np.radians(turn)})


def test_a_wrapped_angle_is_on_the_turn_nearest_the_last_value():
    mechanism = biela.loads(
        "format = 1\nname = 'arm'\n[ground.markers]\nO = [0, 0]\n[bodies.arm.markers]\nO = [0, 0]\n"
        "[joints]\nO = { type = 'revolute', markers = ['ground.O', 'arm.O'] }\n[drivers]\n"
        "q = { coordinate = 'angle', markers = ['ground.O', 'arm.O'], wrapped = true, start = 6 }\n"
    )
    turn = 2 * np.pi
    result = mechanism.run(t=[0.0, 0.1, 0.2], drive={"q": [0.7, 3.7, 6.2 - turn]})
    # The file starts near the end of the first turn.
    assert_allclose(result["arm.phi"], [0.7 + turn, 3.7 + turn, 6.2 + turn], rtol=1e-15)
