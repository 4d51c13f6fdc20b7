"""Synthesis: derivatives against differences, mechanisms that are known, published cases."""

from __future__ import annotations

import sys

import biela
import numpy as np
import pytest
from biela.attempt import Attempt, Limits
from biela.synthesis import METHODS, Problem
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


def test_a_function_beyond_a_turning_point_is_met(four_bar):
    """The rocker of the file swings to 2.82 rad: at the turning point the timing has no effect, and
    the base has to grow."""
    found = biela.fit(four_bar, biela.Target({"rocker.phi": [3.0]}, free="crank_angle"), ["base"])
    (timing,) = found.timing
    run = found.mechanism.run(drive={"crank_angle": timing})
    assert_allclose(run["rocker.phi"], [3.0], atol=1e-12)


@pytest.mark.parametrize("target", [[0.8, 1.9], [-1.0, 2.0], [4.0, 4.0]])
def test_fixed_parameters_have_the_nearest_timing(generator, target):
    """Against the least distance from 20,000 poses of the path, and the parabola through the three
    nearest."""
    theta = np.linspace(0.5, 0.5 + 2 * np.pi, 20_000, endpoint=False)
    path = generator.run(drive={"theta": theta}, variables=["coupler.P"])
    gaps = (path["coupler.P.x"] - target[0]) ** 2 + (path["coupler.P.y"] - target[1]) ** 2
    least = gaps.argmin()
    before, at, after = gaps[least - 1 : least + 2]
    expected = at - (after - before) ** 2 / (8 * (before - 2 * at + after))
    for free, bounds in ([], {}), (["px"], {"px": (1.0, 1.0)}):
        found = biela.fit(generator, biela.points("coupler.P", [target], free="theta"), free, bounds)
        # Third derivatives of some metres squared, steps of 3e-4.
        assert_allclose(found.cost, expected, rtol=1e-8)


def test_timing_goes_on_where_parameters_have_no_effect(mechanism):
    """A wheel on a track, farther than the search looks first: the angle alone meets it."""
    target = biela.Target({"wheel.x": [5.0]}, free="turn")
    assert biela.fit(mechanism("rolling_wheel"), target, ["wheel_radius"]).cost < 1e-24


def test_derivatives_are_those_of_the_residuals(four_bar):
    targets = [
        biela.points("coupler.P", [[0.1, 0.2], [0.12, 0.21]], drive={"crank_angle": [1.0, 1.4]}),
        biela.Target({"rocker.phi": [2.2, 2.4], "coupler.phi": [0.3, 0.4]}, free="crank_angle", weight=3.0),
        biela.Target({"rocker.omega": [0.1]}, drive={"crank_angle": ([2.0], 4.0)}),
    ]
    problem = Problem(four_bar, targets, ["base", "crank_length"], {}, None)
    attempt = problem._inner.attempt(problem.own.tolist())
    at = np.array(attempt.start)

    def evaluate(unknowns):
        _, _, _, found = attempt.go(unknowns.tolist(), False)
        return found, attempt.keep().reshape(len(found), -1)

    assert len(at) == 4
    residuals, derivatives = evaluate(at)
    assert residuals.shape == (9,) and derivatives.shape == (9, 4)
    step = 1e-6
    for unknown in range(4):
        off = step * np.eye(4)[unknown]
        up, down = (evaluate(at + sign * off)[0] for sign in (1, -1))
        # Third derivatives are of order 1e3 per metre cubed, and 1e4 for the velocity; rounding of
        # 1e-15 over the step is of the same size.
        assert_allclose(derivatives[:, unknown], (up - down) / (2 * step), atol=1e-7)
    run = four_bar.run(drive={"crank_angle": ([2.0], 4.0, 0.0)}, variables=["rocker.omega"])
    assert_allclose(residuals[8], run["rocker.omega"][0] - 0.1, rtol=1e-12)
    # The timing starts at the nearest of 36 poses of a turn.
    timing = np.arange(37) * 2 * np.pi / 36 + four_bar.drivers["crank_angle"].start
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


