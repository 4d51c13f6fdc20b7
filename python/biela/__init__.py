"""biela: planar mechanisms as text files, exported as FMI 2.0 FMUs.

The package brings the program of the same name; `python -m biela` runs it too.
"""

from __future__ import annotations

import os
import sys
import sysconfig


def program() -> str:
    """Returns the path of the program `biela` that was installed with this package."""
    name = "biela" + (sysconfig.get_config_var("EXE") or "")
    user = os.name + "_user"
    folders = [sysconfig.get_path("scripts"), sysconfig.get_path("scripts", user)]
    # `pip install --target` puts programs beside packages.
    folders.append(os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "bin"))
    for folder in folders:
        path = os.path.join(folder, name)
        if os.path.isfile(path):
            return path
    raise FileNotFoundError(f"the program {name} is in none of {', '.join(folders)}")


def main() -> int:
    """Runs the program with the arguments of this process; returns its exit status."""
    command = [program(), *sys.argv[1:]]
    if os.name == "nt":
        import subprocess

        return subprocess.run(command).returncode
    os.execv(command[0], command)
