"""The README's first mechanism, commands and FMPy script work as they stand there."""

import os
import re
import subprocess
import sys

from fmpy import read_model_description
from fmpy.util import read_csv
from harness import ROOT, program


def blocks(language):
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def test_first_mechanism(tmp_path):
    (mechanism,), (console,), (script,) = blocks("toml"), blocks("console"), blocks("python")
    assert len(mechanism.splitlines()) <= 31
    (tmp_path / "piston.toml").write_text(mechanism, encoding="utf-8")
    path = f"{program().parent}{os.pathsep}{os.environ['PATH']}"
    for line in console.splitlines():
        command = line.removeprefix("$ ")
        assert command != line
        subprocess.run(
            command, shell=True, cwd=tmp_path, env={**os.environ, "PATH": path}, check=True
        )
    # One header, and a row every millisecond of 0.1 s.
    table = read_csv(tmp_path / "piston.csv")
    assert len(table) == 101
    # The names are those of the FMU's variables, and the numbers plain numbers.
    assert table.dtype.names[0] == "time"
    outputs = {v.name for v in read_model_description(tmp_path / "piston.fmu").modelVariables}
    assert set(table.dtype.names) <= outputs
    assert all(table.dtype[name] == float for name in table.dtype.names)
    printed = subprocess.run(
        [sys.executable, "-c", script], cwd=tmp_path, check=True, capture_output=True, text=True
    ).stdout
    # 10 rad are more than a turn: the stroke's ends are rod -+ crank, met to within
    # (0.01 rad)^2 / 2 of the crank at a step of 0.01 rad.
    # FMPy has said before which inputs are not wired.
    low, high = map(float, printed.splitlines()[-1].split())
    assert abs(low - 0.09) < 0.06 * 5e-5 * 2
    assert abs(high - 0.21) < 0.06 * 5e-5 * 2


def test_make_targets_exist():
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    targets = set(re.findall(r"`?make ([a-z]+)", text))
    assert {"demo", "test"} <= targets
    for target in targets:
        assert re.search(rf"^{target}:", makefile, re.MULTILINE), target