def test_a_minimum_within_bounds_fulfils_its_conditions(generator):
    """Those of Kuhn and Tucker: the cost grows from an active bound inwards, and is level elsewhere.
    At this minimum a bound is active, and the cost is far from zero."""
    drive = {"theta": np.radians([30, 45, 60, 75, 90])}
    free = ["r2", "r3", "r4", "px", "py"]
    low, high = np.array([0.5, 1.0, 1.0, 0.1, 0.1]), np.array([2.0, 4.0, 4.0, 1.2, 3.0])
    target = biela.points("coupler.P", TIMED, drive)
    problem = Problem(generator, target, free, dict(zip(free, zip(low, high))), None)
    (attempt,) = attempts = problem.attempts(1, 0, None)
    problem.improve(attempts, 400)
    found = attempt.parameters
    assert np.all((low <= found) & (found <= high)) and attempt.cost > 1e-3
    derivatives = attempt.moving.keep().reshape(-1, len(free))
    slopes = (high - low) * (derivatives.T @ attempt.residuals)
    # SciPy stays inside the bounds by a part of the last steps.
    near = 1e-6 * (high - low)
    at_low, at_high = found - low <= near, high - found <= near
    assert (at_low | at_high).any()
    assert np.all(slopes[at_low] >= 0) and np.all(slopes[at_high] <= 0)
    # A cost that is right to rounding is flat within the root of rounding.
    level = ~(at_low | at_high)
    columns = np.linalg.norm((high - low) * derivatives, axis=0)[level]
    assert np.all(np.abs(slopes[level]) <= 1e-7 * columns * np.sqrt(attempt.cost))


@pytest.mark.parametrize(
    ("limits", "angles", "leaders"),
    [
        # Free, behind the first, and beyond a limit of the driver.
        ((60, 200), [2.3, 2.4, 2.6], [0, 1, 2]),
        ((60, 200), [2.5, 2.4, 2.7], [0, 0, 2]),
        ((50, 80), [2.2, 2.6], [0, None]),
    ],
)
def test_the_slope_of_the_cost_includes_the_timing(mechanism, limits, angles, leaders):
    """Against differences of costs. Timing that is free meets its angle exactly; what is left are
    the poses that follow another or are at a limit."""
    text = mechanism("four_bar").text.replace('start = "60*deg"', f'start = "70*deg", min = "{limits[0]}*deg", max = "{limits[1]}*deg"')
    target = biela.Target({"rocker.phi": angles}, free="crank_angle", in_order=True)
    free = ["crank_length", "base"]
    problem = Problem(biela.loads(text), target, free, {}, None)
    (attempt,) = problem.attempts(1, 0, None)
    for _ in range(5):
        residuals = attempt._try(attempt.parameters + 1e-9)
        derivatives = attempt._keep(attempt.parameters + 1e-9)
    assert attempt._tried[1] == leaders
    off = np.array([leader != place for place, leader in enumerate(leaders)])
    assert np.all(np.abs(residuals[~off]) < 1e-14) and np.all(np.abs(residuals[off]) > 0.05)
    step = 1e-6
    for place, slope in enumerate(derivatives.T @ residuals):
        costs = []
        for sign in (1, -1):
            tried = attempt._try(attempt.parameters + sign * step * np.eye(2)[place])
            costs.append(tried @ tried)
        # Third derivatives of order 1e2 per metre cubed; rounding of 1e-16 over the step.
        assert_allclose(slope, (costs[0] - costs[1]) / (4 * step), atol=1e-9)


def test_a_minimum_with_free_timing_is_found(generator):
    """The cost is that of Levenberg and Marquardt's method with the timing among its unknowns."""
    points = [[-1.074, 2.023], [-0.075, 2.286], [-0.498, 2.322], [-1.243, 1.808]]
    target = biela.points("coupler.P", points, free="theta")
    found = biela.fit(generator, target, ["r3", "r4", "r1"])
    assert_allclose(found.cost, 1.4433485630621e-3, rtol=1e-12)


class Point:
    """A mechanism with one parameter that exists at its start only."""

    start = (1.0,)

    def go(self, unknowns, _nearest):
        return (np.array(unknowns), [], [], np.array([3.0])) if unknowns == [1.0] else None

    def keep(self):
        return np.array([2.0])


