"""FMI 3.0 in FMPy: valid, and the same numbers as FMI 2.0 to the last bit."""

from __future__ import annotations

from ctypes import byref, c_int, c_size_t, c_uint32
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu
from harness import SHIPPED, Fmu, mechanism_file, run_biela, simulate
from lxml import etree

STEPS = 40
"""Communication steps of each run."""


def run(fmu: Fmu, interface: str, **options) -> np.ndarray:
    """All outputs of a run over a part of the default experiment."""
    experiment = fmu.description.defaultExperiment
    start = float(experiment.startTime)
    interval = float(experiment.stepSize)
    return simulate(
        fmu,
        fmi_type=interface,
        start_time=start,
        stop_time=start + STEPS * interval,
        output_interval=interval,
        input=inputs(fmu, start, interval),
        **options,
    )


def inputs(fmu: Fmu, start: float, interval: float) -> np.ndarray:
    """Every driver moves by a little from its start value, its rates wired."""
    time = start + interval * np.arange(STEPS + 1)
    columns = {"time": time}
    for name in fmu.names("input"):
        driver, _, order = name.rpartition(".")
        if order != "position":
            continue
        value = float(fmu.variables[name].start)
        swing, rate = 0.002 * max(abs(value), 0.1), 2.0
        phase = rate * (time - start)
        columns[name] = value + swing * np.sin(phase)
        columns[f"{driver}.velocity"] = swing * rate * np.cos(phase)
        columns[f"{driver}.acceleration"] = -swing * rate**2 * np.sin(phase)
    table = np.empty(len(time), dtype=[(name, float) for name in columns])
    for name, column in columns.items():
        table[name] = column
    return table


@pytest.mark.parametrize("name", SHIPPED)
def test_the_fmu_is_valid(fmu3, name):
    assert validate_fmu(str(fmu3(name).path)) == []


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("name", ["cam_points", "four_bar", "rack_drive", "slider_crank_motor", "tlv"])
def test_terminals_are_valid_and_name_variables(fmu, fmu3, tmp_path, name, version):
    """One terminal per driver, per marker among the outputs and per force that is an input, in FMI 2.0
    if they are wanted."""
    if version == 3:
        exported = fmu3(name)
    else:
        assert not (fmu(name).folder / "terminalsAndIcons").exists()
        path = tmp_path / "with_terminals.fmu"
        done = run_biela("export", mechanism_file(name), "--terminals", "-o", path)
        assert done.returncode == 0, done.stderr
        exported = Fmu.unpack(path, tmp_path / "unpacked")
    folder = exported.folder / "terminalsAndIcons"
    assert (folder / "icon.png").read_bytes().startswith(b"\x89PNG")
    schema = Path(fmpy.__file__).parent / "schema" / "fmi3" / "fmi3TerminalsAndIcons.xsd"
    document = etree.parse(folder / "terminalsAndIcons.xml")
    etree.XMLSchema(file=schema).assertValid(document)
    names = [terminal.get("name") for terminal in document.iter("Terminal")]
    assert len(names) == len(set(names)) > 0
    for terminal in document.iter("Terminal"):
        members = list(terminal)
        assert members, terminal.get("name")
        for member in members:
            variable = exported.variables[member.get("variableName")]
            assert variable.causality in ("input", "output")
            expected = f"{terminal.get('name')}.{member.get('memberName')}"
            assert variable.name == expected
    if name == "slider_crank_motor":
        (member,) = next(t for t in document.iter("Terminal") if t.get("name") == "motor")
        assert (member.get("variableName"), member.get("variableKind")) == ("motor.effort", "inflow")


@pytest.mark.parametrize("name", SHIPPED)
def test_names_and_value_references_are_those_of_fmi_2(fmu, fmu3, name):
    def table(fmu):
        return [
            (v.name, v.valueReference, v.causality, v.start, v.unit)
            for v in fmu.description.modelVariables
        ]

    assert table(fmu3(name)) == table(fmu(name))


@pytest.mark.parametrize("interface", ["CoSimulation", "ModelExchange"])
@pytest.mark.parametrize("name", SHIPPED)
def test_a_run_has_the_bits_of_fmi_2(fmu, fmu3, name, interface):
    expected = run(fmu(name), interface)
    found = run(fmu3(name), interface)
    assert found.dtype == expected.dtype
    for column in expected.dtype.names:
        np.testing.assert_array_equal(found[column], expected[column], err_msg=column)


def test_event_mode_and_early_return_do_not_change_a_run(fmu, fmu3):
    expected = run(fmu("four_bar"), "CoSimulation")
    found = run(fmu3("four_bar"), "CoSimulation", use_event_mode=True, early_return_allowed=True)
    for column in expected.dtype.names:
        np.testing.assert_array_equal(found[column], expected[column], err_msg=column)


