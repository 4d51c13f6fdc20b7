"""`gallery.taylor` against differences: the truths' rates rest on it."""

import numpy as np
import pytest
from gallery.plane import apex
from gallery.taylor import Taylor

TIME = np.linspace(0.2, 1.4, 13)


def smooth(t):
    """A real function between 0.3 and 0.8."""
    return 0.55 + 0.25 * (1.3 * t).sin()


FUNCTIONS = {
    "sum": lambda t: 2 + t - smooth(t) - 1 + -t,
    "product": lambda t: 3 * smooth(t) * t * smooth(t).square(),
    "quotient": lambda t: 2 / smooth(t) + t / (1 + smooth(t)),
    "sqrt": lambda t: smooth(t).sqrt(),
    "sin": lambda t: (3 * smooth(t)).sin(),
    "cos": lambda t: (3 * smooth(t)).cos(),
    "asin": lambda t: smooth(t).asin(),
    "acos": lambda t: smooth(t).acos(),
    "hypot": lambda t: Taylor.hypot(smooth(t), t),
    "atan2": lambda t: Taylor.atan2((5 * t).sin(), (5 * t).cos() - 0.3),
    "x": lambda t: Taylor.polar(smooth(t), 4 * t).x,
    "y": lambda t: Taylor.polar(2, 4 * t).y,
    "complex": lambda t: ((1 - 2j) * Taylor.polar(t, smooth(t)) / Taylor.polar(2, t)).conjugate(),
    "length": lambda t: (Taylor.polar(1, 4 * t) + 2j).length(),
    "angle": lambda t: (Taylor.polar(2, 4 * t) + 1j).angle(),
    "apex": lambda t: apex(0, Taylor.polar(smooth(t), t), 1.0, 0.9, -1),
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_rates_are_the_derivatives(name):
    """Central differences of eighth order (Fornberg 1988, table 1) with h = 0.005.

    Their truncation is O(h^8): 1e-8 of the worst function here at h = 0.01, and 256 times less
    at half of that. Rounding is a few eps/h and eps/h^2, below 1e-10.
    """
    first = (4 / 5, -1 / 5, 4 / 105, -1 / 280)
    second = (8 / 5, -1 / 5, 8 / 315, -1 / 560)
    h = 0.005
    function = FUNCTIONS[name]
    exact = function(Taylor.time(TIME))
    # One call for all, since angles are continuous along the samples of a call.
    samples = (TIME[:, None] + h * np.arange(-4, 5)).ravel()
    values = function(Taylor.time(samples)).value.reshape(len(TIME), 9)
    middle, before, after = values[:, 4], values[:, 3::-1], values[:, 5:]
    np.testing.assert_allclose(middle, exact.value, rtol=1e-14)
    np.testing.assert_allclose((after - before) @ first / h, exact.first, rtol=1e-9, atol=1e-10)
    slope = (after + before - 2 * middle[:, None]) @ second / h**2
    np.testing.assert_allclose(slope, exact.second, rtol=1e-8, atol=1e-9)


def test_angles_are_continuous_over_turns():
    angle = Taylor.polar(2, 3 + 20 * Taylor.time(np.linspace(0, 1, 101))).angle()
    np.testing.assert_allclose(angle.value, 3 + np.linspace(0, 20, 101), rtol=1e-14)


def test_a_single_time_will_do():
    t = Taylor.time(0.5)
    assert Taylor.atan2(t.sin(), t.cos()).value == pytest.approx(0.5, rel=1e-15)
    assert Taylor.polar(2, 0.5).angle().value == pytest.approx(0.5, rel=1e-15)


def test_the_apex_has_its_distances():
    a, b = 1 + 2j, 3 + 1j
    for side in (1, -1):
        p = apex(a, b, 1.5, 2.0, side).value
        assert abs(p - a) == pytest.approx(1.5, rel=1e-15)
        assert abs(p - b) == pytest.approx(2.0, rel=1e-15)
        assert side * (np.conj(b - a) * (p - a)).imag > 0
