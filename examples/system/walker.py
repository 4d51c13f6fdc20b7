"""A walking leg driven by a motor: two FMUs of different origin, coupled by an SSP file.

The motor (`motor.c`, an FMU of its own) turns the crank of Jansen's leg, an FMU of biela, and turns
faster while the toe is in the air: the toe's height closes the loop. FMPy and Ecos simulate the
same SSP file. The table shows the lag of the leg's crank behind the motor's shaft, in steps.

Cells begin with `# %%`, as VS Code, Spyder and Jupytext have them; as a script it runs as well.
"""

# %% Build the two FMUs and pack the SSP file
import numpy as np
from coupling import HERE, build, export, pack, with_ecos, with_fmpy

build("motor")
export(HERE.parent.parent / "mechanisms" / "jansen_leg.toml")
pack("walker", "motor", "jansen_leg")

STOP = 2.0
NAMES = ("motor.angle", "motor.speed", "leg.crank.phi")

# %% Lag of the leg's crank, in steps
print("host  leg                step [ms]  lag [steps]  shaft after 2 s [rad]")
for h in (0.01, 0.005):
    runs = {
        ("FMPy", "hold"): with_fmpy("walker", NAMES, STOP, h),
        ("FMPy", "extrapolation = 2"): with_fmpy(
            "walker", NAMES, STOP, h, {"leg.extrapolation": 2}
        ),
        ("Ecos", "hold"): with_ecos("walker", NAMES, STOP, h),
    }
    for (host, leg), (shaft, speed, crank) in runs.items():
        lag = np.mean(((shaft - crank) / speed)[round(0.5 / h) :]) / h
        print(f"{host}  {leg:17}  {1000 * h:9.0f}  {abs(lag):11.2f}  {shaft[-1]:21.3f}")