@pytest.mark.parametrize("method", METHODS)
def test_an_attempt_that_cannot_move_stays(method):
    """At a bound SciPy may begin a little inside, where the residuals are refused."""
    limits = Limits(np.array([1.0]), np.array([2.0]), np.array([1.0]), 1e-15, 0.0)
    attempt = Attempt(Point(), 1, method)
    attempt.improve(limits, 100)
    assert attempt.parameters == [1.0] and attempt.cost == 9.0
    inside = method == "trf"
    assert attempt.success != inside
    assert (attempt.message == "no parameters near these reach all targets") == inside


def test_a_fit_tells_why_it_ended(four_bar):
    drive = {"crank_angle": [1.0, 1.4, 2.0]}
    angles = four_bar.run(drive=drive, parameters={"base": 0.42})["rocker.phi"]
    target = biela.Target({"rocker.phi": angles}, drive)
    met = biela.fit(four_bar, target, ["base"])
    assert met.success and met.message
    near = biela.fit(four_bar, target, ["base"], stop_at=1e-6)
    assert near.success and near.message == "the cost is not above `stop_at`" and near.cost > met.cost
    # The derivatives by the base vanish at no base: the best one within the bounds is at a bound.
    bound = biela.fit(four_bar, target, ["base"], {"base": (0.39, 0.41)})
    assert bound.success and bound.cost > 1e-6 and bound.message


def test_an_attempt_without_evaluations_left_is_no_success(four_bar):
    drive = {"crank_angle": [1.0, 1.4, 2.0]}
    angles = four_bar.run(drive=drive, parameters={"base": 0.42})["rocker.phi"]
    problem = Problem(four_bar, biela.Target({"rocker.phi": angles}, drive), ["base"], {}, None)
    (attempt,) = problem.attempts(1, 0, np.random.default_rng(0))
    assert not attempt.success and attempt.message == "the search has not begun"
    attempt.improve(problem.limits, 2)
    assert not attempt.success and "maximum number of function evaluations" in attempt.message
    attempt.improve(problem.limits, 100)
    assert attempt.success and "condition is satisfied" in attempt.message


def test_a_fit_without_scipy_names_the_package(four_bar, monkeypatch):
    monkeypatch.setitem(sys.modules, "scipy.optimize", None)
    target = biela.Target({"rocker.phi": [2.2]}, drive={"crank_angle": [1.0]})
    with pytest.raises(biela.UsageError, match="fit needs the package scipy: pip install scipy"):
        biela.fit(four_bar, target, ["base"])


def test_a_start_without_derivatives_is_left_out():
    """The root has an infinite slope at its start."""
    text = (ROOT / "examples" / "path_generator.toml").read_text()
    root = biela.loads(f'{text}\n[measures]\nroot = {{ value = "sqrt(abs(x0))", unit = "1" }}\n')
    target = biela.Target({"root": [0.5]}, {"theta": [0.5]})
    with pytest.raises(biela.AssemblyError, match="reach all targets with finite derivatives"):
        biela.fit(root, target, ["x0"], {"x0": (-1.0, 1.0)})
    found = biela.fit(root, target, ["x0"], {"x0": (-1.0, 1.0)}, starts=3, samples=20)
    assert_allclose(abs(found.parameters["x0"]), 0.25, rtol=1e-9)


def test_equal_bounds_fix_a_parameter(four_bar):
    """A parameter that is fixed costs no evaluation, and random changes leave it alone."""
    target = biela.Target({"rocker.phi": [2.2, 2.4]}, drive={"crank_angle": [1.0, 1.3]})
    free, fixed = {"crank_length": (0.05, 0.2)}, {"base": (0.4, 0.4)}
    for arguments in ({}, {"starts": 3, "samples": 20, "variations": 2}):
        alone, beside = (
            biela.fit(four_bar, target, list(bounds), bounds, **arguments)
            for bounds in (free, {**free, **fixed})
        )
        assert beside.parameters["base"] == 0.4
        assert_allclose(beside.cost, alone.cost, rtol=1e-12)
        # With random starts other numbers are drawn for two parameters than for one.
        assert beside.evaluations == alone.evaluations or arguments


