"""Instances: where they may be unpacked, what refuses to start, reset, several side by side."""

import os
import shutil

import fmpy
import numpy as np
import pytest
from closed_form import CLOSED_FORMS, FourBar
from fmpy.fmi1 import FMICallException
from harness import ERROR, WARNING, Fmu, Slave, assert_accurate, collect, signals, simulate
from motions import full_motion


def drive(instance, name, steps=60, columns=3):
    """Drives through a full motion and returns what the outputs were after every step."""
    driver = CLOSED_FORMS[name].driver
    suffixes = ("position", "velocity", "acceleration")[:columns]
    time = np.linspace(0, 1, steps + 1)
    rows = []
    for values in np.transpose(full_motion(name, time[:-1])):
        instance.set({f"{driver}.{s}": value for s, value in zip(suffixes, values, strict=False)})
        instance.step(1 / steps)
        rows.append(instance.outputs())
    return rows


# ---------------------------------------------------------------------------------------------
# Place


NOT_ON_WINDOWS = pytest.mark.skipif(os.name == "nt", reason="no such names on Windows")


@pytest.mark.parametrize(
    "folder",
    [
        "with spaces",
        "50% #1",
        "manivela más ñandú",
        "機構",
        "a%20b",
        "~&+;=@[]'",
        pytest.param('?:"<>', marks=NOT_ON_WINDOWS),
    ],
)
def test_unpacked_in_an_awkward_folder(fmu, tmp_path, folder):
    """The resource location arrives as a URI with escapes; what is in it must be found."""
    moved = tmp_path / folder / "the fmu"
    shutil.copytree(fmu("four_bar").folder, moved)
    result = simulate(Fmu(fmu("four_bar").path, moved, fmu("four_bar").description), stop_time=0.1)
    expected = FourBar().motion(FourBar.start)["rocker.phi"].item()
    np.testing.assert_allclose(result["rocker.phi"], expected, rtol=1e-12)


def test_run_from_the_archive(fmu):
    """`simulate_fmu` with the file itself and nothing else: the mechanism rests at its start."""
    result = fmpy.simulate_fmu(str(fmu("four_bar").path))
    assert result["time"][-1] == pytest.approx(2.0), "the file's stop time"
    assert len(result) == 201, "the file's step"
    expected = FourBar().motion(np.full(len(result), FourBar.start))
    assert_accurate(result, expected)


# ---------------------------------------------------------------------------------------------
# Refusals


@pytest.mark.parametrize("guid", ["{00000000-0000-0000-0000-000000000000}", "", "nonsense"])
def test_wrong_guid(fmu, messages, guid):
    with pytest.raises(Exception, match="Failed to instantiate"):
        Slave(fmu("four_bar"), guid=guid, messages=messages)
    assert any("guid" in text.lower() for text in messages.texts(ERROR)), messages


def test_altered_resources(fmu, tmp_path, messages):
    """The mechanism in `resources/` must be the one that the XML describes."""
    moved = tmp_path / "altered"
    shutil.copytree(fmu("four_bar").folder, moved)
    altered = 0
    for file in (moved / "resources").rglob("*"):
        if file.is_file() and b"coupler_length" in file.read_bytes():
            file.write_bytes(file.read_bytes().replace(b"0.25", b"0.26"))
            altered += 1
    assert altered
    with pytest.raises(Exception, match="Failed to instantiate"):
        Slave(Fmu(fmu("four_bar").path, moved, fmu("four_bar").description), messages=messages)
    assert messages.texts(ERROR)


def test_missing_resources(fmu, tmp_path, messages):
    moved = tmp_path / "bare"
    shutil.copytree(fmu("four_bar").folder, moved)
    shutil.rmtree(moved / "resources")
    with pytest.raises(Exception, match="Failed to instantiate"):
        Slave(Fmu(fmu("four_bar").path, moved, fmu("four_bar").description), messages=messages)
    assert any("resources" in text for text in messages.texts(ERROR)), messages


def test_unknown_value_references(slave):
    """An error that changes nothing."""
    instance = slave("four_bar").start()
    fresh = instance.outputs()
    for call in (
        lambda: instance.fmi.getReal([999_999]),
        lambda: instance.fmi.setReal([999_999], [1.0]),
        lambda: instance.fmi.getInteger([999_999]),
        lambda: instance.fmi.getBoolean([1]),
        lambda: instance.fmi.getString([1]),
        lambda: instance.fmi.setRealInputDerivatives([999_999], [1], [1.0]),
    ):
        with pytest.raises(FMICallException) as refused:
            call()
        assert refused.value.status == ERROR
    assert instance.outputs() == fresh
    instance.step(0.1)


def test_outputs_cannot_be_set(slave):
    instance = slave("four_bar").start()
    with pytest.raises(FMICallException) as refused:
        instance.set({"rocker.phi": 1.0})
    assert refused.value.status == ERROR
    assert any("rocker.phi" in text for text in instance.messages.texts(ERROR))


def test_there_is_no_step_to_be_cancelled(slave):
    instance = slave("four_bar").start()
    with pytest.raises(FMICallException) as refused:
        instance.fmi.cancelStep()
    assert refused.value.status == ERROR
    instance.step(0.1)


