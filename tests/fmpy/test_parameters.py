"""Parameters changed at the start, between steps, and when they may not be."""

import itertools

import numpy as np
import pytest
from closed_form import CLOSED_FORMS, FourBar
from fmpy.fmi1 import FMICallException
from harness import DISCARD, ERROR, WARNING, assert_accurate, collect, signals, simulate
from motions import full_motion

CHANGED = {
    "pendulum": {"length": 0.8},
    "slider_crank": {"crank_length": 0.06, "offset": -0.02},
    "four_bar": {"crank_length": 0.12},
    "tlv": {"arm_length": 0.24, "base": 0.41},
    "tlv_crank": {"base": 0.6},
}


@pytest.mark.parametrize("name", sorted(CHANGED))
def test_changed_at_the_start(fmu, name):
    """A longer crank, a lower guide: the same branch, with the new lengths, over a full motion."""
    form = CLOSED_FORMS[name]
    time = np.linspace(0, 1, 361)
    result = simulate(
        fmu(name),
        input=signals(form.driver, time, *full_motion(name, time)),
        stop_time=1.0,
        output_interval=1 / 360,
        start_values=CHANGED[name] | {"rates": 2},
    )
    sent = [
        result[f"{form.driver}.{suffix}"] for suffix in ("position", "velocity", "acceleration")
    ]
    assert_accurate(result, form(**CHANGED[name]).motion(*sent))


def test_order_of_setting_does_not_matter(slave):
    """Parameters and driver are taken together when initialization ends: equal to the last bit."""
    values = {
        "crank_length": 0.12,
        "base": 0.42,
        "crank_angle.position": 2.0,
        "rocker_length": 0.31,
    }
    found = []
    for order in itertools.permutations(values):
        instance = slave("four_bar")
        instance.setup()
        for name in order:
            instance.set({name: values[name]})
        instance.fmi.enterInitializationMode()
        instance.fmi.exitInitializationMode()
        found.append(instance.outputs())
    assert all(outputs == found[0] for outputs in found)


def test_set_in_initialization_mode(slave):
    """Values may come before or in initialization mode, and outputs may be read in it."""
    instance = slave("four_bar")
    instance.setup()
    instance.fmi.enterInitializationMode()
    instance.set({"crank_length": 0.12, "crank_angle.position": 2.0})
    seen = instance.outputs()
    assert seen["coupler.x"] == pytest.approx(0.12 * np.cos(2.0), rel=1e-12)
    instance.fmi.exitInitializationMode()
    assert instance.outputs() == pytest.approx(seen, rel=1e-13, abs=1e-15)
    assert instance.get("crank_length", "crank_angle.position") == [0.12, 2.0]


def test_a_passing_value_that_cannot_be_assembled_does_no_harm(slave):
    """Consistency is judged with all values set: in between the crank may be too long."""
    instance = slave("four_bar")
    instance.setup()
    instance.set({"crank_length": 2.0})
    instance.set({"base": 0.5})
    instance.set({"crank_length": 0.12})
    instance.fmi.enterInitializationMode()
    instance.fmi.exitInitializationMode()
    expected = FourBar(crank_length=0.12, base=0.5).motion(FourBar.start)
    assert instance.get_one("rocker.phi") == pytest.approx(expected["rocker.phi"].item(), rel=1e-12)


def test_tunable_between_steps(slave):
    """The rocker grows while the crank turns: every pose as if it had always been that long.

    The change contributes nothing to velocities, which stay those of the driver alone.
    """
    instance = slave("four_bar").start({"rates": 2})
    u = FourBar.start + np.linspace(0, np.pi, 60)
    lengths = 0.30 + 0.02 * np.sin(np.linspace(0, 7, 60))
    rows = []
    for angle, length in zip(u, lengths, strict=True):
        instance.set(
            {
                "crank_angle.position": angle,
                "crank_angle.velocity": 3.0,
                "crank_angle.acceleration": -1.0,
                "rocker_length": length,
            }
        )
        instance.step(0.01)
        rows.append(instance.outputs())
    assert_accurate(collect(rows), FourBar(rocker_length=lengths).motion(u, 3.0, -1.0))


def test_tunable_while_the_driver_rests(slave):
    """The parameter alone moves the mechanism, and nothing has a velocity."""
    instance = slave("four_bar").start({"rates": 2})
    instance.set({"rocker_length": 0.33})
    instance.step(0.01)
    outputs = instance.outputs()
    expected = FourBar(rocker_length=0.33).motion(FourBar.start)
    assert outputs["rocker.phi"] == pytest.approx(expected["rocker.phi"].item(), rel=1e-12)
    assert outputs["rocker.omega"] == 0 == outputs["rocker.alpha"]


