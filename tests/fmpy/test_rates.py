"""Sources of velocities and accelerations of a driver, and values between samples."""

import numpy as np
import pytest
from closed_form import CLOSED_FORMS, FourBar, largest_errors
from harness import assert_accurate, collect, signals, simulate
from motions import full_motion

NAMES = sorted(CLOSED_FORMS)
AUTO, INPUTS, ESTIMATED = {"rates": 1}, {"rates": 2}, {"rates": 3}
TAYLOR = {"extrapolation": 2}

STEPS = (100, 200, 400)
"""Three step sizes, each half the one before; the motions here last 1 s."""


def run(fmu, name, steps, start_values, columns=1):
    """Simulates the full motion with the first `columns` of value, rate, acceleration wired."""
    time = np.linspace(0, 1, steps + 1)
    motion = full_motion(name, time)
    return simulate(
        fmu(name),
        input=signals(CLOSED_FORMS[name].driver, time, *motion[:columns]),
        stop_time=1.0,
        output_interval=1 / steps,
        start_values=start_values,
    )


def orders(errors):
    """Order of convergence between successive halvings of the step."""
    return np.log2(np.array(errors[:-1]) / np.array(errors[1:]))


def approximately(order):
    """An order measured at finite steps: the next term of the series shifts it by about h w/2."""
    return pytest.approx([order] * (len(STEPS) - 1), abs=0.15)


# ---------------------------------------------------------------------------------------------
# Estimated rates


@pytest.mark.parametrize("name", NAMES)
def test_estimated_rates_converge(fmu, name):
    """From the third step on: second order in velocity, first in acceleration.

    The quadratic through three samples differentiated at the newest is off by h² u'''/3 and
    h u'''. Positions do not depend on it.
    """
    form = CLOSED_FORMS[name]
    velocity, acceleration = [], []
    for steps in STEPS:
        result = run(fmu, name, steps, ESTIMATED)
        # Row k + 1 belongs to the value set before step k; three samples exist from k = 2 on.
        sampled = full_motion(name, result["time"][2:-1])
        errors = largest_errors(result[3:], form().motion(*sampled))
        assert errors["position"] < 1e-12
        velocity.append(errors["velocity"])
        acceleration.append(errors["acceleration"])
    assert orders(velocity) == approximately(2)
    assert orders(acceleration) == approximately(1)


def test_estimated_rates_have_the_errors_of_the_quadratic(fmu):
    """Not only the order, the size: h² u'''/3 and h u''' for the crank, which is the driver."""
    steps = 400
    h = 1 / steps
    result = run(fmu, "four_bar", steps, ESTIMATED)
    _, rate, acceleration = full_motion("four_bar", result["time"][2:-1])
    third = (2 * np.pi) ** 3  # the largest u''' of u = 2 pi t - sin(2 pi t)
    # The next terms of the series are smaller by h w = 1.6 %.
    assert np.max(np.abs(result["crank.omega"][3:] - rate)) == pytest.approx(
        h**2 * third / 3, rel=0.03
    )
    assert np.max(np.abs(result["crank.alpha"][3:] - acceleration)) == pytest.approx(
        h * third, rel=0.03
    )


def test_estimated_rates_begin_with_zero_and_the_line(fmu):
    """One sample: no rate. Two: the line through them. Three: the quadratic."""
    steps = 50
    h = 1 / steps
    result = run(fmu, "pendulum", steps, ESTIMATED)
    u = full_motion("pendulum", result["time"])[0]
    omega, alpha = result["rod.omega"], result["rod.alpha"]
    # Rounding of a difference of angles of size 1, over h and h².
    at = {"abs": 1e-14 / h}, {"abs": 1e-14 / h**2}
    assert (omega[0], alpha[0], omega[1], alpha[1]) == (0, 0, 0, 0)
    assert omega[2] == pytest.approx((u[1] - u[0]) / h, **at[0])
    assert alpha[2] == pytest.approx(0, abs=1e-12)  # what solving for it leaves of zero
    assert omega[3] == pytest.approx((3 * u[2] - 4 * u[1] + u[0]) / (2 * h), **at[0])
    assert alpha[3] == pytest.approx((u[2] - 2 * u[1] + u[0]) / h**2, **at[1])


