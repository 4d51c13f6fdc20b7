"""FMU states, got, set and serialized, and derivatives of outputs."""

import numpy as np
import pytest
from closed_form import CLOSED_FORMS, FourBar, Tlv
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import fmi2FMUstate, fmi2LastSuccessfulTime, fmi2Terminated
from harness import DISCARD, ERROR, RATE_LIMIT, WARNING, Slave
from motions import full_motion

STEPS = 40


def drive(instance: Slave, name: str, steps: range, columns: int = 3) -> list[dict[str, float]]:
    """Some steps of a full motion in STEPS, and the outputs after each."""
    driver = CLOSED_FORMS[name].driver
    suffixes = ("position", "velocity", "acceleration")[:columns]
    time = np.linspace(0, 1, STEPS + 1)
    rows = []
    for k in steps:
        values = full_motion(name, time[k])
        instance.set(
            {f"{driver}.{s}": float(value) for s, value in zip(suffixes, values, strict=False)}
        )
        instance.fmi.doStep(time[k], 1 / STEPS)
        rows.append(instance.outputs())
    return rows


@pytest.fixture
def states(slave):
    """`states(instance)`: a state of the instance, freed at the end of the test."""
    got = []

    def get(instance: Slave):
        got.append((instance, instance.fmi.getFMUstate()))
        return got[-1][1]

    yield get
    for instance, state in got:
        instance.fmi.freeFMUstate(state)


# ---------------------------------------------------------------------------------------------
# Going back


# Estimated rates need the samples seen, `auto` what was once set to other than zero.
SETTINGS = [
    pytest.param({}, 3, id="rates given"),
    pytest.param({}, 1, id="position alone"),
    pytest.param({"rates": 3, "extrapolation": 2}, 1, id="estimated and carried along"),
]


@pytest.mark.parametrize(("settings", "columns"), SETTINGS)
@pytest.mark.parametrize("name", sorted(CLOSED_FORMS))
def test_replay(slave, states, name, settings, columns):
    """Back in the middle of a run, its second half comes out again, to the last bit."""
    instance = slave(name).start(settings)
    drive(instance, name, range(15), columns)
    middle = states(instance)
    here = instance.outputs()
    rest = drive(instance, name, range(15, STEPS), columns)
    instance.fmi.setFMUstate(middle)
    assert instance.outputs() == here
    assert drive(instance, name, range(15, STEPS), columns) == rest


@pytest.mark.parametrize(("settings", "columns"), SETTINGS)
def test_through_bytes(slave, states, settings, columns):
    """Another instance, which was elsewhere, goes on from the bytes to the last bit."""
    first = slave("four_bar").start(settings)
    second = slave("four_bar").start({"crank_length": 0.12})
    drive(first, "four_bar", range(15), columns)
    written = first.fmi.serializeFMUstate(states(first))
    rest = drive(first, "four_bar", range(15, STEPS), columns)

    drive(second, "four_bar", range(7))
    read = second.fmi.deSerializeFMUstate(written)
    second.fmi.setFMUstate(read)
    assert second.fmi.serializeFMUstate(read) == written
    second.fmi.freeFMUstate(read)
    assert second.get_one("crank_length") == first.get_one("crank_length")
    assert drive(second, "four_bar", range(15, STEPS), columns) == rest


def test_a_state_before_the_start(slave, states):
    """Set-up and start values are part of the state, and can be taken back."""
    instance = slave("four_bar")
    fresh = states(instance)
    instance.start({"crank_length": 0.12, "crank_angle.position": 2.0}, start_time=5.0)
    instance.fmi.setFMUstate(fresh)
    assert instance.start().outputs() == slave("four_bar").start().outputs()


def test_steps_tried_and_taken_back(slave, states):
    """As a master with error control does: a whole step, back, and two halves."""
    careful, straight = (slave("four_bar").start({"rates": 3}) for _ in range(2))
    h = 0.05
    for k in range(20):
        angles = [1.0 + 3.0 * (k + part) * h for part in (0.0, 0.5)]
        before = states(careful)
        careful.set({"crank_angle.position": angles[0] + 0.7})
        careful.fmi.doStep(k * h, h)
        careful.fmi.setFMUstate(before)
        for instance in (careful, straight):
            for half, angle in enumerate(angles):
                instance.set({"crank_angle.position": angle})
                instance.fmi.doStep((k + 0.5 * half) * h, 0.5 * h)
        assert careful.outputs() == straight.outputs()


def test_back_from_a_discarded_step(slave, states):
    """After a dead point the host goes on from before it, as if it had never tried."""
    form = Tlv()
    instance, straight = slave("tlv").start({"rates": 2}), slave("tlv").start({"rates": 2})
    for each in (instance, straight):
        each.set({"side_length.position": 0.6})
        each.step(0.1)
    before = states(instance)

    instance.set({"side_length.position": 0.7})
    with pytest.raises(FMICallException) as failed:
        instance.step(0.1)
    assert failed.value.status == DISCARD
    assert instance.fmi.getBooleanStatus(fmi2Terminated) is True
    stuck = states(instance)
    at_failure = instance.outputs()

    instance.fmi.setFMUstate(before)
    assert instance.fmi.getBooleanStatus(fmi2Terminated) is False
    assert instance.fmi.getRealStatus(fmi2LastSuccessfulTime) == 0.1
    for length in (0.64, 0.5, 0.4):
        for each in (instance, straight):
            each.set({"side_length.position": length, "side_length.velocity": -1.0})
            each.step(0.1)
        assert instance.outputs() == straight.outputs()
        assert instance.get_one("arm.phi") == pytest.approx(
            form.motion(length)["arm.phi"].item(), rel=1e-12
        )

    # The failed state can be gone back to as well; nothing but reading is possible there.
    instance.fmi.setFMUstate(stuck)
    assert instance.outputs() == at_failure
    with pytest.raises(FMICallException) as refused:
        instance.fmi.doStep(0.1, 0.1)
    assert refused.value.status == ERROR
    assert len(instance.messages.texts(WARNING)) == 1, "the one of the dead point"


