"""Validates and simulates an FMU in FMPy, and writes its outputs as JSON.

    simulate.py FMU JSON
"""

import json
import sys

import numpy as np
from fmpy import read_model_description, simulate_fmu
from fmpy.validation import validate_fmu

fmu, out = sys.argv[1:]
description = read_model_description(fmu)
inputs = [v for v in description.modelVariables if v.causality == "input" and v.name.endswith(".position")]
outputs = [v.name for v in description.modelVariables if v.causality == "output"]
width = {"four_bar": 6.0, "cam_roller": 6.0}.get(description.modelName, 0.03)
time = np.linspace(0.0, 1.0, 201)
rows = [(t, *(float(v.start) + width * (1.0 - np.cos(t + k * t)) for k, v in enumerate(inputs))) for t in time]
signal = np.array(rows, dtype=[("time", float), *((v.name, float) for v in inputs)])
result = simulate_fmu(fmu, stop_time=1.0, output_interval=0.005, input=signal, output=outputs)
with open(out, "w", encoding="utf-8") as file:
    values = [[float(value) for value in row] for row in result]
    json.dump({"problems": validate_fmu(fmu), "names": list(result.dtype.names), "rows": values}, file)
