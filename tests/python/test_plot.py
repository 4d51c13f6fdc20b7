"""Charts of motions: labels, panels, lines."""

from __future__ import annotations

import sys

import biela
import matplotlib
import numpy as np
import pytest
from numpy.testing import assert_array_equal

matplotlib.use("agg")

from matplotlib import pyplot  # noqa: E402  (it takes the backend chosen above)

THETA = np.linspace(1.0, 2.0, 5)


@pytest.fixture(autouse=True)
def closed_figures():
    """Closes the figures of a test."""
    yield
    pyplot.close("all")


@pytest.fixture(scope="module")
def result(four_bar):
    """A motion in time."""
    return four_bar.run(t=[0, 0.5, 1], drive={"crank_angle": "1 + t"})


def names(panel):
    """Returns the names of the lines of a panel."""
    return [line.get_label() for line in panel.get_lines()]


def test_there_is_a_panel_per_unit(result):
    axes = result.plot(["rocker.phi", "rocker.omega", "coupler.phi"])
    angle, speed = axes
    assert names(angle) == ["rocker.phi", "coupler.phi"] and angle.get_ylabel() == "[rad]"
    assert [text.get_text() for text in angle.get_legend().get_texts()] == names(angle)
    assert speed.get_ylabel() == "rocker.omega [rad/s]" and speed.get_legend() is None
    assert speed.get_xlabel() == "time [s]"
    x, y = angle.get_lines()[0].get_data()
    assert_array_equal(x, result.t)
    assert_array_equal(y, result["rocker.phi"])


def test_what_stays_constant_is_left_out_unless_it_is_named(result):
    shown = [name for panel in result.plot() for name in names(panel)]
    still = {"crank.x", "crank.y", "rocker.x", "rocker.vx", "crank.omega", "crank_angle.acceleration"}
    assert still <= set(result) and not still & set(shown)
    assert {"rocker.phi", "coupler.P.x", "crank_angle.position"} <= set(shown)
    by_body = [names(panel) for panel in result.plot("rocker")]
    assert by_body == [["rocker.phi"], ["rocker.omega"], ["rocker.alpha"]]
    assert names(result.plot("rocker.x")[0]) == ["rocker.x"]


def test_poses_without_times_are_drawn_over_the_driver_that_moves(four_bar, mechanism):
    poses = four_bar.run(drive={"crank_angle": THETA}, variables="rocker.phi")
    (panel,) = poses.plot()
    assert panel.get_xlabel() == "crank_angle [rad]"
    assert_array_equal(panel.get_lines()[0].get_xdata(), THETA)
    robot = mechanism("five_bar_robot")
    both = {name: driver.start + 0.1 * THETA for name, driver in robot.drivers.items()}
    assert len(both) == 2
    panel = robot.run(drive=both).plot()[-1]
    assert panel.get_xlabel() == "pose"
    assert_array_equal(panel.get_lines()[0].get_xdata(), np.arange(5))


def test_the_rows_of_a_motion_that_stops_are_drawn(mechanism):
    triangle = mechanism("tlv")
    sides = triangle.drivers["side_length"].start + np.linspace(0, 1, 101)
    stopped = triangle.run(drive={"side_length": sides}, stop="keep")
    assert 1 < len(stopped.t) < 101
    assert_array_equal(stopped.plot()[0].get_lines()[0].get_xdata(), sides[: len(stopped.t)])


def test_the_abscissa_is_any_variable(result):
    (panel,) = result.plot("rocker.phi", over="crank_angle.position")
    assert panel.get_xlabel() == "crank_angle.position [rad]"
    assert_array_equal(panel.get_lines()[0].get_xdata(), result["crank_angle.position"])


def test_axes_may_be_given(result):
    _, axes = pyplot.subplots(2)
    assert list(result.plot(["rocker.phi", "rocker.x"], axes=axes)) == list(axes)
    (panel,) = result.plot("rocker.phi", axes=axes[0])
    assert names(panel) == ["rocker.phi"] * 2
    with pytest.raises(biela.UsageError, match="expected 1 axes, for rad; found 2"):
        result.plot("rocker.phi", axes=axes)


def test_charts_that_cannot_be_drawn_are_told(four_bar, result, monkeypatch):
    with pytest.raises(biela.UsageError, match="variables: no variable `rocker.psi`"):
        result.plot("rocker.psi")
    with pytest.raises(biela.UsageError, match="no variable `crank_angel`"):
        result.plot("rocker.phi", over="crank_angel")
    with pytest.raises(biela.UsageError, match="expected two rows or more; found 1"):
        four_bar.run(t=[0.0]).plot()
    monkeypatch.setitem(sys.modules, "matplotlib.pyplot", None)
    with pytest.raises(ImportError, match="plot needs the package matplotlib: pip install matplotlib"):
        result.plot()
