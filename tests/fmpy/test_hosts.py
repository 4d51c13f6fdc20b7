"""Hosts besides FMPy: every shipped FMU in each of them, against what FMPy gets."""

import ctypes
import platform
import sys
from pathlib import Path

import numpy as np
import pytest
from harness import SHIPPED, state_outputs

STEP = 0.01
STEPS = 10


@pytest.fixture
def expected(slave):
    """`expected(name)`: the outputs that FMPy gets after some steps."""

    def run(name):
        instance = slave(name).start()
        for _ in range(STEPS):
            instance.step(STEP)
        return instance.outputs()

    return run


# ---------------------------------------------------------------------------------------------
# fmuloader: a thin layer of ctypes, which binds every function of the standard; needs Python 3.11


def fmuloader():
    return pytest.importorskip("fmuloader.fmi2")


@pytest.fixture
def loaded(fmu):
    """`loaded(name, kind)`: an initialized instance in fmuloader."""
    open_ones = []

    def get(name, kind):
        description = fmu(name).description
        instance = fmuloader().Fmi2Slave(fmu(name).path, model_identifier=description.modelIdentifier)
        open_ones.append(instance)
        # The FMU declares that it does without the host's memory functions.
        instance.instantiate(
            "loaded",
            fmuloader().Fmi2Type[kind],
            guid=description.guid,
            cannot_use_memory_management_functions=True,
        )
        instance.setup_experiment(start_time=0.0)
        instance.enter_initialization_mode()
        instance.exit_initialization_mode()
        return instance

    yield get
    for instance in open_ones:
        instance.terminate()
        instance.free_instance()


def outputs(fmu, get) -> dict[str, float]:
    """Returns all outputs by name; `get` is the host's getter of real numbers."""
    names = fmu.names("output")
    references = [fmu.variables[name].valueReference for name in names]
    return dict(zip(names, get(references), strict=True))


@pytest.mark.parametrize("name", SHIPPED)
def test_fmuloader_steps_to_the_same_bits(fmu, loaded, expected, name):
    instance = loaded(name, "CO_SIMULATION")
    time = 0.0
    for _ in range(STEPS):
        instance.do_step(time, STEP)
        time += STEP
    assert outputs(fmu(name), instance.get_real) == expected(name)
    state = instance.get_fmu_state()
    written = instance.serialize_fmu_state(state)
    instance.free_fmu_state(state)
    instance.do_step(time, STEP)
    state = instance.deserialize_fmu_state(written)
    instance.set_fmu_state(state)
    instance.free_fmu_state(state)
    assert outputs(fmu(name), instance.get_real) == expected(name)


@pytest.mark.parametrize("name", SHIPPED)
def test_fmuloader_exchanges_the_model(fmu, loaded, expected, name):
    instance = loaded(name, "MODEL_EXCHANGE")
    assert not instance.new_discrete_states().newDiscreteStatesNeeded
    instance.enter_continuous_time_mode()
    states = state_outputs(fmu(name).description)
    starts = [float(fmu(name).variables[state].start) for state in states]
    assert instance.get_continuous_states(len(states)) == starts
    assert instance.get_derivatives(len(states))[::2] == starts[1::2]
    instance.set_time(STEP * STEPS)
    if states:
        instance.set_continuous_states([expected(name)[state] for state in states])
    found = outputs(fmu(name), instance.get_real)
    instance.completed_integrator_step()
    for output, value in expected(name).items():
        # One way instead of ten steps: to some ulp, carried along by rates of up to some hundred.
        assert found[output] == pytest.approx(value, rel=1e-9, abs=1e-9), output


@pytest.fixture
def loaded3(fmu3):
    """`loaded3(name)`: an FMI 3.0 instance in fmuloader that is not instantiated yet."""
    open_ones = []

    def get(name):
        host = pytest.importorskip("fmuloader.fmi3")
        description = fmu3(name).description
        identifier = description.coSimulation.modelIdentifier
        open_ones.append(host.Fmi3Slave(fmu3(name).path, model_identifier=identifier))
        return open_ones[-1]

    yield get
    for instance in open_ones:
        instance.terminate()
        instance.free_instance()


