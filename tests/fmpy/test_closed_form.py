"""The closed forms themselves: they close the loops, and their rates are their derivatives.

Everything else in this folder is measured against them, so they are tested without the program.
"""

import numpy as np
import pytest
from closed_form import CLOSED_FORMS, FourBar, SliderCrank, Tlv, TlvCrank, kind_of, largest_errors
from motions import full_motion

AT_ROUNDING = 8 * np.finfo(float).eps
"""Half a dozen operations on numbers of the size compared."""

# Coefficients of the central difference of eighth order for a first derivative (Fornberg 1988,
# table 1): f'(t) = sum_k c_k (f(t + k h) - f(t - k h)) / h + O(h^8).
EIGHTH_ORDER = (4 / 5, -1 / 5, 4 / 105, -1 / 280)

NAMES = sorted(CLOSED_FORMS)

CHANGED = {
    "pendulum": {"length": 0.7},
    "slider_crank": {"crank_length": 0.06, "rod_length": 0.13, "offset": -0.02},
    "four_bar": {
        "crank_length": 0.12,
        "coupler_length": 0.26,
        "rocker_length": 0.31,
        "base": 0.42,
    },
    "tlv": {"base": 0.41, "arm_length": 0.24},
    "tlv_crank": {"base": 0.5, "arm_length": 0.3},
}

VARIANTS = [pytest.param(name, {}, id=name) for name in NAMES] + [
    pytest.param(name, CHANGED[name], id=f"{name}-changed") for name in NAMES
]


def motion_at(name, parameters, time):
    return CLOSED_FORMS[name](**parameters).motion(*full_motion(name, time))


@pytest.mark.parametrize(("name", "parameters"), VARIANTS)
def test_rates_are_the_derivatives(name, parameters):
    """Every velocity and acceleration against an eighth-order difference of what it derives from.

    With h = 1/1600 of the motion's time the truncation, h^8 f^(9)/630, has fallen below 3e-13 of
    the rate (halving h divides it by 256; at 1/800 it is 7e-11 at worst), and the rounding,
    a few eps/h relative to the value, is about as large.
    """
    time = np.linspace(0.1, 0.9, 97)
    h = 1 / 1600
    exact = motion_at(name, parameters, time)
    around = {k: motion_at(name, parameters, time + k * h) for k in range(-4, 5) if k}

    derivative_of = {
        "vx": "x", "vy": "y", "omega": "phi", "velocity": "position",
        "ax": "vx", "ay": "vy", "alpha": "omega", "acceleration": "velocity",
    }  # fmt: skip
    differences, rates = {}, {}
    for output in exact:
        owner, _, suffix = output.rpartition(".")
        if suffix in derivative_of:
            source = f"{owner}.{derivative_of[suffix]}"
            differences[output] = sum(
                c * (around[k][source] - around[-k][source]) / h
                for k, c in enumerate(EIGHTH_ORDER, start=1)
            )
            rates[output] = exact[output]
    assert len(rates) >= 6
    errors = largest_errors(differences, rates)
    assert max(errors.values()) < 2e-12, errors


def rotated(results, body, x, y=0.0):
    """Ground position of a point of a body, as a complex number."""
    origin = results[f"{body}.x"] + 1j * results[f"{body}.y"]
    return origin + (x + 1j * y) * np.exp(1j * results[f"{body}.phi"])


def joint_gaps(name, form, r):
    """Open distance of every joint, in metres, and of every prescribed angle, in radians."""
    if name == "pendulum":
        return {"O": rotated(r, "rod", -form.length / 2)}
    if name == "slider_crank":
        half = form.rod_length / 2
        return {
            "O": rotated(r, "crank", 0),
            "A": rotated(r, "crank", form.crank_length) - rotated(r, "connecting_rod", -half),
            "B": rotated(r, "connecting_rod", half) - rotated(r, "slider", 0),
            "guide y": r["slider.y"] - form.offset,
            "guide angle": r["slider.phi"],
        }
    if name == "four_bar":
        return {
            "O2": rotated(r, "crank", 0),
            "A": rotated(r, "crank", form.crank_length) - rotated(r, "coupler", 0),
            "B": rotated(r, "coupler", form.coupler_length)
            - rotated(r, "rocker", form.rocker_length),
            "O4": rotated(r, "rocker", 0) - form.base,
        }
    side = rotated(r, "rod", 0) - rotated(r, "barrel", 0)
    return {
        "O": rotated(r, "arm", 0),
        "C": rotated(r, "barrel", 0) - form.base,
        "A": rotated(r, "arm", form.arm_length) - rotated(r, "rod", 0),
        "slide y": (side * np.exp(-1j * r["barrel.phi"])).imag,
        "slide angle": r["rod.phi"] - r["barrel.phi"],
    }


