"""Directional derivatives through FMPy, against differences, of every shipped mechanism."""

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from harness import ERROR, SHIPPED, Slave

STEP = 1e-5
"""A quarter of the way over which differences of fourth order are taken, in units of the known.
Of lengths of a centimetre it is a thousandth, the fourth power of which is their truncation."""

DIFFERENCE = 1e-6
"""Error of a derivative by differences, relative to the largest of the same unit."""


def derivatives(slave: Slave, unknowns, known) -> np.ndarray:
    """Those of the unknowns by one known."""
    references = [slave.variables[name].valueReference for name in (*unknowns, known)]
    found = slave.fmi.getDirectionalDerivative(references[:-1], references[-1:], [1.0])
    return np.array(list(found))


def differences(slave: Slave, unknowns, known) -> np.ndarray:
    """The same by differences; the known is left as it was."""
    value = slave.get_one(known)

    def moved(by):
        slave.set({known: value + by})
        return np.array(slave.get(*unknowns))

    near = moved(STEP) - moved(-STEP)
    far = moved(2 * STEP) - moved(-2 * STEP)
    moved(0.0)
    return (8 * near - far) / (12 * STEP)


def assert_derivatives_agree(slave: Slave, knowns) -> None:
    unknowns = [n for n, v in slave.variables.items() if v.causality == "output"]
    # Positions, velocities and accelerations by their units.
    units = np.array([slave.variables[name].unit for name in unknowns])
    for known in knowns:
        exact = derivatives(slave, unknowns, known)
        error = np.abs(exact - differences(slave, unknowns, known))
        for unit in set(units):
            largest = max(1.0, np.abs(exact[units == unit]).max())
            assert error[units == unit].max() <= DIFFERENCE * largest, (known, unit)


def inputs(slave: Slave) -> list[str]:
    return [name for name, variable in slave.variables.items() if variable.causality == "input"]


def moving_inputs(slave: Slave) -> dict[str, float]:
    """Value, velocity and acceleration of each input, and that they are to be taken as given."""
    values = {}
    for name in inputs(slave):
        start = float(slave.variables[name].start)
        thing, _, order = name.rpartition(".")
        moving = {"position": start + 0.003, "velocity": 0.7, "acceleration": -0.4}
        # Others are forces, or inputs of the file.
        values[name] = moving.get(order, 2.0 if thing else start + 0.003)
    return values | ({"rates": 2} if "rates" in slave.variables else {})


@pytest.mark.parametrize("name", SHIPPED)
def test_by_inputs_and_parameters_in_initialization_mode(slave, name):
    instance = slave(name)
    # Between the points of every table.
    instance.setup(start_time=0.317)
    instance.set(moving_inputs(instance))
    instance.fmi.enterInitializationMode()
    parameters = [
        name
        for name, variable in instance.variables.items()
        if variable.causality == "parameter" and variable.type == "Real"
    ]
    assert_derivatives_agree(instance, inputs(instance) + parameters)


@pytest.mark.parametrize("name", SHIPPED)
def test_by_inputs_between_steps(slave, name):
    """Outputs read after an input was set without a step belong to the input: an extension."""
    instance = slave(name)
    instance.start(moving_inputs(instance))
    instance.step(0.017)
    assert_derivatives_agree(instance, inputs(instance))


def test_what_is_no_known_or_no_unknown_is_refused(slave):
    instance = slave("four_bar").start()
    for unknown, known in [
        ("rocker.phi", "rocker_length"),
        ("rocker.phi", "rocker.phi"),
        ("rocker_length", "crank_angle.position"),
        ("solver.rcond", "crank_angle.position"),
    ]:
        with pytest.raises(FMICallException) as refused:
            derivatives(instance, [unknown], known)
        assert refused.value.status == ERROR
        assert "derivatives are taken" in instance.messages[-1].text
