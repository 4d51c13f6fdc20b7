"""Assemblies that do not close, steps past a dead point, and calls with impossible times."""

import numpy as np
import pytest
from closed_form import CLOSED_FORMS, FourBar, Tlv, largest_errors
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import fmi2LastSuccessfulTime, fmi2Terminated
from harness import DISCARD, ERROR, WARNING, numbers_in, signals, simulate

NAN, INFINITY = float("nan"), float("inf")


# ---------------------------------------------------------------------------------------------
# Assembly


TOO_LONG = [
    # No triangle has a side longer than the other two together, no quadrilateral one longer
    # than the other three.
    pytest.param("four_bar", {"crank_length": 1.0}, {"O2", "A", "B", "O4"}, id="four_bar"),
    pytest.param(
        "slider_crank", {"crank_length": 0.5}, {"O", "A", "B", "guide"}, id="slider_crank"
    ),
    # Here the loop closes at any length but the driver's own: the driver is what stays open.
    pytest.param("tlv", {"arm_length": 0.9}, {"O", "C", "A", "slide", "side_length"}, id="tlv"),
]


def names_an_open_joint(texts, joints):
    return any(f"`{joint}`" in text for text in texts for joint in joints)


@pytest.mark.parametrize(("name", "values", "joints"), TOO_LONG)
def test_too_long_to_assemble(slave, name, values, joints):
    """Initialization ends in an error that names the open joint; a reset makes it good."""
    instance = slave(name)
    with pytest.raises(FMICallException) as failed:
        instance.start(values)
    assert failed.value.function == "fmi2ExitInitializationMode"
    assert failed.value.status == ERROR
    errors = instance.messages.texts(ERROR)
    assert names_an_open_joint(errors, joints), errors

    instance.fmi.reset()
    assert instance.start().outputs() == slave(name).start().outputs()
    instance.step(0.1)


def test_a_start_beyond_a_dead_point(slave):
    """The crank of Peaucellier's linkage swings. One turn further it closes, but no motion leads
    there: initialization tells where the motion stops."""
    instance = slave("peaucellier")
    with pytest.raises(FMICallException) as failed:
        instance.start({"crank_angle.position": np.radians(30) + 2 * np.pi})
    assert failed.value.function == "fmi2ExitInitializationMode"
    assert failed.value.status == ERROR
    errors = instance.messages.texts(ERROR)
    assert any("stops with driver `crank_angle` at" in text for text in errors), errors


@pytest.mark.parametrize(("name", "values", "joints"), TOO_LONG)
def test_too_long_for_an_early_reader(slave, name, values, joints):
    """A getter in initialization mode fails for the same reason, and says so."""
    instance = slave(name)
    instance.setup()
    instance.set(values)
    instance.fmi.enterInitializationMode()
    with pytest.raises(FMICallException) as failed:
        instance.outputs()
    assert failed.value.status == ERROR
    assert names_an_open_joint(instance.messages.texts(ERROR), joints), instance.messages


def test_too_long_in_simulate_fmu(fmu, messages):
    with pytest.raises(FMICallException) as failed:
        simulate(fmu("four_bar"), messages, start_values={"crank_length": 1.0})
    assert failed.value.status == ERROR
    assert names_an_open_joint(messages.texts(ERROR), {"O2", "A", "B", "O4"}), messages


def test_start_behind_a_dead_point_by_parameters(slave):
    """With a crank of 0.25 m the way from 60° to 300° is blocked near 180°, where A–O4 is too long.

    At 300° the linkage closes all the same, possibly in another mode: it is refused.
    """
    instance = slave("four_bar")
    values = {"crank_length": 0.25, "crank_angle.position": np.radians(300)}
    with pytest.raises(FMICallException) as failed:
        instance.start(values)
    assert failed.value.status == ERROR
    (error,) = instance.messages.texts(ERROR)
    assert "stops with driver `crank_angle` at" in error
    assert "and parameter `crank_length` at" in error