@pytest.mark.parametrize(("name", "parameters"), VARIANTS)
def test_joints_close(name, parameters):
    form = CLOSED_FORMS[name](**parameters)
    results = form.motion(*full_motion(name, np.linspace(0, 1, 721)))
    size = max(
        np.max(np.abs(values)) for key, values in results.items() if key.endswith((".x", ".y"))
    )
    for joint, gap in joint_gaps(name, form, results).items():
        assert np.max(np.abs(gap)) <= AT_ROUNDING * max(size, 1.0), joint


@pytest.mark.parametrize("name", NAMES)
def test_driver_drives(name):
    """The driven coordinate, recomputed from the poses, is the driver's value and its rates."""
    form = CLOSED_FORMS[name]()
    u, rate, acceleration = full_motion(name, np.linspace(0, 1, 181))
    r = form.motion(u, rate, acceleration)
    if name == "tlv":
        side = rotated(r, "rod", 0) - rotated(r, "barrel", 0)
        np.testing.assert_allclose(np.abs(side), u, rtol=AT_ROUNDING)
        return
    body = form.bodies[0]
    down = np.pi / 2 if name == "pendulum" else 0.0
    np.testing.assert_allclose(r[f"{body}.phi"] + down, u, atol=AT_ROUNDING * np.max(u))
    np.testing.assert_array_equal(r[f"{body}.omega"], rate)
    np.testing.assert_array_equal(r[f"{body}.alpha"], acceleration)


def test_estimates_name_the_branch(mechanism_data):
    """At the start value each body lies near its estimate: this branch, this turn of the angle."""
    for name, form in CLOSED_FORMS.items():
        results = form().motion(form.start)
        for body, table in mechanism_data(name)["bodies"].items():
            for suffix, estimate in zip(("x", "y", "phi"), estimate_of(table, form()), strict=True):
                found = results[f"{body}.{suffix}"].item()
                # The other branch is more than 0.1 m or half a radian away from each estimate.
                near = 0.05 if suffix != "phi" else 0.4
                assert abs(found - estimate) < near, (name, body, suffix, found, estimate)


def estimate_of(table, form):
    """The estimate's numbers; its expressions use one parameter or degrees, nothing else."""
    names = {"deg": np.pi / 180, **{p: getattr(form, p) for p in form.parameter_names()}}
    return [
        eval(value, {"__builtins__": {}}, names) if isinstance(value, str) else value
        for value in table["estimate"]
    ]


def test_parameters_are_those_of_the_files(mechanism_data):
    for name, form in CLOSED_FORMS.items():
        file = mechanism_data(name)
        defaults = {p: getattr(form(), p) for p in form.parameter_names()}
        assert {p: table["value"] for p, table in file["parameters"].items()} == defaults
        assert list(file["bodies"]) == list(form.bodies)
        (driver,) = file["drivers"]
        assert driver == form.driver


@pytest.mark.parametrize("name", ["slider_crank", "four_bar", "tlv_crank"])
def test_a_turn_adds_up(name):
    """A turn later the crank's angle is 2 pi larger and everything else is where it was."""
    form = CLOSED_FORMS[name]()
    u = np.linspace(0, 2 * np.pi, 721)
    first, second = form.motion(u, 1.0), form.motion(u + 2 * np.pi, 1.0)
    crank = form.bodies[0]
    for output, values in first.items():
        turn = 2 * np.pi if output == f"{crank}.phi" else 0.0
        # Adding 2 pi rounds u by up to 1e-15, which the steepest output multiplies by ten.
        np.testing.assert_allclose(second[output] - turn, values, atol=2e-14, err_msg=output)
        if kind_of(output) == ("position", "rad"):
            assert np.max(np.abs(np.diff(values))) < 0.05, f"{output} jumps"


