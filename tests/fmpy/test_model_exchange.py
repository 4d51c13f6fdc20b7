"""Model exchange: the same FMU for hosts that integrate, without a communication step."""

import fmpy
import numpy as np
import pytest
from closed_form import CLOSED_FORMS
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Model
from harness import (
    DISCARD,
    ERROR,
    SHIPPED,
    WARNING,
    Fmu,
    Messages,
    Slave,
    assert_accurate,
    signals,
    simulate,
    state_names,
)
from motions import full_motion


class Exchanged(Slave):
    """One instance for model exchange, in continuous-time mode after `start`."""

    def __init__(self, fmu: Fmu):
        self.variables = fmu.variables
        self.messages = Messages()
        self.fmi = FMU2Model(
            guid=fmu.description.guid,
            modelIdentifier=fmu.description.modelIdentifier,
            unzipDirectory=str(fmu.folder),
            instanceName=f"{fmu.name} under test",
        )
        self.fmi.instantiate(callbacks=self.messages.callbacks)

    def start(self, values=None, **experiment):
        super().start(values, **experiment)
        self.fmi.newDiscreteStates()
        self.fmi.enterContinuousTimeMode()
        return self

    def at(self, time: float, values: dict[str, float]) -> dict[str, float]:
        """All outputs at a time with these inputs."""
        self.fmi.setTime(time)
        self.set(values)
        return self.outputs()

    def accept(self) -> None:
        """The host's step ends here."""
        assert self.fmi.completedIntegratorStep() == (0, 0)


@pytest.fixture
def exchanged(fmu):
    instances = []

    def get(name):
        instances.append(Exchanged(fmu(name)))
        return instances[-1]

    yield get
    for instance in instances:
        instance.fmi.freeInstance()


@pytest.mark.parametrize("solver", ["Euler", "CVode"])
@pytest.mark.parametrize("name", sorted(CLOSED_FORMS))
def test_outputs_belong_to_the_time_of_their_inputs(fmu, name, solver):
    """Without the lag of a communication step, for FMPy's solvers of either kind."""
    mechanism = CLOSED_FORMS[name]()
    time = np.linspace(0, 1, 61)
    motion = full_motion(name, time)
    result = simulate(
        fmu(name),
        fmi_type="ModelExchange",
        solver=solver,
        input=signals(mechanism.driver, time, *motion),
        start_values={f"{mechanism.driver}.position": motion[0][0]},
        stop_time=1.0,
        step_size=1 / 60,
        output_interval=1 / 60,
    )
    assert len(result) == 61
    rows = slice(1, None)
    assert_accurate(
        {column: result[column][rows] for column in result.dtype.names},
        {k: v[rows] for k, v in mechanism.motion(*motion).items() if k in result.dtype.names},
    )


@pytest.mark.parametrize("name", SHIPPED)
def test_every_shipped_mechanism_runs_as_either(fmu, name):
    """Prescribed motions and inputs at their starts: both interfaces give the same."""
    # A motion without a load may run away after its own stop time.
    stop = min(0.2, float(fmu(name).description.defaultExperiment.stopTime))
    options = {"stop_time": stop, "output_interval": stop / 10, "step_size": stop / 10}
    options["relative_tolerance"] = 1e-11
    both = [
        simulate(fmu(name), fmi_type=kind, **options) for kind in ("ModelExchange", "CoSimulation")
    ]
    # A host that integrates adds a row on either side of an event.
    grid = both[1]["time"]
    last = np.searchsorted(both[0]["time"], grid * (1 + 1e-12), side="right") - 1
    both[0] = both[0][last]
    assert len(grid) == 11
    np.testing.assert_allclose(both[0]["time"], grid, rtol=1e-12)
    # Of free motion the host integrates one, as exactly as its solver can from step to step.
    is_free = bool(state_names(fmu(name).description))
    tolerance = 1e-6 if is_free else 1e-9
    for column in both[0].dtype.names:
        # Two ways to the same pose, each to some ulp of the largest coordinate, which rates of
        # up to some hundred carry along.
        found, wanted = both[0][column], both[1][column]
        size = max(1.0, np.abs(wanted).max()) if is_free else 1.0
        np.testing.assert_allclose(found, wanted, rtol=tolerance, atol=tolerance * size)