def test_back_from_a_failed_initialization(slave, states):
    instance = slave("tlv")
    fresh = states(instance)
    with pytest.raises(FMICallException):
        instance.start({"arm_length": 0.9})
    instance.fmi.setFMUstate(fresh)
    assert instance.start().outputs() == slave("tlv").start().outputs()
    instance.step(0.1)


# ---------------------------------------------------------------------------------------------
# States that are none


@pytest.fixture
def written(slave, states):
    """An instance in the middle of a run, and its state as bytes."""
    instance = slave("four_bar").start()
    drive(instance, "four_bar", range(5))
    return instance, instance.fmi.serializeFMUstate(states(instance))


def refused(instance: Slave, data: bytes) -> str:
    """The reason to refuse a serialized state, which has left no trace."""
    before = instance.outputs()
    said = len(instance.messages)
    with pytest.raises(FMICallException) as failed:
        instance.fmi.deSerializeFMUstate(data)
    assert failed.value.status == ERROR
    assert instance.outputs() == before
    (message,) = instance.messages[said:]
    assert message.status == ERROR
    return message.text


def test_truncated(written):
    instance, data = written
    for length in (len(data) - 1, len(data) // 2, 62, 21, 20):
        assert f"{len(data)} bytes" in refused(instance, data[:length])
    for length in (19, 8, 1):
        assert "no serialized FMU state" in refused(instance, data[:length])
    assert f"{len(data) + 1} now" in refused(instance, data + b"\0")


def test_altered(written):
    """A flipped bit anywhere behind version and length is seen by the checksum."""
    instance, data = written
    generator = np.random.default_rng(20261121)
    for bit in generator.integers(8 * 20, 8 * len(data), size=200):
        altered = bytearray(data)
        altered[bit // 8] ^= 1 << bit % 8
        assert "altered" in refused(instance, bytes(altered))
    # And those before are told by what they say.
    for at, why in [(0, "no serialized"), (8, "version"), (12, "bytes long when it was written")]:
        altered = bytearray(data)
        altered[at] ^= 1
        assert why in refused(instance, bytes(altered))


@pytest.mark.parametrize("size", [1, 8, 100, 5000])
def test_foreign(written, size):
    instance, data = written
    noise = np.random.default_rng(size).bytes(size)
    assert "no serialized FMU state" in refused(instance, noise)
    assert refused(instance, data[:12] + noise)


def test_of_another_mechanism(slave, written):
    instance, data = written
    other = slave("tlv").start()
    reason = refused(other, data)
    for each in (instance, other):
        assert each.fmi.guid in reason


def test_null_is_no_state(slave):
    instance = slave("four_bar").start()
    with pytest.raises(FMICallException) as failed:
        instance.fmi.setFMUstate(None)
    assert failed.value.status == ERROR
    instance.fmi.freeFMUstate(fmi2FMUstate())
    instance.step(0.1)


# ---------------------------------------------------------------------------------------------
# Derivatives of outputs


def derivative(instance: Slave, name: str, order: int) -> float:
    references = [instance.variables[name].valueReference]
    return instance.fmi.getRealOutputDerivatives(references, [order])[0]


def test_output_derivatives(slave):
    """Positions have two, velocities one: exact, whatever the steps."""
    form = FourBar()
    instance = slave("four_bar").start({"rates": 2})
    angle, velocity, acceleration = 1.3, 2.0, -5.0
    instance.set(
        {
            "crank_angle.position": angle,
            "crank_angle.velocity": velocity,
            "crank_angle.acceleration": acceleration,
        }
    )
    instance.step(0.1)
    motion = form.motion(angle, velocity, acceleration)
    expected = {name: value.item() for name, value in motion.items()}
    for name, order, same in [
        ("rocker.phi", 1, "rocker.omega"),
        ("rocker.phi", 2, "rocker.alpha"),
        ("rocker.omega", 1, "rocker.alpha"),
        ("coupler.x", 1, "coupler.vx"),
        ("coupler.vy", 1, "coupler.ay"),
    ]:
        found = derivative(instance, name, order)
        assert found == instance.get_one(same)
        assert found == pytest.approx(expected[same], rel=RATE_LIMIT)


@pytest.mark.parametrize(
    ("name", "order"), [("rocker.alpha", 1), ("rocker.alpha", 2), ("rocker.omega", 2)]
)
def test_output_derivatives_beyond_the_known_ones_are_zero(slave, name, order):
    """If the actual order is lower ..., the retrieved value is 0 (4.2.1)."""
    instance = slave("four_bar").start({"crank_angle.velocity": 2.0})
    instance.step(0.1)
    assert derivative(instance, name, order) == 0.0


@pytest.mark.parametrize(
    ("name", "order"), [("crank_angle.position", 1), ("rocker.phi", 0), ("rocker.phi", 3)]
)
def test_output_derivatives_that_make_no_sense(slave, name, order):
    instance = slave("four_bar").start()
    with pytest.raises(FMICallException) as failed:
        derivative(instance, name, order)
    assert failed.value.status == ERROR
    assert any(name in text for text in instance.messages.texts(ERROR))