def test_tunable_as_a_signal_of_simulate_fmu(fmu):
    """FMPy sets tunable parameters from its signals too, here in one jump at 0.5 s."""
    time = np.array([0.0, 0.5, 0.5, 1.0])
    table = np.zeros(
        4, dtype=[("time", float), ("crank_angle.position", float), ("rocker_length", float)]
    )
    table["time"] = time
    table["crank_angle.position"] = 1.0
    table["rocker_length"] = [0.30, 0.30, 0.32, 0.32]
    result = simulate(fmu("four_bar"), input=table, stop_time=1.0, output_interval=0.1)
    before = FourBar().motion(1.0)["rocker.phi"].item()
    after = FourBar(rocker_length=0.32).motion(1.0)["rocker.phi"].item()
    np.testing.assert_allclose(result["rocker.phi"][result["time"] < 0.55], before, rtol=1e-12)
    np.testing.assert_allclose(result["rocker.phi"][result["time"] > 0.55], after, rtol=1e-12)


def test_a_tunable_change_that_cannot_be_followed(slave):
    """A rocker too short to be reached: the step is discarded, the last pose still stands."""
    instance = slave("four_bar").start()
    before = instance.outputs()
    instance.set({"rocker_length": 0.05})
    with pytest.raises(FMICallException) as failed:
        instance.step(0.1)
    assert failed.value.status == DISCARD
    assert instance.get_one("rocker.phi") == pytest.approx(before["rocker.phi"], rel=1e-12)
    assert instance.messages.texts(WARNING)


@pytest.mark.parametrize("parameter", ["crank_length", "rates"])
def test_fixed_after_initialization(slave, parameter):
    instance = slave("four_bar").start()
    (old,) = instance.get(parameter)
    with pytest.raises(FMICallException) as refused:
        instance.set({parameter: 2})
    assert refused.value.status == ERROR
    assert instance.get_one(parameter) == old
    assert any(parameter in text for text in instance.messages.texts(ERROR))
    instance.step(0.1)


def test_derived_parameters_cannot_be_set(slave):
    instance = slave("turning_yoke")
    instance.setup()
    with pytest.raises(FMICallException) as refused:
        instance.set({"diameter": 0.1})
    assert refused.value.status == ERROR
    assert any("diameter" in text for text in instance.messages.texts(ERROR))
    instance.fmi.enterInitializationMode()
    instance.fmi.exitInitializationMode()
    assert instance.get_one("diameter") == pytest.approx(0.06, rel=1e-15)


@pytest.mark.parametrize(
    ("name", "parameter", "value"),
    [
        ("four_bar", "crank_length", 0.0),
        ("four_bar", "crank_length", -0.1),
        ("four_bar", "crank_length", float("nan")),
        ("four_bar", "crank_length", float("inf")),
        ("four_bar", "crank_angle.position", float("nan")),
        ("four_bar", "crank_angle.velocity", float("-inf")),
        ("turning_yoke", "radius", 1.5),
        ("four_bar", "rates", 0),
        ("four_bar", "rates", 4),
        ("four_bar", "extrapolation", 3),
    ],
)
def test_refused_values(slave, name, parameter, value):
    """A discard for values out of range (FMI 2.0, 2.2.3), an error for no number; the message names
    the variable, the old value is kept."""
    instance = slave(name)
    instance.setup()
    instance.fmi.enterInitializationMode()
    (old,) = instance.get(parameter)
    with pytest.raises(FMICallException) as refused:
        instance.set({parameter: value})
    # The reason of a discard is a warning, which hosts show.
    status, logged = (DISCARD, WARNING) if np.isfinite(value) else (ERROR, ERROR)
    assert refused.value.status == status
    assert any(parameter in text for text in instance.messages.texts(logged))
    assert instance.get_one(parameter) == old

    instance.fmi.exitInitializationMode()
    instance.step(0.1)
    fresh = slave(name).start()
    fresh.step(0.1)
    assert instance.outputs() == fresh.outputs()


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_refused_inputs_between_steps(slave, value):
    """A whole call is refused or taken: the good value beside the bad one is not set either."""
    instance = slave("four_bar").start({"crank_angle.position": 1.2})
    instance.step(0.1)
    with pytest.raises(FMICallException) as refused:
        instance.set({"crank_angle.position": 1.3, "crank_angle.velocity": value})
    assert refused.value.status == ERROR
    assert instance.get("crank_angle.position", "crank_angle.velocity") == [1.2, 0.0]
    with pytest.raises(FMICallException):
        instance.set_derivatives("crank_angle.position", value)
    instance.set({"crank_angle.position": 1.3})
    instance.step(0.1)
    assert instance.get_one("crank.phi") == pytest.approx(1.3, rel=1e-14)
