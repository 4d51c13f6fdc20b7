"""Advice on wrong use reaches a user of FMPy with default settings, and nobody else is bothered."""

import numpy as np
import pytest
from harness import SHIPPED, signals, simulate
from numpy.testing import assert_allclose

HZ = 10
"""Steps per second of the host."""


def moved(fmu, capsys, name, driver, position, velocity=0.0, **options) -> list[str]:
    """Simulates with the defaults of FMPy but input and steps; returns what it prints."""
    time = np.arange(0, len(position)) / HZ
    columns = (np.asarray(position, float), np.full(len(time), velocity), np.zeros(len(time)))
    result = simulate(
        fmu(name),
        input=signals(driver, time, *columns),
        start_values={f"{driver}.position": position[0]},
        stop_time=time[-1],
        step_size=1 / HZ,
        output_interval=1 / HZ,
        **options,
    )
    assert result["time"][-1] == pytest.approx(time[-1]), "a warning ends no simulation"
    return capsys.readouterr().out.splitlines()


def assert_one(lines: list[str], part: str) -> None:
    assert len(lines) == 1, lines
    assert lines[0].startswith("[WARNING] ")
    assert part in lines[0]


def test_an_angle_alone_in_model_exchange(fmu, capsys):
    """Its velocities are zero, which is wrong."""
    lines = moved(
        fmu, capsys, "four_bar", "crank_angle", 1.0 + 0.1 * np.arange(30), fmi_type="ModelExchange"
    )
    assert_one(lines, "connect `crank_angle.velocity`")


def test_an_angle_alone_in_co_simulation_is_no_wrong_use(fmu, capsys):
    lines = moved(
        fmu, capsys, "four_bar", "crank_angle", 1.0 + 0.1 * np.arange(30), fmi_type="CoSimulation"
    )
    assert lines == []


def test_a_wrapped_angle(fmu, capsys):
    position = (1.0 + np.arange(30)) % (2 * np.pi)
    lines = moved(fmu, capsys, "four_bar", "crank_angle", position, fmi_type="CoSimulation")
    assert_one(lines, "set `wrapped = true`")


def test_a_velocity_that_contradicts_the_motion(fmu, capsys):
    position = 1.0 + 0.1 * np.arange(30)
    lines = moved(
        fmu, capsys, "four_bar", "crank_angle", position, 7.0, fmi_type="CoSimulation"
    )
    assert_one(lines, "is given as 7 rad/s, but its position changes by 1 rad/s")


def test_a_driver_beyond_its_limits(fmu, capsys):
    """The hatch opens by up to 25°."""
    position = np.radians(24.5 + np.sin(np.arange(30) / 4))
    lines = moved(fmu, capsys, "hatch", "opening", position, fmi_type="CoSimulation")
    assert_one(lines, "beyond its `max`")


@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
@pytest.mark.parametrize("own", [True, False])
def test_wheels_that_overlap_at_the_start(fmu, capsys, kind, own):
    """They are moved by 2/5 and 4/5 of the depth, and meet with 1 rad/s, which leaves -0.4 and 0.2 rad/s. The
    model description has these starts. Others that a host sets are moved too."""
    exported = fmu("overlapping_wheels")
    values = ["p.position", "q.position", "p.velocity", "q.velocity"]
    if own:
        truth = [np.radians(80.2), np.radians(-39.6), -0.4, 0.2]
        starts = {variable.name: variable for variable in exported.description.modelVariables}
        assert_allclose([float(starts[name].start) for name in values], truth, rtol=1e-14)
        assert {starts[name].initial for name in values} == {"exact"}
        options, depth = {}, "49.5 deg"
    else:
        truth = [np.radians(33), np.radians(-16), -0.4, 0.2]
        start = [np.radians(41), 0.0, 0.0, 1.0]
        options, depth = {"start_values": dict(zip(values, start, strict=True))}, "20 deg"
    result = simulate(exported, fmi_type=kind, output=values, stop_time=0.1, **options)
    assert_allclose([result[name][0] for name in values], truth, rtol=1e-13)
    assert_one(capsys.readouterr().out.splitlines(), f"overlap by {depth}; moved apart: `p` from")


@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
@pytest.mark.parametrize("name", SHIPPED)
def test_ordinary_use_is_silent(fmu, capsys, name, kind):
    """As FMPy simulates every mechanism that is shipped if nothing is asked for."""
    simulate(fmu(name), fmi_type=kind)
    assert capsys.readouterr().out == ""