def test_estimates_take_uneven_steps_into_account(slave):
    """A quadratic in time is differentiated exactly whatever the steps."""
    form = FourBar()
    sizes = [0.010, 0.013, 0.007, 0.020, 0.004, 0.010, 0.031]
    time = np.concatenate([[0.0], np.cumsum(sizes)])
    u = 1.0 + 2.0 * time - 3.0 * time**2
    instance = slave("four_bar").start({**ESTIMATED, "crank_angle.position": u[0]})
    rows = []
    for value, size in zip(u[:-1], sizes, strict=True):
        instance.set({"crank_angle.position": value})
        instance.step(size)
        rows.append(instance.outputs())
    found = collect(rows[2:])
    t = time[2:-1]
    expected = form.motion(u[2:-1], 2.0 - 6.0 * t, -6.0)
    errors = largest_errors(found, expected)
    # 4 eps |u| / (step ratio)² amplified: eps/h = 6e-14 and eps/h² = 1e-11 of rates of size 1.
    assert errors["velocity"] < 1e-12
    assert errors["acceleration"] < 2e-10


@pytest.mark.parametrize("name", NAMES)
def test_auto_with_only_the_angle_wired_estimates(fmu, name):
    """Also where the host writes zeros to the inputs nobody wired: the same numbers, bit by bit."""
    estimated = run(fmu, name, 100, ESTIMATED)
    angle_only = run(fmu, name, 100, AUTO)

    driver = CLOSED_FORMS[name].driver
    time = np.linspace(0, 1, 101)
    zero = np.zeros_like(time)
    zeros_written = simulate(
        fmu(name),
        input=signals(driver, time, full_motion(name, time)[0], zero, zero),
        stop_time=1.0,
        output_interval=1 / 100,
    )
    for output in fmu(name).names("output"):
        np.testing.assert_array_equal(angle_only[output], estimated[output], err_msg=output)
        np.testing.assert_array_equal(zeros_written[output], estimated[output], err_msg=output)


# ---------------------------------------------------------------------------------------------
# Rates as inputs


def test_auto_takes_each_input_once_it_is_not_zero(slave):
    """And keeps to them when they return to zero: a crank may stand still."""
    form = FourBar()
    instance = slave("four_bar").start()
    position, velocity, acceleration = (
        f"crank_angle.{suffix}" for suffix in ("position", "velocity", "acceleration")
    )
    u, sent, rows = form.start, [], []
    for rates in ((0.5, 1.0), (0.0, 0.0), (0.0, -2.0)):
        u += 0.02
        instance.set({position: u, velocity: rates[0], acceleration: rates[1]})
        instance.step(0.01)
        sent.append((u, *rates))
        rows.append(instance.outputs())
    assert_accurate(collect(rows), form.motion(*np.transpose(sent)))


def test_auto_differentiates_a_velocity_wired_alone(fmu):
    """Only angle and velocity wired: the acceleration is the velocity's backward difference."""
    steps = 100
    result = run(fmu, "slider_crank", steps, AUTO, columns=2)
    velocity = result["crank_angle.velocity"]
    np.testing.assert_allclose(result["crank.omega"][2:], velocity[2:], rtol=1e-13)
    # Row k + 1 belongs to sample k; before k = 2 the sample before it had no rate yet.
    difference = np.diff(velocity)[2:] * steps
    np.testing.assert_allclose(
        result["crank.alpha"][3:], difference, atol=1e-13 * steps * np.max(velocity)
    )


def test_inputs_are_taken_as_they_stand(slave):
    """`rates = inputs` estimates nothing, not even when all rates are zero."""
    form = FourBar()
    instance = slave("four_bar").start(INPUTS)
    for k in range(1, 5):
        instance.set({"crank_angle.position": form.start + 0.01 * k})
        instance.step(0.01)
    outputs = instance.outputs()
    assert all(outputs[f"{body}.omega"] == 0 == outputs[f"{body}.alpha"] for body in form.bodies)


def test_estimated_ignores_rates_that_are_set(slave):
    wired, unwired = slave("four_bar").start(ESTIMATED), slave("four_bar").start(ESTIMATED)
    for k in range(5):
        values = {"crank_angle.position": 1.0 + 0.01 * k}
        wired.set({**values, "crank_angle.velocity": 7.0, "crank_angle.acceleration": 5.0})
        unwired.set(values)
        wired.step(0.01)
        unwired.step(0.01)
        assert wired.outputs() == unwired.outputs()


