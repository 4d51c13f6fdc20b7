"""Validates and simulates FMUs in FMPy, and writes their outputs as JSON beside them.

    simulate.py FMU...
"""

import json
import sys
from pathlib import Path

import numpy as np
from fmpy import read_model_description, simulate_fmu
from fmpy.validation import validate_fmu


def simulate(fmu):
    description = read_model_description(fmu)
    variables = description.modelVariables
    inputs = [v for v in variables if v.causality == "input" and v.name.endswith(".position")]
    outputs = [v.name for v in variables if v.causality == "output"]
    width = {"four_bar": 6.0, "cam_roller": 6.0}.get(description.modelName, 0.03)
    time = np.linspace(0.0, 1.0, 201)
    # Polynomials: the same bits everywhere. Rates are estimated from second differences, which
    # would multiply the last bit of a cosine by 1/step².
    rows = [
        (t, *(float(v.start) + width * t * (t - 0.25 * k) for k, v in enumerate(inputs)))
        for t in time
    ]
    signal = np.array(rows, dtype=[("time", float), *((v.name, float) for v in inputs)])
    result = simulate_fmu(fmu, stop_time=1.0, output_interval=0.005, input=signal, output=outputs)
    return {
        "problems": validate_fmu(fmu),
        "names": list(result.dtype.names),
        "rows": [[float(value) for value in row] for row in result],
    }


for fmu in sys.argv[1:]:
    Path(fmu).with_suffix(".json").write_text(json.dumps(simulate(fmu)), encoding="utf-8")