def test_right_angle():
    """The 3-4-5 triangle: the arm stands upright, and its rate is u'/sin(angle at A)/arm."""
    r = Tlv(base=0.4, arm_length=0.3).motion(0.5, 0.1)
    assert r["arm.phi"].item() == pytest.approx(np.pi / 2, rel=AT_ROUNDING)
    assert r["barrel.phi"].item() == pytest.approx(np.pi - np.arctan2(3, 4), rel=AT_ROUNDING)
    assert r["arm.omega"].item() == pytest.approx(0.1 / 0.8 / 0.3, rel=AT_ROUNDING)


def test_slider_at_its_ends():
    """In line at u = 0 and 180°: stroke l ± r, at the far end the textbook -(r + r²/l) omega²."""
    form = SliderCrank(crank_length=0.05, rod_length=0.15, offset=0.0)
    r = form.motion([0.0, np.pi], 3.0)
    np.testing.assert_allclose(r["stroke.position"], [0.20, 0.10], rtol=AT_ROUNDING)
    np.testing.assert_allclose(r["stroke.velocity"], 0, atol=1e-16)
    expected = -(0.05 + 0.05**2 / 0.15) * 9
    assert r["stroke.acceleration"][0] == pytest.approx(expected, rel=AT_ROUNDING)


def test_rocker_at_its_limits():
    """Crank and coupler in line: the rocker stands still, at the angle of a plain triangle."""
    form = FourBar()
    for reach in (form.coupler_length + form.crank_length, form.coupler_length - form.crank_length):
        cosine = (form.base**2 + reach**2 - form.rocker_length**2) / (2 * form.base * reach)
        line = np.arccos(cosine)
        u = line if reach > form.coupler_length else line + np.pi
        r = form.motion(u, 2.0)
        assert r["rocker.omega"].item() == pytest.approx(0, abs=1e-14)
        assert r["coupler.phi"].item() == pytest.approx(line, rel=1e-14)


def test_the_two_triangles_are_one():
    """Driven by the length that the driven arm gives, the triangle takes the same pose and rates.

    From 62° to 150°: towards 180°, where the driven length folds the triangle, the rounding of
    the length is multiplied by 1/sin(angle), its square and its cube.
    """
    u, rate, acceleration = full_motion("tlv_crank", np.linspace(0.1, 0.35, 31))
    by_angle = TlvCrank().motion(u, rate, acceleration)
    side = [by_angle[f"side_length.{k}"] for k in ("position", "velocity", "acceleration")]
    by_length = Tlv().motion(*side)
    common = [name for name in by_angle if name in by_length]
    assert len(common) == 27
    errors = largest_errors(by_length, {name: by_angle[name] for name in common})
    assert max(errors.values()) < 1e-13, errors


def test_parameters_may_be_arrays():
    u = np.linspace(1.0, 1.2, 5)
    lengths = np.linspace(0.30, 0.31, 5)
    together = FourBar(rocker_length=lengths).motion(u)["rocker.phi"]
    one_by_one = [
        FourBar(rocker_length=length).motion(value)["rocker.phi"].item()
        for length, value in zip(lengths, u, strict=True)
    ]
    np.testing.assert_array_equal(together, one_by_one)


def test_errors_are_relative_to_the_kind():
    expected = {"a.x": np.array([2.0]), "b.x": np.array([0.1]), "a.phi": np.array([4.0])}
    wrong = {"a.x": [2.0], "b.x": [0.3], "a.phi": [4.1]}
    assert largest_errors(wrong, expected)["position"] == pytest.approx(0.1)
    assert largest_errors({**wrong, "b.x": [np.nan]}, expected)["position"] == np.inf
