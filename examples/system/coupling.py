"""FMUs written in C, and systems of FMUs coupled by SSP files, for the examples of this folder.

The program `biela` is on the PATH (`make install`), and so is a C compiler, `cc`. Results are
written into the current folder.
"""

import ctypes
import subprocess
import sys
import zipfile
from collections import namedtuple
from pathlib import Path

import fmpy
import numpy as np
from fmpy.ssp.simulation import simulate_ssp

HERE = Path(__file__).resolve().parent
HEADERS = Path(fmpy.__file__).parent / "c-code"  # FMPy brings the standard's headers along

Parameter = namedtuple("Parameter", "name value")
ParameterSet = namedtuple("ParameterSet", "parameters")


def build(model):
    """Compiles `model.c` and packs it with `model.xml` as `model.fmu`."""
    library = Path(f"{model}{fmpy.sharedLibraryExtension}")
    source = HERE / f"{model}.c"
    subprocess.run(
        ["cc", "-O2", "-fPIC", "-shared", f"-I{HEADERS}", source, "-o", library, "-lm"],
        check=True,
    )
    with zipfile.ZipFile(f"{model}.fmu", "w") as archive:
        archive.write(HERE / f"{model}.xml", "modelDescription.xml")
        archive.write(library, f"binaries/{fmpy.platform}/{library}")


def export(mechanism):
    """Exports a mechanism file as an FMU of its name."""
    fmu = f"{Path(mechanism).stem}.fmu"
    subprocess.run(["biela", "export", mechanism, "-o", fmu], check=True)


def pack(system, *models):
    """Packs `system.ssd` and the FMUs of its models as `system.ssp`."""
    with zipfile.ZipFile(f"{system}.ssp", "w") as archive:
        archive.write(HERE / f"{system}.ssd", "SystemStructure.ssd")
        for model in models:
            archive.write(f"{model}.fmu", f"resources/{model}.fmu")


def with_fmpy(system, names, stop, h, parameters=None):
    """Values of variables, `component.name`, after each step of FMPy's SSP simulation."""
    settings = ParameterSet([Parameter(*pair) for pair in (parameters or {}).items()])
    result = simulate_ssp(f"{system}.ssp", stop_time=stop, step_size=h, parameter_set=settings)
    return np.array([result[name][: round(stop / h)] for name in names])


def with_ecos(system, names, stop, h):
    """The same by Ecos, an engine in C++; all FMUs have their default settings."""
    if sys.platform == "linux":
        # Ecos links to a library of another wheel, which it does not look for.
        ctypes.CDLL(f"{sys.prefix}/lib/libtbb.so.12", mode=ctypes.RTLD_GLOBAL)
    from ecospy.EcosSimulation import EcosSimulation

    rows = []
    with EcosSimulation(h, ssp_path=f"{system}.ssp") as simulation:
        assert simulation.init()
        for _ in range(round(stop / h)):
            simulation.step(1)
            rows.append([simulation.get_real(name.replace(".", "::", 1)) for name in names])
        simulation.terminate()
    return np.transpose(rows)


def runge_kutta(rate, state, h, steps, every=1):
    """States of an equation state' = rate(time, state) by the classical Runge-Kutta method: the
    first one, then each one after `every` steps."""
    states = [np.array(state, dtype=float)]
    now = states[0]
    for step in range(steps):
        time = step * h
        a = rate(time, now)
        b = rate(time + 0.5 * h, now + 0.5 * h * a)
        c = rate(time + 0.5 * h, now + 0.5 * h * b)
        d = rate(time + h, now + h * c)
        now = now + h / 6 * (a + 2 * b + 2 * c + d)
        if (step + 1) % every == 0:
            states.append(now)
    return np.array(states)
