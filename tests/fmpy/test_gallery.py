"""Every mechanism in `mechanisms/`, as an FMU in FMPy, over its full motion against its truth."""

import numpy as np
import pytest
from gallery import cases
from gallery.runner import position_names, run, table
from gallery.taylor import Taylor
from harness import SHIPPED

CASES = cases()


def test_every_mechanism_has_a_truth():
    assert sorted(CASES) == SHIPPED


@pytest.mark.parametrize("name", sorted(CASES))
def test_full_motion(fmu, name, capsys):
    row = run(name, CASES[name], fmu(name))
    assert row.failures == []
    assert capsys.readouterr().out == "", "FMPy shows no advice on ordinary use"
    assert row.name in table([row])


@pytest.mark.parametrize("name", sorted(CASES))
def test_the_truth_is_complete(fmu, name):
    """It covers every position, and with it its rates, or says which ones it leaves out."""
    case = CASES[name]
    time = Taylor.time(np.linspace(0, case.duration, case.steps + 1))
    covered = set(case.truth(time, case.drivers(time)))
    assert covered.isdisjoint(case.left_out)
    assert covered | set(case.left_out) == position_names(fmu(name))


@pytest.mark.parametrize("name", sorted(CASES))
def test_the_motion_is_lively(name):
    """Zero rates would hide errors: every driver moves and accelerates."""
    case = CASES[name]
    for u in case.drivers(Taylor.time(np.linspace(0, case.duration, case.steps + 1))).values():
        assert np.ptp(u.value) > 0
        assert np.max(np.abs(u.second)) > 0