# ---------------------------------------------------------------------------------------------
# Dead points


def ramp_past(name, start, stop, steps=100):
    """A driver signal at constant rate over 1 s that ends beyond a dead point."""
    time = np.linspace(0, 1, steps + 1)
    rate = np.full_like(time, stop - start)
    return signals(CLOSED_FORMS[name].driver, time, start + (stop - start) * time, rate, 0 * rate)


DEAD_POINTS = [
    # name, parameters, from, to, where it ends
    pytest.param("tlv", {}, 0.5, 0.703, 0.65, id="tlv-stretched"),
    pytest.param("tlv", {}, 0.3, 0.103, 0.15, id="tlv-folded"),
    # |A–O4| = coupler + rocker: r² + b² - 2 r b cos u = (c + d)².
    pytest.param(
        "four_bar",
        {"crank_length": 0.2},
        1.0,
        3.0,
        np.arccos((0.2**2 + 0.4**2 - 0.55**2) / (2 * 0.2 * 0.4)),
        id="four_bar",
    ),
]


@pytest.mark.parametrize(("name", "parameters", "start", "stop", "limit"), DEAD_POINTS)
def test_simulate_fmu_ends_at_a_dead_point(fmu, messages, name, parameters, start, stop, limit):
    """It ends by itself, with the last good pose recorded and one warning with driver and value."""
    form = CLOSED_FORMS[name]
    result = simulate(
        fmu(name),
        messages,
        input=ramp_past(name, start, stop),
        stop_time=1.0,
        output_interval=0.01,
        start_values=parameters | {"rates": 2},
    )
    position = result[f"{form.driver}.position"]
    assert len(result) < 101, "it stopped before the end"

    # All rows but the last belong to values this side of the limit, up to the last of the signal.
    reached = position[:-1]
    direction = np.sign(stop - start)
    assert np.all(direction * (limit - reached) > 0)
    step = abs(stop - start) / 100
    assert abs(limit - reached[-1]) <= 1.001 * step
    # The rounding of the driver's value, 1e-16, is multiplied by 1/sin(angle between the bars),
    # its square and its cube: 10, 100 and 1000 one step before the dead point.
    expected = form(**parameters).motion(reached, stop - start)
    errors = largest_errors(result[:-1], expected)
    assert errors["position"] < 1e-12
    assert errors["velocity"] < 1e-10
    assert errors["acceleration"] < 1e-8

    # The step that failed is recorded at the time of the last success, with the pose of then.
    assert position[-1] != reached[-1]
    assert result["time"][-1] == result["time"][-2]
    for output in (n for n in expected if n.rpartition(".")[2] in ("x", "y", "phi")):
        assert result[output][-1] == pytest.approx(result[output][-2], rel=1e-12, abs=1e-15), output

    about_it = [text for text in messages.texts(WARNING) if form.driver in text]
    assert about_it, messages
    # Its value: that of the failed step or of the limit, in metres, radians or degrees.
    values = (position[-1], limit, np.degrees(position[-1]), np.degrees(limit))
    assert any(
        number == pytest.approx(value, rel=5e-3)
        for text in about_it
        for number in numbers_in(text)
        for value in values
    ), about_it
    assert not messages.texts(ERROR)


def test_discard_and_the_state_after_it(slave):
    """Step by step: the status, what may be asked, what may be read, and a way to go on."""
    instance = slave("tlv").start({"rates": 2})
    instance.set({"side_length.position": 0.6})
    instance.step(0.1)
    before = instance.outputs()
    instance.set({"side_length.position": 0.7})
    with pytest.raises(FMICallException) as failed:
        instance.step(0.1)
    assert failed.value.status == DISCARD

    assert instance.fmi.getBooleanStatus(fmi2Terminated) is True
    assert instance.fmi.getRealStatus(fmi2LastSuccessfulTime) == 0.1, "a held input jumps at once"
    for output, value in instance.outputs().items():
        if output.rpartition(".")[2] in ("x", "y", "phi"):
            assert value == pytest.approx(before[output], rel=1e-12, abs=1e-15), output

    # In this state another step is refused, without harm.
    with pytest.raises(FMICallException):
        instance.fmi.doStep(0.1, 0.1)

    instance.fmi.reset()
    instance.start({"rates": 2})
    instance.set({"side_length.position": 0.6})
    instance.step(0.1)
    assert instance.outputs() == before


