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
