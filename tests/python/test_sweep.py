"""Sweeps: the numbers of single runs, whatever the order, and reasons of refused variants."""

from __future__ import annotations

import os
import subprocess
import sys

import biela
import numpy as np
import pytest
from shipped import ROOT, small_motion
from numpy.testing import assert_array_equal

THETA = 1.0 + np.linspace(0, 2 * np.pi, 37)


def test_a_sweep_has_the_bits_of_single_runs(four_bar):
    base = np.linspace(0.36, 0.44, 101)
    drive = {"crank_angle": (THETA, 2.0, 0.0)}
    sweep = four_bar.sweep({"base": base, "rocker_length": "305*mm"}, drive=drive)
    for place in (0, 17, 64, 100):
        own = four_bar.run(drive=drive, parameters={"base": base[place], "rocker_length": 0.305})
        assert list(own) == list(sweep)
        for name in own:
            assert_array_equal(sweep[name][place], own[name])


def test_a_sweep_of_each_mechanism_is_its_run(any_mechanism):
    t = np.linspace(0, 1, 3)
    drive = small_motion(any_mechanism, t)
    free = [p for p in any_mechanism.parameters.values() if not p.derived]
    if not free:
        pytest.skip("the mechanism has no parameters")
    sweep = any_mechanism.sweep({free[0].name: np.full(3, free[0].value)}, t=t, drive=drive)
    own = any_mechanism.run(t=t, drive=drive)
    for name in own:
        for variant in range(3):
            assert_array_equal(sweep[name][variant], own[name])


def test_the_order_of_variants_has_no_effect(four_bar):
    base = np.linspace(0.2, 0.7, 200)
    order = np.random.default_rng(1).permutation(200)
    drive = {"crank_angle": THETA}
    forward = four_bar.sweep({"base": base}, drive=drive, variables="rocker.phi")
    mixed = four_bar.sweep({"base": base[order]}, drive=drive, variables="rocker.phi")
    assert_array_equal(forward["rocker.phi"][order], mixed["rocker.phi"])
    assert_array_equal(forward.rows[order], mixed.rows)


def test_arrays_of_several_dimensions_keep_their_shape(four_bar):
    crank, base = np.meshgrid([0.08, 0.1], [0.38, 0.4, 0.42], indexing="ij")
    sweep = four_bar.sweep({"crank_length": crank, "base": base}, drive={"crank_angle": THETA})
    assert sweep["rocker.phi"].shape == (2, 3, 37) and sweep.ok.shape == (2, 3)
    own = four_bar.run(drive={"crank_angle": THETA}, parameters={"crank_length": 0.1, "base": 0.38})
    assert_array_equal(sweep["rocker.phi"][1, 0], own["rocker.phi"])


def test_outer_sweeps_have_an_axis_per_array(four_bar):
    parameters = {"crank_length": [0.09, 0.1], "base": 0.4, "coupler_length": [0.3, 0.31, 0.32]}
    motion = {"drive": {"crank_angle": [1.0, 1.1]}, "variables": ["rocker.phi"]}
    sweep = four_bar.sweep(parameters, outer=True, **motion)
    assert sweep.shape == (2, 3)
    crank, coupler = np.meshgrid([0.09, 0.1], [0.3, 0.31, 0.32], indexing="ij")
    expected = four_bar.sweep({"crank_length": crank, "base": 0.4, "coupler_length": coupler}, **motion)
    assert np.array_equal(sweep["rocker.phi"], expected["rocker.phi"])
    assert len(np.unique(sweep["rocker.phi"])) == 12
    assert np.array_equal(sweep.parameters["crank_length"], crank)
    single = four_bar.sweep({"base": 0.4}, outer=True, **motion)
    assert single.shape == ()


def test_refused_variants_have_their_reasons(four_bar):
    base = [0.4, 0.5, 5.0, -1.0]
    sweep = four_bar.sweep({"base": base}, drive={"crank_angle": THETA}, variables="rocker.phi")
    assert_array_equal(sweep.ok, [True, False, False, False])
    assert sweep.reason(0) is None
    # The longest pose is straight at base 0.5: coupler and rocker reach 0.55.
    assert "the mechanism cannot go on" in sweep.reason(1)
    assert "the mechanism cannot close" in sweep.reason(2)
    assert "at least 0.001" in sweep.reason(3)
    assert set(sweep.reasons) == {(1,), (2,), (3,)}
    reached = sweep.rows[1]
    assert 0 < reached < 37
    assert np.isfinite(sweep["rocker.phi"][1, :reached]).all()
    assert np.isnan(sweep["rocker.phi"][1, reached:]).all()


def rocker_driven(four_bar):
    """The four-bar driven at its rocker, which swings between 122.1° and 161.4°."""
    text = four_bar.text.replace(
        'markers = ["ground.O2", "crank.O"], start = "60*deg"',
        'markers = ["ground.O4", "rocker.O"], start = "140*deg"',
    )
    assert text != four_bar.text
    return biela.loads(text)


def test_variants_beyond_a_dead_point_have_their_reasons(four_bar):
    """One turn of the rocker further the mechanism closes, but no motion leads there."""
    driven = rocker_driven(four_bar)
    beyond = np.full(3, np.radians(140) + 2 * np.pi)
    with pytest.raises(biela.AssemblyError, match="stops with driver `crank_angle` at"):
        driven.run(drive={"crank_angle": beyond})
    sweep = driven.sweep({"base": [0.4, 0.41]}, drive={"crank_angle": beyond}, variables="rocker.phi")
    assert not sweep.ok.any() and not sweep.rows.any()
    assert np.isnan(sweep["rocker.phi"]).all()
    for variant in range(2):
        assert "dead point" in sweep.reason(variant)


def test_the_number_of_cores_has_no_effect(tmp_path):
    code = (
        "import sys; sys.path.insert(0, sys.argv[1])\n"
        "import biela, numpy as np\n"
        "four_bar = biela.load(sys.argv[2])\n"
        "sweep = four_bar.sweep({'base': np.linspace(0.3, 0.6, 150)}, "
        "drive={'crank_angle': 1 + np.linspace(0, 6, 25)})\n"
        "print(hash(sweep._values.tobytes()), sweep.reasons)"
    )
    outputs = set()
    for threads in ("1", "3"):
        environment = {**os.environ, "RAYON_NUM_THREADS": threads, "PYTHONHASHSEED": "0"}
        command = [sys.executable, "-c", code, ROOT / "crates/python", ROOT / "mechanisms/four_bar.toml"]
        ran = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
        outputs.add(ran.stdout)
    assert len(outputs) == 1


def test_shapes_that_do_not_fit_are_told(four_bar):
    with pytest.raises(biela.UsageError, match="parameters: expected numbers as `base`; found"):
        four_bar.sweep({"base": ["wide"]}, drive={"crank_angle": 1.0})
    with pytest.raises(biela.UsageError, match=r"base \(3,\), crank_length \(2,\)"):
        four_bar.sweep({"base": [0.4] * 3, "crank_length": [0.1] * 2})