def test_free_values_in_order_are_the_best_of_all(generator):
    """The first timing of three points, which a full turn passes in another order, against all
    choices among 36 poses of a turn."""
    xy = generator.run(drive={"theta": [0.3, 2.5, 1.2]}, variables=["coupler.P"])
    points = np.transpose([xy["coupler.P.x"], xy["coupler.P.y"]])
    start = generator.drivers["theta"].start
    turn = start + 2 * np.pi * np.arange(36) / 36
    path = generator.run(drive={"theta": turn}, variables=["coupler.P"])
    path = np.transpose([path["coupler.P.x"], path["coupler.P.y"]])
    gaps = ((path[None] - points[:, None]) ** 2).sum(axis=2)
    i, j, k = np.meshgrid(*[np.arange(36)] * 3, indexing="ij")
    sums = gaps[0][i] + gaps[1][j] + gaps[2][k]
    ascends = (j - i) % 36 <= (k - i) % 36
    descends = (i - j) % 36 <= (i - k) % 36
    for in_order, allowed in [(False, sums < np.inf), (True, ascends | descends)]:
        target = biela.points("coupler.P", points, free="theta", in_order=in_order)
        problem = Problem(generator, target, ["r2"], {}, None)
        own = generator.parameters["r2"].value
        found = [cost for _, _, cost in problem._inner.costs([own])]
        # The other assembly mode has a cost too. Rounding of a few 1e-15 in squares of some metres.
        assert min(abs(cost - sums[allowed].min()) for cost in found) < 1e-14


@pytest.mark.parametrize(
    ("angles", "met"),
    [((300, 330, 400), True), ((640, 700, 980), True), ((980, 700, 640), True), ((300, 330, 40), False)],
)
def test_a_path_that_closes_after_two_turns_is_followed(mechanism, angles, met):
    """Points that the first crank passes within a turn of its own, and others. The angles are 10°
    apart from its start at 40°, as the poses at which the search looks."""
    geared = mechanism("geared_five_bar")
    path = geared.run(drive={"crank_angle": np.radians(angles)}, variables=["left_link.C"])
    xy = np.transpose([path["left_link.C.x"], path["left_link.C.y"]])
    target = biela.points("left_link.C", xy, free="crank_angle", in_order=True)
    problem = Problem(geared, target, ["link"], {}, None)
    costs = [cost for _, _, cost in problem._inner.costs(problem.own)]
    attempt = problem._inner.attempt(problem.own.tolist())
    _, _, _, residuals = attempt.go(attempt.start, False)
    # Rounding of a few 1e-16 in squares of some centimetres.
    assert min(abs(cost - residuals @ residuals) for cost in costs) < 1e-15
    assert (residuals @ residuals < 1e-24) == met
    if met:
        assert biela.fit(geared, target, ["link"]).cost < 1e-24


def test_an_angle_that_winds_has_the_value_of_its_turn(generator):
    target = biela.Target({"crank.phi": [6.0, 7.5, 1.0]}, free="theta", in_order=True)
    problem = Problem(generator, target, ["r2"], {}, None)
    attempt = problem._inner.attempt(problem.own.tolist())
    _, _, _, residuals = attempt.go(attempt.start, False)
    ((_, _, cost), *_) = problem._inner.costs(problem.own)
    # Rounding of some 1e-16 in squares of radians.
    assert_allclose(residuals @ residuals, cost, atol=1e-14)


@pytest.mark.parametrize("x", [1.0, -1.0])
def test_a_path_that_does_not_close_is_followed_both_ways(mechanism, x):
    """A wheel on a track, three radians from its start."""
    wheel = mechanism("rolling_wheel")
    found = biela.fit(wheel, biela.Target({"wheel.x": [x]}, free="turn"), ["wheel_radius"])
    (timing,) = found.timing
    run = found.mechanism.run(drive={"turn": timing})
    assert found.cost < 1e-24 and abs(run["wheel.x"][0] - x) < 1e-12


@pytest.mark.parametrize("in_order", [False, True])
def test_points_are_passed_in_order_where_asked_for(generator, in_order):
    """Points of a known path in another order: met without an order only."""
    path = generator.run(drive={"theta": [0.3, 2.5, 1.2, 4.0]}, variables=["coupler.P"])
    points = np.transpose([path["coupler.P.x"], path["coupler.P.y"]])
    target = biela.points("coupler.P", points, free="theta", in_order=in_order)
    bounds = {"r2": (0.9, 1.1), "r3": (2.9, 3.1)}
    found = biela.fit(generator, target, list(bounds), bounds, starts=4, samples=20, variations=2)
    (timing,) = found.timing
    steps = np.diff(timing)
    ordered = np.all(steps >= 0) or np.all(steps <= 0)
    assert ordered == in_order and (found.cost < 1e-24) == (not in_order)
    assert np.ptp(timing) <= 2 * np.pi * (1 + 1e-15) or not in_order


