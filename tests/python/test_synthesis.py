"""Synthesis: derivatives against differences, mechanisms that are known, published cases."""

from __future__ import annotations

import biela
import numpy as np
import pytest
from biela.synthesis import Attempt, Problem
from numpy.testing import assert_allclose
from shipped import ROOT

DRIVE = {"crank_angle": np.linspace(1.0, 6.0, 11)}
TIMED = [[3, 3], [2.759, 3.363], [2.372, 3.663], [1.890, 3.862], [1.355, 3.943]]


@pytest.fixture
def generator():
    """A four-bar linkage whose lengths and place are parameters."""
    return biela.load(ROOT / "examples" / "path_generator.toml")


def test_a_known_four_bar_is_found_from_its_path(four_bar):
    wanted = {"crank_length": 0.105, "coupler_length": 0.26, "rocker_length": 0.29}
    path = four_bar.run(drive=DRIVE, parameters=wanted)
    xy = np.transpose([path["coupler.P.x"], path["coupler.P.y"]])
    found = biela.fit(four_bar, biela.points("coupler.P", xy, drive=DRIVE), free=list(wanted))
    assert found.cost < 1e-24
    for name, value in wanted.items():
        assert_allclose(found.parameters[name], value, rtol=1e-9)
        assert_allclose(found.mechanism.parameters[name].value, value, rtol=1e-9)
    again = biela.loads(found.mechanism.text).run(drive=DRIVE)
    assert_allclose(again["coupler.P.x"], path["coupler.P.x"], rtol=1e-9)


def test_a_function_with_free_timing_is_met(four_bar):
    target = biela.Target({"rocker.phi": [2.2, 2.4, 2.6]}, free="crank_angle")
    found = biela.fit(four_bar, target, free=["base"], bounds={"base": (0.38, 0.42)})
    (timing,) = found.timing
    run = found.mechanism.run(drive={"crank_angle": timing})
    assert_allclose(run["rocker.phi"], [2.2, 2.4, 2.6], atol=1e-9)


def test_derivatives_are_those_of_the_residuals(four_bar):
    targets = [
        biela.points("coupler.P", [[0.1, 0.2], [0.12, 0.21]], drive={"crank_angle": [1.0, 1.4]}),
        biela.Target({"rocker.phi": [2.2, 2.4], "coupler.phi": [0.3, 0.4]}, free="crank_angle", weight=3.0),
        biela.Target({"rocker.omega": [0.1]}, drive={"crank_angle": ([2.0], 4.0)}),
    ]
    problem = Problem(four_bar, targets, ["base", "crank_length"], {}, None)
    attempt = Attempt(problem, problem.own, None)
    at = attempt.unknowns
    assert len(at) == 4
    residuals, derivatives = attempt.evaluate(at)
    assert residuals.shape == (9,) and derivatives.shape == (9, 4)
    step = 1e-6
    for unknown in range(4):
        off = step * np.eye(4)[unknown]
        up, down = (attempt.evaluate(at + sign * off)[0] for sign in (1, -1))
        # Third derivatives are of order 1e3 per metre cubed, and 1e4 for the velocity; rounding of
        # 1e-15 over the step is of the same size.
        assert_allclose(derivatives[:, unknown], (up - down) / (2 * step), atol=1e-7)
    run = four_bar.run(drive={"crank_angle": ([2.0], 4.0, 0.0)}, variables=["rocker.omega"])
    assert_allclose(residuals[8], run["rocker.omega"][0] - 0.1, rtol=1e-12)
    # The timing starts at the nearest of 73 poses of a turn.
    timing = np.arange(73) * 2 * np.pi / 72 + four_bar.drivers["crank_angle"].start
    assert all(np.abs(timing - value).min() < 1e-9 for value in at[2:])


def test_a_known_path_is_found_from_random_starts(generator):
    """A crank-rocker whose assembly mode is not that of the file."""
    wanted = {"r2": 1.4, "r3": 3.1, "r4": 2.9}
    drive = {"theta": np.linspace(0, 5, 8)}
    (other,) = generator.modes().others
    path = generator.posed(other).run(drive=drive, parameters=wanted)
    xy = np.transpose([path["coupler.P.x"], path["coupler.P.y"]])
    target = biela.points("coupler.P", xy, drive=drive)
    bounds = {name: (0.8 * value, 1.2 * value) for name, value in wanted.items()}
    found = biela.fit(
        generator, target, list(wanted), bounds, turns="theta", starts=6, samples=60, stop_at=1e-20
    )
    assert found.cost <= 1e-20 and found.mechanism.range("theta").turns
    for name, value in wanted.items():
        assert_allclose(found.parameters[name], value, rtol=1e-8)
    again = found.mechanism.run(drive=drive)
    assert_allclose(again["coupler.P.x"], path["coupler.P.x"], rtol=1e-8)


def test_a_fit_is_the_same_each_time(generator):
    target = biela.points("coupler.P", TIMED, drive={"theta": np.radians([30, 45, 60, 75, 90])})
    bounds = {name: (0.5, 10.0) for name in ("r1", "r2", "r3", "r4")}
    runs = [
        biela.fit(generator, target, list(bounds), bounds, starts=4, samples=50, seed=3)
        for _ in range(2)
    ]
    assert runs[0].parameters == runs[1].parameters and runs[0].cost == runs[1].cost
    assert np.all(np.diff(runs[0].costs) >= 0)


def test_wrong_targets_are_refused(generator):
    point = biela.points("coupler.P", TIMED[:2], drive={"theta": [0.5, 1.0]})
    refused = [
        ({"free": ["r9"]}, "did you mean `r1`"),
        ({"targets": biela.points("coupler.Q", TIMED, free="theta")}, "did you mean `coupler.P.x`"),
        ({"targets": biela.points("coupler.P", TIMED, free="thita")}, "did you mean `theta`"),
        ({"targets": biela.points("coupler.P", TIMED, {"theta": [0.5]})}, "1 values for 5 poses"),
        ({"turns": "thita"}, "did you mean `theta`"),
        ({"starts": 2}, "random starts need limits of r2"),
    ]
    for arguments, message in refused:
        with pytest.raises(biela.UsageError, match=message):
            biela.fit(**{"mechanism": generator, "targets": point, "free": ["r2"], **arguments})
    far = {"mechanism": generator, "targets": point, "free": ["r2"], "bounds": {"r2": (20.0, 21.0)}}
    with pytest.raises(biela.AssemblyError, match="the mechanism cannot close"):
        biela.fit(**far)
    with pytest.raises(biela.AssemblyError, match="no start reaches all targets"):
        biela.fit(**far, starts=3, samples=20)


def test_five_timed_points_are_met_as_published(generator):
    """The best published sum of squares is 1.924e-6; 7.42e-7 can be attained."""
    target = biela.points("coupler.P", TIMED, drive={"theta": np.radians([30, 45, 60, 75, 90])})
    bounds = {name: (0.01, 50.0) for name in ("r1", "r2", "r3", "r4")}
    bounds |= {name: (-50.0, 50.0) for name in ("px", "py")}
    found = biela.fit(generator, target, list(bounds), bounds, turns="theta", starts=20, samples=1000)
    assert found.cost < 7.43e-7
    run = found.mechanism.run(drive={"theta": np.radians([30, 45, 60, 75, 90])})
    off = np.transpose([run["coupler.P.x"], run["coupler.P.y"]]) - TIMED
    # The residuals are of the order of 1e-4; rounding of 1e-14 in them.
    assert_allclose((off**2).sum(), found.cost, rtol=1e-9)