def test_one_warning_for_one_dead_point(slave):
    instance = slave("tlv").start()
    instance.set({"side_length.position": 0.7})
    with pytest.raises(FMICallException):
        instance.step(0.1)
    texts = instance.messages.texts(WARNING)
    assert len(texts) == 1, texts
    assert "side_length" in texts[0]
    # The limit is base + arm_length; printed with at least three digits.
    assert any(number == pytest.approx(0.65, abs=5e-4) for number in numbers_in(texts[0])), texts


def test_a_dead_point_within_a_step(slave):
    """Carried by its derivative the driver reaches the limit half-way: the time says how far.

    The last successful time is one whose driver value was reached, and the pose is that of then.
    """
    instance = slave("tlv").start({"side_length.position": 0.60})
    instance.set_derivatives("side_length.position", 1.0)
    with pytest.raises(FMICallException) as failed:
        instance.step(0.1)
    assert failed.value.status == DISCARD
    reached = instance.fmi.getRealStatus(fmi2LastSuccessfulTime)
    assert 0 <= reached <= 0.05 + 1e-12
    side, arm = instance.get("rod.x", "arm.phi")
    assert arm == pytest.approx(Tlv().motion(0.60 + reached)["arm.phi"].item(), abs=1e-6)
    assert side == pytest.approx(0.25 * np.cos(arm), rel=1e-9)


def test_a_stop_within_a_step(slave):
    """The bolt of the latch is 0.03 m times the sine of the handle's angle; it ends at 0.02 m."""
    instance = slave("latch").start({"handle_angle.position": 0.7})
    instance.set_derivatives("handle_angle.position", 0.5)
    with pytest.raises(FMICallException) as failed:
        instance.step(0.1)
    assert failed.value.status == DISCARD
    reached = instance.fmi.getRealStatus(fmi2LastSuccessfulTime)
    assert reached == pytest.approx((np.arcsin(2 / 3) - 0.7) / 0.5, abs=1e-12)
    throw, angle = instance.get("throw.position", "handle.phi")
    assert throw == pytest.approx(0.02, abs=1e-15)
    assert angle == pytest.approx(np.arcsin(2 / 3), abs=1e-12)
    (warning,) = instance.messages.texts(WARNING)
    assert warning.startswith("stop `strike` reached: throw = 0.020000000 m"), warning


def test_a_step_of_too_much_work(slave):
    """A sub-step turns the crank by less than a turn: a thousand turns take more than 500. The
    host goes back and raises the budget, which is tunable."""
    instance = slave("four_bar").start({"solver.budget": 500})
    start = instance.get_one("crank_angle.position")
    before = instance.fmi.getFMUstate()
    far = start + 2000 * np.pi
    instance.set({"crank_angle.position": far})
    with pytest.raises(FMICallException) as failed:
        instance.step(0.1)
    assert failed.value.status == DISCARD
    (warning,) = instance.messages.texts(WARNING)
    assert "takes more than 500 sub-steps" in warning, warning
    assert instance.get_one("crank.phi") == start

    instance.fmi.setFMUstate(before)
    instance.fmi.freeFMUstate(before)
    instance.set({"solver.budget": 1e5, "crank_angle.position": far})
    instance.step(0.1)
    assert instance.get_one("crank.phi") == pytest.approx(far, rel=1e-12)


