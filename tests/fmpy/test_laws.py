"""Forces by tables and inputs: the FMU in co-simulation and CVode in model exchange against SciPy."""

import numpy as np
import pytest
from fmpy import simulate_fmu
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

MASS, OIL, PUSH, END = 0.01, 400.0, 90.0, 1.0
POINTS = np.array([[-0.02, -8000], [0, 0], [0.01, 20], [0.02, 400], [0.03, 8000]])


def rates(_t, state):
    x, v = state
    return [v, (PUSH - OIL * v - np.interp(x, *POINTS.T)) / MASS]


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("interface", ["CoSimulation", "ModelExchange"])
def test_stiff_laws_follow_their_equation(fmu, fmu3, version, interface):
    exported = {2: fmu, 3: fmu3}[version]("stiff_laws")
    result = simulate_fmu(
        exported.folder,
        model_description=exported.description,
        fmi_type=interface,
        solver="CVode",
        stop_time=END,
        output_interval=0.0005,
        step_size=0.0005,
        relative_tolerance=1e-10,
        start_values={"push": PUSH},
        output=["way.position", "way.velocity"],
    )
    times = np.unique(result["time"])[::40]
    truth = solve_ivp(
        rates, (0, END), [-0.015, 0], method="Radau", t_eval=times, rtol=1e-12, atol=1e-14
    )
    for column, name in enumerate(["way.position", "way.velocity"]):
        found = np.interp(times, result["time"], result[name])
        # The velocity has fallen from 0.2 m/s within the first step.
        assert_allclose(found, truth.y[column], rtol=0, atol=1e-8 if column == 0 else 1e-6)
    assert truth.y[0][0] < 0 and truth.y[0][-1] > 0.01, "it passes corners of the table"