@pytest.mark.parametrize("version", [2, 3])
def test_cvode_flies_through_exchanges_of_states(fmu, fmu3, version):
    """No link turns fully: the coordinates in use change near their dead points."""
    exported = {2: fmu, 3: fmu3}[version]("triple_rocker")
    assert state_names(exported.description) == ["state[1]", "state[2]"]
    own = ["swing.position", "swing.velocity"]
    energy = ["energy.kinetic", "energy.potential"]
    options = {"stop_time": 2.0, "output_interval": 0.01, "step_size": 0.01}
    options["output"] = [*own, *energy, "state[1]"]
    itself = simulate(exported, fmi_type="CoSimulation", relative_tolerance=1e-10, **options)
    total = sum(itself[name] for name in energy)
    np.testing.assert_allclose(total, total[0], rtol=1e-9)

    def hosted(tolerance):
        result = simulate(
            exported, fmi_type="ModelExchange", relative_tolerance=tolerance, **options
        )
        is_own = np.abs(result["state[1]"] - result["swing.position"]) < 1e-12
        assert np.count_nonzero(np.diff(is_own)) > 5, "the coordinates are exchanged"
        # FMPy records events too: its last sample at a time is the one after them.
        times, last = np.unique(result["time"][::-1], return_index=True)
        rows = result[::-1][last][np.isin(times, itself["time"])]
        np.testing.assert_array_equal(rows["time"], itself["time"])
        return max(np.abs(rows[column] - itself[column]).max() for column in own)

    # CVode holds the error of each step, and thousands of them add up: it converges.
    assert hosted(1e-10) < 0.1 * hosted(1e-8) < 0.1


def test_evaluation_order_does_not_matter(exchanged):
    """Everything is evaluated from what was accepted last, to the last bit."""
    points = {t: {"crank_angle.position": 1.0 + 6 * t} for t in (0.1, 0.5, 0.25, 0.1, 0.4)}
    forth, back = exchanged("four_bar").start(), exchanged("four_bar").start()
    ways = [
        {t: instance.at(t, points[t]) for t in order}
        for instance, order in [(forth, sorted(points)), (back, sorted(points, reverse=True))]
    ]
    assert ways[0] == ways[1]


def test_turns_are_counted_from_what_was_accepted(exchanged):
    """A jump is followed from the accepted pose; a trial that is not accepted leaves nothing."""
    instance = exchanged("four_bar").start()
    tried = instance.at(0.1, {"crank_angle.position": 30.0})
    assert tried["crank.phi"] == pytest.approx(30.0)
    again = instance.at(0.1, {"crank_angle.position": 1.5})
    fresh = exchanged("four_bar").start().at(0.1, {"crank_angle.position": 1.5})
    assert again == fresh
    instance.accept()
    instance.fmi.enterEventMode()
    instance.fmi.newDiscreteStates()
    instance.set({"rocker_length": 0.31})
    longer = instance.outputs()
    assert longer["rocker.phi"] != again["rocker.phi"]
    assert longer["rocker.omega"] == 0.0, "parameters contribute nothing to velocities"


def test_a_dead_point_in_a_getter_is_discarded(exchanged):
    """The triangle of sides 0.4 and 0.25 m closes up to a side of 0.65 m."""
    instance = exchanged("tlv").start()
    before = instance.at(0.1, {"side_length.position": 0.6})
    instance.fmi.setTime(0.2)
    instance.set({"side_length.position": 0.7})
    with pytest.raises(FMICallException) as discarded:
        instance.outputs()
    assert discarded.value.status == DISCARD
    assert "cannot go beyond 0.65" in instance.messages.texts(WARNING)[-1]
    assert instance.at(0.1, {"side_length.position": 0.6}) == before


def test_rates_are_the_inputs_and_are_not_estimated(exchanged):
    instance = exchanged("pendulum").start()
    moving = {"swing_angle.position": 0.5, "swing_angle.velocity": 2.0}
    assert instance.at(0.1, moving)["rod.omega"] == 2.0
    refused = exchanged("pendulum")
    refused.setup()
    refused.set({"rates": 3})
    refused.fmi.enterInitializationMode()
    with pytest.raises(FMICallException) as error:
        refused.fmi.exitInitializationMode()
    assert error.value.status == ERROR
    assert "`rates` is `estimated`" in refused.messages.texts(ERROR)[-1]


def test_a_state_is_got_and_set(exchanged):
    instance = exchanged("four_bar").start()
    instance.at(0.1, {"crank_angle.position": 1.4, "crank_angle.velocity": 1.0})
    instance.accept()
    state = instance.fmi.getFMUstate()
    there = instance.outputs()
    instance.at(0.7, {"crank_angle.position": 5.0})
    instance.accept()
    instance.fmi.setFMUstate(state)
    assert instance.outputs() == there
    instance.fmi.freeFMUstate(state)


def test_validation_finds_nothing(fmu):
    for name in SHIPPED:
        assert fmpy.validation.validate_fmu(str(fmu(name).path)) == [], name