def test_a_start_beyond_a_stop(slave):
    instance = slave("latch")
    with pytest.raises(FMICallException) as failed:
        instance.start({"handle_angle.position": 0.8})
    assert failed.value.status == ERROR
    errors = instance.messages.texts(ERROR)
    assert any("the start pose is beyond stop `strike`" in text for text in errors), errors


def test_terminate_after_a_discarded_step(slave):
    instance = slave("tlv").start()
    instance.set({"side_length.position": 0.7})
    with pytest.raises(FMICallException):
        instance.step(0.1)
    instance.fmi.terminate()


def test_up_to_the_dead_point_and_back(slave):
    """To within 1e-6 m of the limit and home again, on the same branch."""
    form = Tlv()
    instance = slave("tlv").start()
    lengths = [0.6, 0.64, 0.649, 0.6499, 0.649999, 0.6499, 0.649, 0.64, 0.6, 0.35]
    for length in lengths:
        instance.set({"side_length.position": length})
        instance.step(0.1)
        # d(arm angle)/d(length) = length/(base arm sin(angle)), 2e3 at worst, times rounding.
        assert instance.get_one("arm.phi") == pytest.approx(
            form.motion(length)["arm.phi"].item(), abs=1e-11
        )


# ---------------------------------------------------------------------------------------------
# Times and steps


@pytest.mark.parametrize(
    ("time", "size"),
    [(0.5, -0.1), (0.5, NAN), (NAN, 0.1), (0.5, INFINITY), (INFINITY, 0.1), (0.5, -INFINITY)],
)
def test_impossible_steps(slave, time, size):
    """An error that changes nothing: the next proper step gives what it would have given."""
    instance, undisturbed = slave("four_bar").start(), slave("four_bar").start()
    for each in (instance, undisturbed):
        each.step(0.5)
        each.set({"crank_angle.position": 1.3})
    with pytest.raises(FMICallException) as refused:
        instance.fmi.doStep(time, size)
    assert refused.value.status == ERROR
    assert instance.messages.texts(ERROR)
    instance.step(0.1)
    undisturbed.step(0.1)
    assert instance.outputs() == undisturbed.outputs()
    assert instance.get_one("rocker.phi") == pytest.approx(
        FourBar().motion(1.3)["rocker.phi"].item(), rel=1e-12
    )


@pytest.mark.parametrize("start_time", [NAN, INFINITY])
def test_impossible_start_time(slave, start_time):
    instance = slave("four_bar")
    with pytest.raises(FMICallException) as refused:
        instance.setup(start_time=start_time)
    assert refused.value.status == ERROR
    instance.start()
    instance.step(0.1)


@pytest.mark.parametrize("factor", [1 + 1e-12, 1 - 1e-12])
def test_communication_point_off_by_rounding(slave, factor):
    """Hosts add up their steps; a point that differs by rounding is the same point."""
    instance = slave("four_bar").start(start_time=10.0)
    instance.set({"crank_angle.position": 1.3})
    instance.fmi.doStep(10.0 * factor, 0.1)
    instance.set({"crank_angle.position": 1.4})
    instance.fmi.doStep(10.1 * factor, 0.1)
    assert instance.get_one("crank.phi") == pytest.approx(1.4, rel=1e-14)


def test_steps_that_add_up_past_the_stop_time(slave):
    """0.1 + 0.1 + 0.1 is more than 0.3, by rounding: still within the experiment."""
    instance = slave("four_bar").start(stop_time=0.3)
    for _ in range(3):
        instance.step(0.1)
    assert instance.time > 0.3
    assert not instance.messages.texts(WARNING)


def test_steps_before_initialization(slave):
    """A call out of turn is refused and changes nothing."""
    instance = slave("four_bar")
    with pytest.raises(FMICallException) as refused:
        instance.fmi.doStep(0.0, 0.1)
    assert refused.value.status == ERROR
    instance.start()
    instance.step(0.1)
