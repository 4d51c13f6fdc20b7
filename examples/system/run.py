"""A walking leg driven by a motor: two FMUs of different origin, coupled by an SSP file.

The motor (`motor.c`, an FMU of its own) turns the crank of Jansen's leg, an FMU of biela, and turns
faster while the toe is in the air: the toe's height closes the loop. FMPy and Ecos simulate the
same SSP file. The table shows the lag of the leg's crank behind the motor's shaft, in steps.

Cells begin with `# %%`, as VS Code, Spyder and Jupytext have them; as a script it runs as well.
"""

# %% Build the two FMUs and pack the SSP file
# The program `biela` is on the PATH (`make install`), and so is a C compiler, `cc`.
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
MECHANISM = HERE.parent.parent / "mechanisms" / "jansen_leg.toml"
HEADERS = Path(fmpy.__file__).parent / "c-code"  # FMPy brings the standard's headers along

library = Path(f"motor{fmpy.sharedLibraryExtension}")
subprocess.run(
    ["cc", "-O2", "-fPIC", "-shared", f"-I{HEADERS}", HERE / "motor.c", "-o", library, "-lm"],
    check=True,
)
with zipfile.ZipFile("motor.fmu", "w") as archive:
    archive.write(HERE / "motor.xml", "modelDescription.xml")
    archive.write(library, f"binaries/{fmpy.platform}/{library}")
subprocess.run(["biela", "export", MECHANISM, "-o", "jansen_leg.fmu"], check=True)
with zipfile.ZipFile("walker.ssp", "w") as archive:
    archive.write(HERE / "SystemStructure.ssd", "SystemStructure.ssd")
    for fmu in ("motor.fmu", "jansen_leg.fmu"):
        archive.write(fmu, f"resources/{fmu}")

STOP = 2.0
Parameter = namedtuple("Parameter", "name value")
ParameterSet = namedtuple("ParameterSet", "parameters")


# %% FMPy's SSP simulation
def with_fmpy(h, extrapolation):
    """Angle and speed of the shaft, and angle of the leg's crank, after each step."""
    settings = ParameterSet([Parameter("leg.extrapolation", extrapolation)])
    result = simulate_ssp("walker.ssp", stop_time=STOP, step_size=h, parameter_set=settings)
    return np.array([result[name] for name in ("motor.angle", "motor.speed", "leg.crank.phi")])


# %% Ecos, an engine in C++
def with_ecos(h):
    """The same; the leg has its default settings."""
    if sys.platform == "linux":
        # Ecos links to a library of another wheel, which it does not look for.
        ctypes.CDLL(f"{sys.prefix}/lib/libtbb.so.12", mode=ctypes.RTLD_GLOBAL)
    from ecospy.EcosSimulation import EcosSimulation

    rows = []
    with EcosSimulation(h, ssp_path="walker.ssp") as simulation:
        assert simulation.init()
        for _ in range(round(STOP / h)):
            simulation.step(1)
            names = ("motor::angle", "motor::speed", "leg::crank.phi")
            rows.append([simulation.get_real(name) for name in names])
        simulation.terminate()
    return np.transpose(rows)


# %% Lag of the leg's crank, in steps
print("host  leg                step [ms]  lag [steps]  shaft after 2 s [rad]")
for h in (0.01, 0.005):
    runs = {
        ("FMPy", "hold"): with_fmpy(h, 1),
        ("FMPy", "extrapolation = 2"): with_fmpy(h, 2),
        ("Ecos", "hold"): with_ecos(h),
    }
    for (host, leg), (shaft, speed, crank) in runs.items():
        lag = np.mean(((shaft - crank) / speed)[round(0.5 / h) :]) / h
        print(f"{host}  {leg:17}  {1000 * h:9.0f}  {abs(lag):11.2f}  {shaft[round(STOP / h) - 1]:21.3f}")
