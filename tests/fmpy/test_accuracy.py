"""Every output of the five mechanisms over a full motion, against the closed form.

The limits, 1e-12 for positions and 1e-10 for rates, are the product's promise; see
`harness.assert_accurate`. The closed forms themselves are good to 2e-15 (they agree to that with
themselves in 80-bit arithmetic), so that what is measured is the FMU's error.
"""

import numpy as np
import pytest
from closed_form import CLOSED_FORMS
from harness import assert_accurate, collect, signals, simulate
from motions import full_motion

STEPS = 720
RATES = {"auto": 1, "inputs": 2, "estimated": 3}
NAMES = sorted(CLOSED_FORMS)


def in_force(result, driver):
    """The driver's value and rates that a row's outputs belong to: the inputs recorded with it."""
    return [result[f"{driver}.{suffix}"] for suffix in ("position", "velocity", "acceleration")]


@pytest.mark.parametrize("rates", ["auto", "inputs"])
@pytest.mark.parametrize("name", NAMES)
def test_full_motion_in_simulate_fmu(fmu, name, rates):
    form = CLOSED_FORMS[name]
    time = np.linspace(0, 1, STEPS + 1)
    result = simulate(
        fmu(name),
        input=signals(form.driver, time, *full_motion(name, time)),
        stop_time=1.0,
        output_interval=1 / STEPS,
        start_values={"rates": RATES[rates]},
    )
    assert len(result) == STEPS + 1
    expected = form().motion(*in_force(result, form.driver))
    assert set(expected) == set(fmu(name).names("output")), "every output is compared"
    assert_accurate(result, expected)

    # The values in force are those sent one step before: the lag that every host has. FMPy
    # interpolates the signal where its time and the signal's differ by rounding.
    np.testing.assert_allclose(
        result[f"{form.driver}.position"][1:], full_motion(name, time)[0][:-1], atol=1e-13
    )


@pytest.mark.parametrize("name", NAMES)
def test_full_motion_by_hand(slave, name):
    """The same through `FMU2Slave`, with steps of changing size."""
    form = CLOSED_FORMS[name]
    time = np.linspace(0, 1, STEPS + 1) ** 1.5
    motion = np.transpose(full_motion(name, time))
    inputs = [f"{form.driver}.{suffix}" for suffix in ("position", "velocity", "acceleration")]

    instance = slave(name).start(dict(zip(inputs, motion[0], strict=True)) | {"rates": 2})
    rows = [instance.outputs()]
    for values, size in zip(motion[:-1], np.diff(time), strict=True):
        instance.set(dict(zip(inputs, values, strict=True)))
        instance.step(size)
        rows.append(instance.outputs())

    sent = np.vstack([motion[:1], motion[:-1]]).T
    assert_accurate(collect(rows), form().motion(*sent))


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("name", NAMES)
def test_input_derivatives(slave, name, order):
    """With input derivatives the outputs at t + h belong to t + h, on the host's polynomial.

    u(t + s) = u + u' s + u'' s²/2: value and rates are those of the polynomial at s = h. Without
    order 2 the path is straight, and the acceleration the difference of the last two velocities.
    """
    form = CLOSED_FORMS[name]
    h = 1 / STEPS
    u, rate, acceleration = full_motion(name, np.arange(STEPS) * h)
    position = f"{form.driver}.position"

    instance = slave(name).start({position: u[0]})
    rows = []
    for k in range(STEPS):
        instance.set({position: u[k]})
        instance.set_derivatives(position, *(rate[k], acceleration[k])[:order])
        instance.step(h)
        rows.append(instance.outputs())

    if order == 1:
        expected = u + rate * h, rate, np.diff(rate, prepend=rate[0]) / h
    else:
        expected = u + rate * h + acceleration * h**2 / 2, rate + acceleration * h, acceleration
    assert_accurate(collect(rows), form().motion(*expected))


@pytest.mark.parametrize("name", ["slider_crank", "four_bar", "tlv_crank"])
def test_several_turns_backwards(slave, name):
    """Three turns clockwise in steps of 2°: angles count down with the driver."""
    form = CLOSED_FORMS[name]
    u = form.start - np.radians(np.arange(0, 3 * 360 + 1, 2))
    position, velocity = (f"{form.driver}.{suffix}" for suffix in ("position", "velocity"))
    instance = slave(name).start({"rates": 2, velocity: -1.0})
    rows = []
    for value in u:
        instance.set({position: value})
        instance.step(0.01)
        rows.append(instance.outputs())
    assert_accurate(collect(rows), form().motion(u, -1.0, 0.0))


@pytest.mark.parametrize("name", NAMES)
def test_large_steps_stay_on_the_branch(slave, name):
    """Steps of up to 400° either way, or from anywhere in the stroke to anywhere else.

    Both assemblies of a dyad satisfy the equations; a solver that only iterates from the last
    pose would take the other one now and then, or another turn of an angle.
    """
    form = CLOSED_FORMS[name]
    draw = np.random.default_rng(1)
    if name == "tlv":
        u = draw.uniform(0.151, 0.649, 200)
    else:
        u = form.start + np.cumsum(draw.uniform(-7, 7, 200))
    instance = slave(name).start({"rates": 2})
    rows = []
    for value in u:
        instance.set({f"{form.driver}.position": value})
        instance.step(0.1)
        rows.append(instance.outputs())
    assert_accurate(collect(rows), form().motion(u))