@pytest.mark.parametrize("name", SHIPPED)
def test_fmuloader_steps_fmi_3_to_the_same_bits(fmu3, loaded3, expected, name):
    instance = loaded3(name)
    token = fmu3(name).description.instantiationToken
    instance.instantiate_co_simulation(name, instantiation_token=token, event_mode_used=True)
    instance.enter_initialization_mode()
    instance.exit_initialization_mode()
    assert not instance.update_discrete_states().discrete_states_need_update
    instance.enter_step_mode()
    time = 0.0
    for step in range(STEPS):
        if step == STEPS - 1:
            state = instance.get_fmu_state()
            written = instance.serialize_fmu_state(state)
            instance.free_fmu_state(state)
        result = instance.do_step(time, STEP)
        assert not (result.event_handling_needed or result.terminate_simulation)
        assert not result.early_return
        time += STEP
        assert result.last_successful_time == time
    assert outputs(fmu3(name), instance.get_float64) == expected(name)
    state = instance.deserialize_fmu_state(written)
    instance.set_fmu_state(state)
    instance.free_fmu_state(state)
    instance.do_step(time - STEP, STEP)
    assert outputs(fmu3(name), instance.get_float64) == expected(name)


@pytest.mark.parametrize("name", SHIPPED)
def test_fmuloader_exchanges_the_fmi_3_model(fmu, fmu3, loaded3, expected, name):
    instance = loaded3(name)
    token = fmu3(name).description.instantiationToken
    instance.instantiate_model_exchange(name, instantiation_token=token)
    instance.enter_initialization_mode()
    instance.exit_initialization_mode()
    assert not instance.update_discrete_states().discrete_states_need_update
    instance.enter_continuous_time_mode()
    states = state_outputs(fmu(name).description)
    starts = [float(fmu(name).variables[state].start) for state in states]
    assert instance.get_continuous_states(len(states)) == starts
    assert instance.get_continuous_state_derivatives(len(states))[::2] == starts[1::2]
    instance.set_time(STEP * STEPS)
    if states:
        instance.set_continuous_states([expected(name)[state] for state in states])
    found = outputs(fmu3(name), instance.get_float64)
    assert instance.completed_integrator_step() == (False, False)
    for output, value in expected(name).items():
        # One way instead of ten steps, as in FMI 2.0.
        assert found[output] == pytest.approx(value, rel=1e-9, abs=1e-9), output


# ---------------------------------------------------------------------------------------------
# Ecos: an engine in C++


def ecos():
    """Ecos, where it runs; its wheel brings programs for Windows and Linux on x86-64."""
    if platform.machine().lower() not in ("x86_64", "amd64") or sys.platform == "darwin":
        pytest.skip("there is no Ecos for this platform")
    if sys.platform == "linux":
        # It links to a library of another wheel, which it does not look for.
        library = Path(sys.prefix) / "lib" / "libtbb.so.12"
        ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL)
    import ecospy

    return ecospy


@pytest.mark.parametrize("name", SHIPPED)
def test_ecos_steps_to_the_same_bits(fmu, expected, name):
    ecos()
    from ecospy.EcosSimulation import EcosSimulation
    from ecospy.EcosSimulationStructure import EcosSimulationStructure

    with EcosSimulationStructure() as structure:
        structure.add_model("it", str(fmu(name).path))
        with EcosSimulation(STEP, structure=structure) as simulation:
            assert simulation.init()
            simulation.step(STEPS)
            found = {v: simulation.get_real(f"it::{v}") for v in fmu(name).names("output")}
            simulation.terminate()
    for output, value in expected(name).items():
        # It keeps its own time, which may be off by an ulp.
        assert found[output] == pytest.approx(value, rel=1e-12, abs=1e-12), output
    assert np.all(np.isfinite(list(found.values())))