class Slave3:
    """One FMI 3.0 co-simulation instance, with names in place of value references."""

    def __init__(self, fmu: Fmu, **options):
        self.references = {name: v.valueReference for name, v in fmu.variables.items()}
        self.fmi = FMU3Slave(
            guid=fmu.description.guid,
            modelIdentifier=fmu.description.modelIdentifier,
            unzipDirectory=str(fmu.folder),
            instanceName="instance",
        )
        self.messages = []
        self.fmi.instantiate(
            loggingOn=True,
            logMessage=lambda _, status, category, message: self.messages.append(message),
            **options,
        )

    def set(self, **values: float) -> None:
        names = [name.replace("__", ".") for name in values]
        self.fmi.setFloat64([self.references[n] for n in names], list(values.values()))

    def get(self, *names: str) -> list[float]:
        return self.fmi.getFloat64([self.references[name] for name in names])


@pytest.fixture
def slave3(fmu3):
    instances = []

    def get(name: str, **options) -> Slave3:
        instances.append(Slave3(fmu3(name), **options))
        return instances[-1]

    yield get
    for instance in instances:
        instance.fmi.freeInstance()


def test_states_go_through_bytes(slave3):
    slave = slave3("four_bar")
    slave.fmi.enterInitializationMode()
    slave.fmi.exitInitializationMode()
    slave.set(crank_angle__position=1.2)
    slave.fmi.doStep(0.0, 0.1)
    state = slave.fmi.getFMUState()
    saved = slave.fmi.serializeFMUState(state)
    slave.set(crank_angle__position=1.3)
    slave.fmi.doStep(0.1, 0.1)
    expected = slave.get("rocker.phi", "rocker.omega")
    slave.fmi.setFMUState(slave.fmi.deserializeFMUState(saved))
    slave.fmi.freeFMUState(state)
    slave.set(crank_angle__position=1.3)
    slave.fmi.doStep(0.1, 0.1)
    assert slave.get("rocker.phi", "rocker.omega") == expected


def test_derivatives_and_dependencies(slave3, fmu3):
    slave = slave3("four_bar")
    slave.fmi.enterInitializationMode()
    slave.fmi.exitInitializationMode()
    slave.fmi.doStep(0.0, 0.1)
    knowns = [slave.references[n] for n in ("crank_angle.position", "crank_length", "base")]
    unknowns = [slave.references[n] for n in ("rocker.phi", "coupler.x")]
    u, v = [0.3, -0.2, 0.7], [1.1, -0.4]
    forward = slave.fmi.getDirectionalDerivative(unknowns, knowns, u)
    # FMPy 0.3.32 takes one value per unknown if nothing is said.
    backward = slave.fmi.getAdjointDerivative(unknowns, knowns, v, nSensitivity=len(knowns))
    assert np.dot(forward, v) == pytest.approx(np.dot(backward, u), rel=1e-14)

    declared = {o.variable.name: o for o in fmu3("four_bar").description.outputs}
    for name in ("rocker.phi", "crank.x"):
        expected = [v.valueReference for v in declared[name].dependencies]
        assert sorted(dependencies(slave, name)) == sorted(expected)


def dependencies(slave: Slave3, name: str) -> list[int]:
    """Value references that a variable depends on, by the C functions: those of FMPy 0.3.32 that
    wrap them fail before the call."""
    reference, fmi = slave.references[name], slave.fmi
    count = c_size_t()
    fmi.fmi3GetNumberOfVariableDependencies(fmi.component, reference, byref(count))
    n = count.value
    elements, independents = (c_size_t * n)(), (c_uint32 * n)()
    others, kinds = (c_size_t * n)(), (c_int * n)()
    fmi.fmi3GetVariableDependencies(
        fmi.component, reference, elements, independents, others, kinds, n
    )
    assert set(elements) | set(others) <= {1}
    return list(independents)


def test_a_dead_point_ends_the_run_early_in_fmpy(fmu3):
    """FMPy stops at `terminateSimulation`, at the time of the dead point."""
    fmu = fmu3("tlv")
    time = np.array([0.0, 2.0])
    signal = np.zeros(2, dtype=[("time", float), ("side_length.position", float)])
    signal["time"], signal["side_length.position"] = time, [0.35, 0.75]
    result = fmpy.simulate_fmu(
        str(fmu.folder),
        stop_time=2.0,
        output_interval=0.05,
        input=signal,
        early_return_allowed=True,
        output=["arm.phi"],
    )
    # The arm is stretched at 0.65 m, at 1.5 s; held inputs lag by a step.
    assert 1.5 <= result["time"][-1] <= 1.55


def test_a_stop_ends_the_run_early_in_fmpy(fmu3):
    """The handle turns by 0.5 rad/s; the bolt meets its strike plate at asin(2/3)."""
    fmu = fmu3("latch")
    signal = np.zeros(2, dtype=[("time", float), ("handle_angle.position", float)])
    signal["time"], signal["handle_angle.position"] = [0.0, 2.0], [0.0, 1.0]
    result = fmpy.simulate_fmu(
        str(fmu.folder),
        stop_time=2.0,
        output_interval=0.05,
        input=signal,
        early_return_allowed=True,
        output=["throw.position"],
    )
    # Held inputs lag by a step.
    met = np.arcsin(2 / 3) / 0.5
    assert met <= result["time"][-1] <= met + 0.1
    assert 0.019 < result["throw.position"].max() <= 0.02
