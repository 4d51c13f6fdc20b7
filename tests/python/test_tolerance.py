"""Tolerances: closed forms. Changed files."""

from __future__ import annotations

import biela
import numpy as np
import pytest
from numpy.testing import assert_allclose

TOLERANCES = {"crank_length": 2e-5, "base": 5e-5}
DRIVE = {"crank_angle": np.linspace(1.0, 6.0, 11)}


def test_the_worst_case_is_that_of_the_corners(four_bar):
    found = biela.tolerance(
        four_bar, drive=DRIVE, tolerances=TOLERANCES, corners=True, variables=["rocker.phi", "coupler.P"]
    )
    for name in ("rocker.phi", "coupler.P.x", "coupler.P.y"):
        low, high = found.extremes(name)
        nominal = found.result[name]
        reach = np.maximum(high - nominal, nominal - low)
        # The second derivatives are of order 100 per metre squared: 100 (7e-5)^2 = 5e-7.
        assert_allclose(reach, found.worst[name], atol=5e-7)
        assert_allclose(sum(found.parts(name).values()), found.worst[name], rtol=1e-15)


def test_samples_deviate_by_a_third_of_the_statistical_deviation(four_bar):
    found = biela.tolerance(
        four_bar, drive=DRIVE, tolerances=TOLERANCES, samples=2000, variables=["rocker.phi"]
    )
    # The standard deviation of 2000 samples is known to 1/sqrt(4000) = 1.6 %; cutting at three
    # standard deviations narrows it by 1.4 %. Four times the first, and the second.
    assert_allclose(
        found.deviation("rocker.phi"), found.statistical["rocker.phi"] / 3, rtol=0.08
    )


def test_tolerances_come_from_the_file(four_bar):
    text = four_bar.text.replace("value = 0.40,", 'value = 0.40, tolerance = "0.05*mm",')
    found = biela.tolerance(biela.loads(text), drive=DRIVE)
    assert found.tolerances == {"base": pytest.approx(5e-5)}
    with pytest.raises(biela.UsageError, match="no parameter has a tolerance"):
        biela.tolerance(four_bar, drive=DRIVE)


def test_expressions_are_nominal_values_too(four_bar):
    found, expected = (
        biela.tolerance(
            four_bar, drive=DRIVE, tolerances=TOLERANCES, corners=True, samples=3,
            parameters={"base": base, "coupler_length": length}, variables=["rocker.phi"],
        )
        for base, length in [("410*mm", "0.26"), (0.41, 0.26)]
    )  # fmt: skip
    assert_allclose(found.worst["rocker.phi"], expected.worst["rocker.phi"], rtol=1e-14)
    # The two values may differ by a rounding.
    assert_allclose(found.extremes("rocker.phi"), expected.extremes("rocker.phi"), rtol=1e-14)
    assert repr(found) == "<biela.Tolerances of crank_length, base: 11 rows of 1 variables, 7 variants>"


def test_expressions_need_not_close_at_the_files_own_start(four_bar):
    """A base that closes where the motion is, but not at the crank angle of the file."""
    with pytest.raises(biela.AssemblyError):
        four_bar.changed({"base": 0.6})
    found, expected = (
        biela.tolerance(
            four_bar, drive={"crank_angle": [0.3]}, tolerances={"base": 1e-4}, corners=True,
            parameters={"base": base}, variables=["rocker.phi"],
        )
        for base in ("600*mm", 0.6)
    )  # fmt: skip
    # The two values may differ by a rounding.
    assert_allclose(found.extremes("rocker.phi"), expected.extremes("rocker.phi"), rtol=1e-14)


def test_wrong_tolerances_are_refused(four_bar):
    for size in (-1e-5, np.nan, "0.05*mm"):
        with pytest.raises(biela.UsageError, match="expected a number in SI units, not negative"):
            biela.tolerance(four_bar, drive=DRIVE, tolerances={"base": size})
    with pytest.raises(biela.UsageError, match="samples: expected a whole number, at least 0; found -1"):
        biela.tolerance(four_bar, drive=DRIVE, tolerances=TOLERANCES, samples=-1)
    single = biela.tolerance(four_bar, drive={"crank_angle": [1.0]}, tolerances=TOLERANCES)
    with pytest.raises(biela.UsageError, match="a path needs two poses"):
        single.plot("coupler.P")
    with pytest.raises(biela.UsageError, match="`base` is no number"):
        biela.tolerance(four_bar, drive=DRIVE, tolerances=TOLERANCES, parameters={"base": [0.4, 0.41]})


def test_corners_that_stop_leave_no_extremes(four_bar):
    """At base 0.55 the crank meets a dead point: coupler and rocker reach 0.55 together."""
    found = biela.tolerance(
        four_bar, drive=DRIVE, tolerances={"base": 0.15}, corners=True, samples=50, variables=["rocker.phi"]
    )
    assert list(found.corners.ok) == [True, False]
    low, high = found.extremes("rocker.phi")
    reached = found.corners.rows.min()
    assert 0 < reached < 11
    assert np.isfinite(low[:reached]).all() and np.isnan(high[reached:]).all()
    assert np.isnan(found.deviation("rocker.phi")[-1])


def test_the_band_is_the_worst_case_along_the_normal(four_bar):
    """The band of the path is as wide as the largest deviation of any corner across the path."""
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    import matplotlib.pyplot as pyplot

    theta = np.linspace(0, 2 * np.pi, 361)
    scale = 20.0
    found = biela.tolerance(
        four_bar, drive={"crank_angle": theta}, tolerances=TOLERANCES, corners=True, variables=["coupler.P"]
    )
    _, axes = pyplot.subplots()
    found.plot("coupler.P", axes=axes, scale=scale)
    (band,) = axes.patches
    (line,) = axes.lines
    path = np.transpose([found.result["coupler.P.x"], found.result["coupler.P.y"]])
    assert_allclose(line.get_xydata(), path, rtol=1e-15)
    edges = band.get_xy()[: 2 * len(path)]
    outer, inner = edges[: len(path)], edges[len(path) :][::-1]
    assert_allclose((outer + inner) / 2, path, atol=1e-15)
    normal = (outer - inner) / np.linalg.norm(outer - inner, axis=1)[:, None]
    corners = np.stack([found.corners["coupler.P.x"], found.corners["coupler.P.y"]], axis=-1)
    across = np.abs(((corners - path) * normal).sum(axis=-1)).max(axis=0)
    width = np.linalg.norm(outer - inner, axis=1) / 2 / scale
    # Second derivatives are of order 100 per metre squared: 100 (7e-5)^2 = 5e-7.
    assert_allclose(across, width, atol=5e-7)
    pyplot.close("all")


def test_a_changed_file_keeps_its_comments(four_bar):
    changed = four_bar.changed({"base": 0.41}, drive={"crank_angle": 1.0})
    assert changed.parameters["base"].value == 0.41
    assert changed.drivers["crank_angle"].start == 1.0
    comments = lambda text: [line for line in text.splitlines() if line.startswith("#")]
    assert comments(changed.text) == comments(four_bar.text)
    assert_allclose(
        changed.check().poses["rocker"],
        four_bar.run(t=[0.0], drive={"crank_angle": [1.0]}, parameters={"base": 0.41},
                     variables=["rocker"]).to_numpy()[0, :3],
        rtol=1e-12,
    )