def test_free_values_stay_within_the_drivers_limits(mechanism):
    text = mechanism("four_bar").text.replace('start = "60*deg"', 'start = "60*deg", min = "50*deg", max = "80*deg"')
    limited = biela.loads(text)
    assert limited.drivers["crank_angle"].max == pytest.approx(np.radians(80))
    target = biela.Target({"rocker.phi": [2.0, 2.2, 2.6]}, free="crank_angle")
    found = biela.fit(limited, target, free=["base"], bounds={"base": (0.39, 0.41)})
    (timing,) = found.timing
    assert np.all((np.radians(50) <= timing) & (timing <= np.radians(80)))
    assert timing[2] == np.radians(80) and found.cost > 1e-3


def test_wrong_targets_are_refused(generator):
    point = biela.points("coupler.P", TIMED[:2], drive={"theta": [0.5, 1.0]})
    target = lambda values=[1.9], drive={"theta": [0.5]}, **more: biela.Target(
        {"rocker.phi": values}, drive, **more
    )
    refused = [
        ({"free": ["r9"]}, "did you mean `r1`"),
        ({"targets": biela.points("coupler.Q", TIMED, free="theta")}, "did you mean `coupler.P.x`"),
        ({"targets": biela.points("coupler.P", TIMED, free="thita")}, "did you mean `theta`"),
        ({"targets": biela.points("coupler.P", TIMED, {"theta": [0.5]})}, "1 values for 5 poses"),
        ({"turns": "thita"}, "did you mean `theta`"),
        ({"starts": 2}, "random starts need limits of r2"),
        ({"targets": []}, "there are none"),
        ({"targets": biela.Target({"rocker.phi": []}, free="theta")}, "at one pose or more"),
        ({"targets": biela.Target({"rocker.phi": [np.nan]}, free="theta")}, "expected finite values"),
        ({"bounds": {"r2": (2.0, 1.0)}}, "two numbers for `r2`, the smaller first"),
        ({"bounds": {"r2": ("1*m", 2.0)}}, "two numbers for `r2`"),
        ({"starts": 2, "free": []}, "random starts need the name of a parameter"),
        ({"targets": target(weight=np.nan)}, "expected a finite number as `weight`; found nan"),
        ({"targets": target(weight="2")}, "target: expected numbers as `weight`; found '2'"),
        ({"targets": target(["far"])}, r"target: expected numbers as `rocker.phi`; found \['far'\]"),
        ({"targets": target(None)}, "target: expected numbers as `rocker.phi`; found None"),
        ({"targets": target([[1.0], [1.0, 2.0]])}, "target: expected numbers as `rocker.phi`"),
        ({"targets": target(drive={"theta": "1*rad"})}, "drive: expected numbers as `theta`; found '1"),
        ({"starts": 0}, "starts: expected a whole number, at least 1; found 0"),
        ({"starts": 2.5}, "starts: expected a whole number, at least 1; found 2.5"),
        ({"samples": -1}, "samples: expected a whole number, at least 0; found -1"),
        ({"seed": "a"}, "seed: expected a whole number, at least 0; found 'a'"),
        ({"tolerance": "x"}, "fit: expected numbers as `tolerance`; found 'x'"),
        ({"tolerance": np.nan}, "fit: expected a finite number as `tolerance`; found nan"),
        ({"stop_at": None}, "fit: expected numbers as `stop_at`; found None"),
        ({"variations": -1}, "variations: expected a whole number, at least 0; found -1"),
        ({"free": ["r2", "r3", "r2"]}, "free: `r2` is named twice"),
        ({"bounds": {"r3": (1.0, 2.0)}}, "bounds: `r3` is not free; name it in `free` too"),
        ({"bounds": {"r2": (-5.0, -1.0)}}, "^parameters: .*`r2`"),
        ({"bounds": {"r2": (-5.0, -1.0)}, "starts": 3, "samples": 20}, "^parameters: .*`r2`"),
    ]
    for arguments, message in refused:
        with pytest.raises(biela.UsageError, match=message):
            biela.fit(**{"mechanism": generator, "targets": point, "free": ["r2"], **arguments})
    with pytest.raises(biela.UsageError, match=r"rows of x and y; found an array of shape \(3,\)"):
        biela.points("coupler.P", [1, 2, 3])
    with pytest.raises(biela.UsageError, match="points: expected numbers as `coupler.P`; found"):
        biela.points("coupler.P", [[1, 2], [3]])
    far = {"mechanism": generator, "targets": point, "free": ["r2"], "bounds": {"r2": (20.0, 21.0)}}
    with pytest.raises(biela.AssemblyError, match="the mechanism cannot close"):
        biela.fit(**far)
    with pytest.raises(biela.AssemblyError, match="the mechanism does not reach all targets"):
        biela.fit(generator, target([1e200]), ["r2"])
    with pytest.raises(biela.AssemblyError, match="no start reaches all targets"):
        biela.fit(**far, starts=3, samples=20)