@pytest.mark.parametrize("name", ["slider_crank", "four_bar", "tlv_crank"])
@pytest.mark.parametrize("turns", [1, -1])
def test_a_whole_turn_in_one_step(slave, name, turns):
    """The pose is the same again, the crank's angle a turn on and everybody else's where it was."""
    form = CLOSED_FORMS[name]
    position = f"{form.driver}.position"
    instance = slave(name).start({"rates": 2})
    before = instance.outputs()
    instance.set({position: form.start + turns * 2 * np.pi})
    instance.step(0.1)
    after = instance.outputs()

    crank = form.bodies[0]
    assert after[f"{crank}.phi"] == pytest.approx(
        before[f"{crank}.phi"] + turns * 2 * np.pi, rel=1e-15
    )
    for output, value in before.items():
        if output != f"{crank}.phi":
            # Adding the turn rounds the driver by up to 1e-15, which no output multiplies by ten;
            # the solver's own rounding is as large.
            assert after[output] == pytest.approx(value, abs=5e-14), output


@pytest.mark.parametrize("name", ["slider_crank", "four_bar", "tlv_crank"])
def test_starting_turns_away(slave, name):
    """A start value two turns on is reached by turning twice, not by wrapping."""
    form = CLOSED_FORMS[name]
    u = form.start + 4 * np.pi + 1.0
    instance = slave(name).start({f"{form.driver}.position": u})
    outputs = instance.outputs()
    expected = form().motion(u)
    for output in (o for o in expected if o.rpartition(".")[2] in ("x", "y", "phi", "position")):
        assert outputs[output] == pytest.approx(expected[output].item(), rel=1e-12, abs=1e-13)


def test_solver_reports_how_well_it_did(slave):
    """The residual is at rounding, the condition is that of a four-bar far from any dead point."""
    instance = slave("four_bar").start()
    instance.set({"crank_angle.position": 1.2})
    instance.step(0.01)
    residual, rcond, iterations, substeps = instance.get(
        "solver.residual", "solver.rcond", "solver.iterations", "solver.substeps"
    )
    assert 0 <= residual < 1e-14
    assert 1e-4 < rcond <= 1
    assert 1 <= iterations <= 20
    assert substeps >= 0


# ---------------------------------------------------------------------------------------------
# Prescribed motion and several drivers


def test_prescribed_motion(fmu):
    """A driver with `motion` needs no input and is never late: outputs at t belong to t.

    yoke.x = r cos u, r the derived diameter halved, u = speed t + wobble sin 2t.
    """
    yoke = fmu("turning_yoke")
    assert yoke.names("input") == []
    assert not {"rates", "extrapolation"} & set(yoke.variables)
    speed, wobble, r = 4.0, 0.25, 0.05
    result = simulate(yoke, start_values={"speed": speed, "radius": r})
    t = result["time"]
    assert (t[0], t[-1], len(t)) == (1.0, pytest.approx(3.0), 101), "the file's own experiment"

    u = speed * t + wobble * np.sin(2 * t)
    omega = speed + 2 * wobble * np.cos(2 * t)
    alpha = -4 * wobble * np.sin(2 * t)
    position = r * np.exp(1j * u)
    velocity = 1j * omega * position
    acceleration = (1j * alpha - omega**2) * position
    still = np.zeros_like(t)
    expected = {
        "yoke.x": position.real, "yoke.y": still, "yoke.phi": still,
        "yoke.vx": velocity.real, "yoke.vy": still, "yoke.omega": still,
        "yoke.ax": acceleration.real, "yoke.ay": still, "yoke.alpha": still,
        "crank.A.x": position.real, "crank.A.y": position.imag,
        "crank.A.vx": velocity.real, "crank.A.vy": velocity.imag,
        "crank.A.ax": acceleration.real, "crank.A.ay": acceleration.imag,
        "turn.position": u, "turn.velocity": omega, "turn.acceleration": alpha,
    }  # fmt: skip
    assert_accurate(result, expected)
    for suffix, output in (("position", "x"), ("velocity", "vx"), ("acceleration", "ax")):
        np.testing.assert_allclose(result[f"stroke.{suffix}"], result[f"yoke.{output}"], atol=1e-15)


def test_derived_parameter_follows(slave):
    instance = slave("turning_yoke").start({"radius": 0.045}, start_time=1.0)
    assert instance.get_one("diameter") == pytest.approx(0.09, rel=1e-15)


def test_two_drivers(slave):
    """The tool's tip: both angles add, and so do their rates."""
    instance = slave("two_link_arm")
    shoulder, elbow = (0.4, 1.1, -0.7), (-0.9, 2.3, 0.6)
    inputs = {"rates": 2}
    for driver, values in (("shoulder", shoulder), ("elbow", elbow)):
        for suffix, value in zip(("position", "velocity", "acceleration"), values, strict=True):
            inputs[f"{driver}.{suffix}"] = value
    instance.start(inputs)
    instance.step(0.1)

    upper = np.array(shoulder)
    fore = upper + np.array(elbow)
    tip = [0j, 0j, 0j]
    # The tool is welded a quarter turn on.
    for length, (phi, omega, alpha) in ((0.4, upper), (0.3, fore), (0.1j, fore)):
        p = length * np.exp(1j * phi)
        tip[0] += p
        tip[1] += 1j * omega * p
        tip[2] += (1j * alpha - omega**2) * p
    found = instance.outputs()
    for vector, (x, y) in zip(tip, (("x", "y"), ("vx", "vy"), ("ax", "ay")), strict=True):
        assert found[f"tool.T.{x}"] == pytest.approx(vector.real, rel=1e-13)
        assert found[f"tool.T.{y}"] == pytest.approx(vector.imag, rel=1e-13)
    assert found["tool.phi"] == pytest.approx(fore[0] + np.pi / 2, rel=1e-14)
    assert found["reach.position"] == pytest.approx(abs(tip[0]), rel=1e-13)
    along = (tip[1] * np.conj(tip[0])).real / abs(tip[0])
    assert found["reach.velocity"] == pytest.approx(along, rel=1e-13)