# ---------------------------------------------------------------------------------------------
# Again and side by side


@pytest.mark.parametrize("name", sorted(CLOSED_FORMS))
def test_reset_and_run_again(slave, name):
    """The second run gives the first one's numbers to the last bit."""
    instance = slave(name).start()
    first = [instance.outputs(), *drive(instance, name)]
    instance.fmi.reset()
    instance.start()
    assert [instance.outputs(), *drive(instance, name)] == first


def test_reset_forgets_everything(slave):
    """Parameters, rates once set and samples seen: after a reset as a new instance."""
    used = slave("four_bar").start({"crank_length": 0.12, "extrapolation": 2, "base": 0.42})
    drive(used, "four_bar")
    used.fmi.terminate()
    used.fmi.reset()
    fresh = slave("four_bar")
    used.start()
    fresh.start()
    names = [n for n, v in used.variables.items() if v.causality in ("parameter", "input")]
    assert used.get(*names) == fresh.get(*names)
    # Only the angle this time: were the flag of earlier rates kept, they would not be estimated.
    assert drive(used, "four_bar", columns=1) == drive(fresh, "four_bar", columns=1)


def test_start_time(slave):
    """Time may begin anywhere; the estimates do not depend on it beyond rounding."""
    early, late = slave("four_bar").start(), slave("four_bar").start(start_time=-100.0)
    first = collect(drive(early, "four_bar", columns=1))
    second = collect(drive(late, "four_bar", columns=1))
    np.testing.assert_allclose(first["rocker.phi"], second["rocker.phi"], rtol=1e-13)
    # Times of size 100 are rounded to 1e-14, steps of 1/60 therefore to 1e-12.
    scale = np.max(np.abs(first["rocker.alpha"]))
    np.testing.assert_allclose(first["rocker.alpha"], second["rocker.alpha"], atol=1e-9 * scale)


def test_several_instances_side_by_side(slave):
    """Three of one FMU with other parameters and inputs, one of another, stepped in turn.

    Each gives what it gives alone, to the last bit.
    """
    plans = [
        ("four_bar", {}, 60),
        ("four_bar", {"crank_length": 0.12}, 45),
        ("four_bar", {"rates": 3, "extrapolation": 2}, 50),
        ("tlv", {"arm_length": 0.24}, 55),
    ]
    alone = [drive(slave(name).start(values), name, steps) for name, values, steps in plans]

    instances = [slave(name).start(values) for name, values, _ in plans]
    together = [[] for _ in plans]
    for k in range(60):
        for instance, rows, (name, _, steps) in zip(instances, together, plans, strict=True):
            if k < steps:
                values = full_motion(name, np.linspace(0, 1, steps + 1)[k])
                driver = CLOSED_FORMS[name].driver
                instance.set(
                    {
                        f"{driver}.{suffix}": float(value)
                        for suffix, value in zip(
                            ("position", "velocity", "acceleration"), values, strict=True
                        )
                    }
                )
                instance.step(1 / steps)
                rows.append(instance.outputs())
    assert together == alone


def test_a_failing_instance_leaves_the_others_alone(slave):
    healthy, alone = slave("tlv").start(), slave("tlv").start()
    sick = slave("tlv").start()
    sick.set({"side_length.position": 0.9})
    with pytest.raises(FMICallException):
        sick.step(0.1)
    healthy.step(0.1)
    alone.step(0.1)
    assert healthy.outputs() == alone.outputs()
    assert not healthy.messages.texts(WARNING)


def test_reading_ahead_commits_nothing(slave):
    """Outputs read after inputs were set, without a step between: answered, and forgotten."""
    form = FourBar()
    looked, straight = slave("four_bar").start({"rates": 2}), slave("four_bar").start({"rates": 2})
    for instance in (looked, straight):
        instance.set({"crank_angle.position": 1.1, "crank_angle.velocity": 2.0})
        instance.step(0.1)

    looked.set({"crank_angle.position": 1.9})
    ahead = looked.outputs()
    assert ahead["rocker.phi"] == pytest.approx(form.motion(1.9)["rocker.phi"].item(), rel=1e-12)

    for instance in (looked, straight):
        instance.set({"crank_angle.position": 1.2})
        instance.step(0.1)
    assert looked.outputs() == straight.outputs()


def test_only_declared_log_categories(fmu, messages):
    """Whatever is logged with everything switched on belongs to a category of the XML."""
    time = np.linspace(0, 1, 51)
    simulate(
        fmu("four_bar"),
        messages,
        input=signals("crank_angle", time, *full_motion("four_bar", time)),
        stop_time=1.0,
        output_interval=0.02,
        debug_logging=True,
    )
    declared = {category.name for category in fmu("four_bar").description.logCategories}
    assert declared
    assert {message.category for message in messages} <= declared


def test_a_quiet_run_says_nothing(fmu, messages, capfd):
    """Nothing on stdout or stderr, and with logging off nothing to the logger either."""
    simulate(fmu("four_bar"), messages, stop_time=0.1)
    assert messages == []
    printed = capfd.readouterr()
    assert printed.out == "" == printed.err