def test_five_timed_points_are_met_as_published(generator):
    """The best published sum of squares is 1.924e-6; 7.42e-7 can be attained."""
    target = biela.points("coupler.P", TIMED, drive={"theta": np.radians([30, 45, 60, 75, 90])})
    bounds = {name: (0.01, 50.0) for name in ("r1", "r2", "r3", "r4")}
    bounds |= {name: (-50.0, 50.0) for name in ("px", "py")}
    found = biela.fit(generator, target, list(bounds), bounds, turns="theta", starts=20, samples=1000, variations=2)
    assert found.cost < 7.43e-7
    run = found.mechanism.run(drive={"theta": np.radians([30, 45, 60, 75, 90])})
    off = np.transpose([run["coupler.P.x"], run["coupler.P.y"]]) - TIMED
    # The residuals are of the order of 1e-4; rounding of 1e-14 in them.
    assert_allclose((off**2).sum(), found.cost, rtol=1e-9)


def closed_form_path(parameters, theta, side):
    """Returns the coupler point of a four-bar linkage by the intersection of two circles."""
    r1, r2, r3, r4, px, py, x0, y0, tilt = parameters
    crank = r2 * np.exp(1j * theta)
    diagonal = r1 - crank
    length = np.abs(diagonal)
    cosine = (r3**2 + length**2 - r4**2) / (2 * r3 * length)
    coupler = diagonal / length * (cosine + side * 1j * np.sqrt(1 - cosine**2))
    return x0 + 1j * y0 + np.exp(1j * tilt) * (crank + (px + 1j * py) * coupler)


LENGTHS, PLACES = ["r1", "r2", "r3", "r4"], ["px", "py", "x0", "y0"]


def test_six_points_on_a_line_are_met_exactly(generator):
    """Fifteen unknowns for twelve coordinates: zero can be attained, and was published. With this
    seed the search is short."""
    line = [[20, y] for y in range(20, 50, 5)]
    target = biela.points("coupler.P", line, free="theta", in_order=True)
    free = [*LENGTHS, *PLACES, "tilt"]
    bounds = {name: (5, 60) for name in LENGTHS} | {name: (-60, 60) for name in PLACES}
    bounds["tilt"] = (0, 2 * np.pi)
    found = biela.fit(
        generator, target, free, bounds, turns="theta", starts=100, samples=3000, variations=40,
        seed=3, stop_at=1e-26,
    )  # fmt: skip
    # Twelve coordinates of about 40 m, each right to some of its roundings of 7e-15.
    assert found.cost < 1e-24
    assert all(low <= found.parameters[name] <= high for name, (low, high) in bounds.items())
    (timing,) = found.timing
    assert np.all(np.diff(timing) > 0) or np.all(np.diff(timing) < 0)
    wanted = np.array(line) @ [1, 1j]
    off = [
        np.abs(closed_form_path(found.parameters.values(), timing, side) - wanted).max()
        for side in (1, -1)
    ]
    assert min(off) < 1e-11
    # Grashof: the crank turns.
    lengths = sorted(found.parameters[name] for name in LENGTHS)
    shorter = min(found.parameters["r1"], found.parameters["r2"])
    assert lengths[0] + lengths[3] < lengths[1] + lengths[2] and shorter == lengths[0]