def test_each_driver_has_its_own_source(slave):
    """One driver with rates, one without: the first as given, the second estimated."""
    instance = slave("two_link_arm").start()
    h = 0.01
    elbow = [0.35, 0.36, 0.38, 0.41]
    for k, value in enumerate(elbow):
        instance.set(
            {
                "shoulder.position": 0.2 + 0.03 * k,
                "shoulder.velocity": 3.0,
                "shoulder.acceleration": 0.5,
                "elbow.position": value,
            }
        )
        instance.step(h)
    estimated = (3 * elbow[3] - 4 * elbow[2] + elbow[1]) / (2 * h)
    upper, fore = instance.get("upper.omega", "fore.omega")
    assert upper == pytest.approx(3.0, rel=1e-14)
    assert fore == pytest.approx(3.0 + estimated, rel=1e-12)


# ---------------------------------------------------------------------------------------------
# Input derivatives and extrapolation


def test_input_derivatives_last_one_step(slave):
    """A step without new derivatives holds the input again."""
    form = FourBar()
    position = "crank_angle.position"
    instance = slave("four_bar").start()
    instance.set({position: 1.1})
    instance.set_derivatives(position, 2.0, 1.0)
    instance.step(0.1)
    assert instance.get_one("crank.phi") == pytest.approx(1.1 + 0.2 + 0.005, rel=1e-14)
    instance.set({position: 1.4})
    instance.step(0.1)
    assert instance.get_one("crank.phi") == pytest.approx(1.4, rel=1e-14)
    assert instance.get_one("rocker.phi") == pytest.approx(
        form.motion(1.4)["rocker.phi"].item(), rel=1e-12
    )


@pytest.mark.parametrize(("rates", "acceleration"), [(AUTO, 1.0), (INPUTS, 0.0)])
def test_wired_rates_come_before_input_derivatives(slave, rates, acceleration):
    """The derivatives shape the path (4.2.1); only a rate that nobody wires is taken from them."""
    position, velocity = "crank_angle.position", "crank_angle.velocity"
    instance = slave("four_bar").start(rates)
    instance.set({position: 1.0, velocity: 9.0})
    instance.set_derivatives(position, 2.0, 1.0)
    instance.step(0.1)
    found = instance.get("crank.phi", "crank.omega", "crank.alpha")
    assert found == pytest.approx([1.0 + 0.2 + 0.005, 9.0, acceleration], rel=1e-14)


@pytest.mark.parametrize("name", NAMES)
def test_taylor_is_the_polynomial_of_the_rates(fmu, name):
    """u + u' h + u'' h²/2 with the rates in force, and its derivatives, to full accuracy."""
    form = CLOSED_FORMS[name]
    h = 1 / 200
    result = run(fmu, name, 200, INPUTS | TAYLOR, columns=3)
    u, rate, acceleration = (
        result[f"{form.driver}.{suffix}"][1:] for suffix in ("position", "velocity", "acceleration")
    )
    expected = form().motion(
        u + rate * h + acceleration * h**2 / 2, rate + acceleration * h, acceleration
    )
    assert_accurate(result[1:], expected)


@pytest.mark.parametrize("wired", [1, 3], ids=["angle-only", "with-rates"])
@pytest.mark.parametrize("name", NAMES)
def test_taylor_takes_the_lag_away(fmu, name, wired):
    """Outputs at t against the motion at t: third order in position, second and first in rates.

    With the rates wired the positions are off by h³ u'''/6; with rates from the last three
    samples by (1/6 + 1/2 + 1/3) h³ u''', the quadratic continued by one step.
    """
    form = CLOSED_FORMS[name]
    errors = {"position": [], "velocity": [], "acceleration": []}
    for steps in STEPS:
        result = run(fmu, name, steps, TAYLOR, columns=wired)
        exact = form().motion(*full_motion(name, result["time"][3:]))
        for order, error in largest_errors(result[3:], exact).items():
            errors[order].append(error)
    assert orders(errors["position"]) == approximately(3)
    assert orders(errors["velocity"]) == approximately(2)
    assert orders(errors["acceleration"]) == approximately(1)


def test_hold_lags_one_step(fmu):
    """The purpose of `taylor`: held inputs are late by h, an error of first order."""
    errors = []
    for steps in STEPS:
        result = run(fmu, "four_bar", steps, INPUTS, columns=3)
        exact = FourBar().motion(*full_motion("four_bar", result["time"]))
        errors.append(largest_errors(result, exact)["position"])
    assert orders(errors) == approximately(1)
