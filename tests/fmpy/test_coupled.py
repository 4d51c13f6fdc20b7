"""Two FMUs in a master that is not ours: FMPy's simulation of SSP systems.

The rocker of a four-bar drives a slider–crank; `rocker_and_slider` is the same as one mechanism.
"""

import zipfile

import numpy as np
import pytest
from fmpy.ssp.simulation import simulate_ssp
from harness import simulate

CONNECTIONS = {"phi": "position", "omega": "velocity", "alpha": "acceleration"}
"""Connections from the rocker's coordinate and rates to the inputs of the arm's driver."""

OUTPUTS = ["slider.x", "slider.vx", "slider.ax"]


def system(connections: dict[str, str]) -> str:
    """The SystemStructure.ssd of the two."""

    def connector(name, kind):
        return f'<ssd:Connector name="{name}" kind="{kind}"><ssc:Real/></ssd:Connector>'

    def component(name, source, connectors):
        return (
            f'<ssd:Component name="{name}" source="resources/{source}.fmu">'
            f"<ssd:Connectors>{''.join(connectors)}</ssd:Connectors></ssd:Component>"
        )

    drive = component(
        "drive", "rocker_drive", [connector(f"rocker.{c}", "output") for c in connections]
    )
    driven = component(
        "driven",
        "driven_slider",
        [connector(f"arm_angle.{i}", "input") for i in connections.values()]
        + [connector(name, "output") for name in OUTPUTS],
    )
    wires = "".join(
        f'<ssd:Connection startElement="drive" startConnector="rocker.{output}"'
        f' endElement="driven" endConnector="arm_angle.{into}"/>'
        for output, into in connections.items()
    )
    return (
        '<?xml version="1.0" encoding="UTF-8"?>'
        '<ssd:SystemStructureDescription name="pair" version="1.0"'
        ' xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"'
        ' xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription">'
        f'<ssd:System name="pair"><ssd:Elements>{drive}{driven}</ssd:Elements>'
        f"<ssd:Connections>{wires}</ssd:Connections></ssd:System>"
        "</ssd:SystemStructureDescription>"
    )


@pytest.fixture
def coupled(fmu, tmp_path):
    """`coupled(steps, connections)`: the outputs after each of so many steps to 1 s."""

    def run(steps, connections):
        path = tmp_path / f"{steps}.ssp"
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("SystemStructure.ssd", system(connections))
            for name in ("rocker_drive", "driven_slider"):
                archive.write(fmu(name).path, f"resources/{name}.fmu")
        rows = simulate_ssp(str(path), stop_time=1.0, step_size=1 / steps)
        return {name: rows[f"driven.{name}"][:steps] for name in OUTPUTS}

    return run


@pytest.fixture
def as_one(fmu):
    """`as_one(steps)`: the same outputs of the one mechanism."""

    def run(steps):
        rows = simulate(
            fmu("rocker_and_slider"),
            fmi_type="CoSimulation",
            stop_time=1.0,
            step_size=1 / steps,
            output_interval=1 / steps,
        )
        return {name: rows[name][1:] for name in OUTPUTS}

    return run


def test_shifted_by_the_lag_of_one_step_they_agree_to_rounding(coupled, as_one):
    steps = 64
    pair, one = coupled(steps, CONNECTIONS), as_one(steps)
    for name in OUTPUTS:
        # The first step is taken before the rocker was heard of.
        error = np.abs(pair[name][1:] - one[name][:-1]).max()
        # Rounding of lengths up to 0.25 m and of rates up to a few per second.
        assert error < 1e-14, (name, error)


def test_as_they_come_they_agree_to_first_order(coupled, as_one):
    def error(steps, name):
        pair, one = coupled(steps, CONNECTIONS), as_one(steps)
        return np.abs(pair[name][1:] - one[name][1:]).max()

    for name in OUTPUTS:
        coarse, fine = error(64, name), error(128, name)
        # The next term is a part of the step's size.
        assert 1.9 < coarse / fine < 2.1, (name, coarse, fine)


def test_with_the_angle_alone_rates_are_estimated(coupled, as_one):
    """Velocities to second order, accelerations to first, once three angles were seen."""
    pair = {steps: coupled(steps, {"phi": "position"}) for steps in (64, 128)}
    for name, order in [("slider.x", None), ("slider.vx", 2), ("slider.ax", 1)]:
        errors = [
            np.abs(pair[steps][name][4:] - as_one(steps)[name][3:-1]).max() for steps in (64, 128)
        ]
        if order is None:
            assert max(errors) < 1e-14, errors
        else:
            assert 0.9 * 2**order < errors[0] / errors[1] < 1.1 * 2**order, (name, errors)
