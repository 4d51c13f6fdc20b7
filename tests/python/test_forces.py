"""Forces of a run: closed forms, the balance of power, and their gradients."""

from __future__ import annotations

import warnings

import biela
import numpy as np
import pytest
from numpy.testing import assert_allclose

GRAVITY = 9.81
AT_ROUNDING = 1e-12
"""Relative error of some hundred operations on numbers of one size."""


def hatch(phi, mass=18.0, gas_force=400.0, length=0.50, volume=0.60):
    """Returns the torque that holds the hatch, and its derivatives by mass and gas force.

    By virtual work: weight times the lever of the centre, less the force of the gas spring times
    the derivative of its length.
    """
    lever = 0.52 * np.cos(phi) - 0.05 * np.sin(phi)
    x = 0.14 * np.cos(phi) + 0.02 * np.sin(phi) + 0.05
    y = 0.14 * np.sin(phi) - 0.02 * np.cos(phi) + 0.42
    distance = np.hypot(x, y)
    dx, dy = -0.14 * np.sin(phi) + 0.02 * np.cos(phi), 0.14 * np.cos(phi) + 0.02 * np.sin(phi)
    along = (x * dx + y * dy) / distance
    pressed = (volume / (volume - length + distance)) ** 1.2
    torque = mass * GRAVITY * lever - gas_force * pressed * along
    return torque, GRAVITY * lever, -pressed * along


def test_the_effort_of_a_hatch_and_its_gradient_are_those_of_virtual_work(mechanism):
    phi = np.radians(np.linspace(-70, 20, 19))
    result = mechanism("hatch").run(drive={"opening": phi}, gradient=["mass", "gas_force"])
    torque, by_mass, by_force = hatch(phi)
    # Where weight and spring balance, the rounding is that of each.
    size = 18 * GRAVITY
    assert_allclose(result["opening.effort"], torque, atol=size * AT_ROUNDING)
    assert result.units["opening.effort"] == "N.m"
    assert_allclose(result.gradient["opening.effort", "mass"], by_mass, atol=GRAVITY * AT_ROUNDING)
    assert_allclose(result.gradient["opening.effort", "gas_force"], by_force, atol=AT_ROUNDING)


def test_a_hinge_carries_weight_and_spring(mechanism):
    """At rest the forces on the hatch sum to zero."""
    phi = np.radians(np.linspace(-70, 20, 19))
    result = mechanism("hatch").run(drive={"opening": phi})
    spring = np.stack([result["hinge.fx"], result["hinge.fy"] - 18 * GRAVITY])
    push = result["gas_spring.effort"]
    assert_allclose(np.hypot(*spring), np.abs(push), rtol=AT_ROUNDING)


def test_the_power_of_the_driver_changes_the_energy(mechanism):
    """Without damping: its power is the rate of kinetic and potential energy, and the spring's."""
    t = np.linspace(0, 1, 2001)
    result = mechanism("hatch").run(t=t, drive={"opening": "-40*deg + 0.5*sin(2*t)"})
    energy = result["energy.kinetic"] + result["energy.potential"]
    spring = result["gas_spring.effort"] * result["gas_length.velocity"]
    supplied = result["opening.power"] + spring
    # Simpson's rule over 0.001 s: its error is of order h^4 times the fourth derivative, 1e-12 J.
    h = t[1] - t[0]
    work = h / 3 * (supplied[0:-2:2] + 4 * supplied[1:-1:2] + supplied[2::2]).cumsum()
    assert_allclose(work, (energy[2::2] - energy[0]), atol=1e-9)


def test_variables_narrow_to_forces(mechanism):
    hatch = mechanism("hatch")
    sweep = hatch.sweep(
        {"mass": [10.0, 18.0]}, drive={"opening": [0.0, 0.1]}, variables=["opening.effort", "hinge"]
    )
    assert list(sweep) == ["opening.effort", "hinge.fx", "hinge.fy"]
    for place, mass in enumerate((10.0, 18.0)):
        own = hatch.run(drive={"opening": [0.0, 0.1]}, parameters={"mass": mass})
        for name in sweep:
            np.testing.assert_array_equal(sweep[name][place], own[name])


def test_a_contact_that_pulls_is_told(mechanism):
    """The valve's spring holds the follower on the cam up to some speed."""
    train = mechanism("valve_train")
    (name,) = (driver.name for driver in train.drivers.values() if driver.start is not None)
    turn = lambda speed: {name: (np.linspace(0, 2 * np.pi, 181), speed, 0.0)}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        train.run(drive=turn(1.0))
    with pytest.warns(biela.MechanismWarning, match="would lift off: .* keeps them together"):
        train.run(drive=turn(1000.0))


def test_arrows_show_the_forces_of_drawings_and_pages(mechanism, four_bar):
    lid = mechanism("hatch")
    place = {"opening": -1.2}
    plain, arrows = lid.draw(drive=place), lid.draw(drive=place, forces=True)
    # The holding torque, with three digits, is that of virtual work.
    torque = abs(hatch(-1.2)[0])
    assert 1 < torque < 10
    assert f"{torque:.2f} N m" in arrows and "N m" not in plain
    result = lid.run(drive={"opening": [0.1, 0.2]})
    assert len(result.to_html(forces=True)) > len(result.to_html())
    with pytest.raises(biela.UsageError, match="the mechanism has no forces"):
        four_bar.draw(forces=True)
    with pytest.raises(biela.UsageError, match="this run has none"):
        four_bar.run(drive={"crank_angle": [1.0, 1.1]}).to_html(forces=True)
