"""The examples run, in a small version, and what they find is what closed forms say."""

import os
import re
import subprocess
import sys

import numpy as np
import pytest
from harness import ROOT, program


@pytest.fixture
def example(tmp_path):
    """`example(name)`: what the example prints, run in an empty folder with `biela` on the PATH."""

    def run(name):
        path = f"{program().parent}{os.pathsep}{os.environ['PATH']}"
        small = {
            "PATH": path,
            "MPLBACKEND": "agg",
            "BIELA_EXAMPLE": "small",
            "PYTHONPATH": str(ROOT / "crates" / "python"),
        }
        done = subprocess.run(
            [sys.executable, ROOT / "examples" / name],
            cwd=tmp_path,
            env={**os.environ, **small},
            capture_output=True,
            text=True,
            encoding="utf-8",
            check=False,
        )
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run


def test_parameter_sweep(example, tmp_path):
    printed = example("parameter_sweep.py")
    rows = re.findall(r"^ +(\d+) +([\d.]+) +([\d.]+) +([\d.]+)$", printed, re.MULTILINE)
    assert len(rows) == 3
    for _, swing, closed_form, transmission in rows:
        # The two ends of the swing lie between samples, 3 deg = 0.0524 rad of the crank off at
        # most; there the rocker's angle is level, with a second derivative with respect to the
        # crank's below 1/rad for these lengths. The digits shown are rounded.
        most = 2 * 0.5 * 0.0524**2 * 57.3 + 1e-3
        assert -1e-3 <= float(closed_form) - float(swing) <= most
        assert 0 < float(transmission) < 90
    assert (tmp_path / "parameter_sweep.png").stat().st_size > 10_000


def test_dask_sweep(example, tmp_path):
    printed = example("dask_sweep.py")
    assert re.search(r"^ 2 processes .* same bits$", printed, re.MULTILINE), printed
    assert "cranks turn fully, as Grashof says" in printed
    error = float(re.search(r"closed form (\S+) rad", printed)[1])
    # The transmission angle comes out as a difference of two angles, each exact to some 1e-15;
    # the arc cosine of the closed form loses as much again.
    assert error < 1e-12
    assert (tmp_path / "dask_sweep.png").stat().st_size > 10_000


def test_sweep_on_dask(example):
    printed = example("sweep_on_dask.py")
    assert printed.count("same bits") == 3, printed
    lengths = np.linspace(0.151, 0.60, 12)
    coupler, rocker = np.meshgrid(lengths, lengths)
    # Grashof: the crank, 100 mm on a base of 400 mm, is the shortest link and turns fully.
    turns = (np.abs(coupler - rocker) < 0.3) & (0.5 < coupler + rocker)
    assert f"{np.count_nonzero(turns)} cranks turn fully" in printed


def test_dc_motor(example, tmp_path):
    printed = example("dc_motor.py")
    difference = float(re.search(r"by hand: (\S+)", printed)[1])
    # Rounding of 500 Runge-Kutta steps of a stable motion.
    assert difference < 1e-12
    low, high = map(float, re.search(r"between ([\d.]+) and ([\d.]+) rad/s", printed).groups())
    assert 0 < low < high
    coupled = re.findall(r"^(\w+) with a step of .* off by ([\d.]+) rad/s", printed, re.MULTILINE)
    for host in ("FMPy", "Ecos"):
        coarse, fine = (float(off) for name, off in coupled if name == host)
        # Inputs held over a step: the next term is a part of the step's size.
        assert 1.8 < coarse / fine < 2.2, printed
    assert (tmp_path / "dc_motor.png").stat().st_size > 10_000


def test_crane(example, tmp_path):
    printed = example("system/crane.py")
    rows = re.findall(r"^(\w+ +[a-z =2]+?) +([\d.]+) +([\d.]+) +([\d.]+)$", printed, re.MULTILINE)
    off = {(host, float(step)): float(stroke) for host, step, stroke, _ in rows}
    hosts = {host for host, _ in off}
    assert len(hosts) == 3, printed
    for host in hosts:
        # Of first order; the digits shown have an error of 1 % at most.
        assert 1.8 < off[host, 2.0] / off[host, 1.0] < 2.2, printed
    assert (tmp_path / "crane.png").stat().st_size > 10_000


def test_press(example, tmp_path):
    printed = example("system/press.py")
    exchanged = float(re.search(r"off by (\S+) at most", printed)[1])
    # Rounding of 8000 Runge-Kutta steps of a stable motion.
    assert exchanged < 1e-12
    rows = re.findall(r"^(\w+) +([\d.]+) +([\d.]+) +([\d.]+) +([\d.]+)$", printed, re.MULTILINE)
    off = {(host, step): np.array(rest, dtype=float) for host, step, *rest in rows}
    for host in ("FMPy", "Ecos"):
        coarse, middle, fine = (off[host, step] for step in ("2.0", "1.0", "0.5"))
        # Inputs held over a step: the next term is a part of the step's size.
        for ratio in (coarse / middle, middle / fine):
            assert np.all((ratio > 1.8) & (ratio < 2.2)), printed
        # The controller keeps 10 rad/s.
        assert fine[0] < 0.002 * 10, printed
    assert (tmp_path / "press.png").stat().st_size > 10_000


def test_requirements_are_those_of_the_lock():
    """The pins in examples/requirements.txt are versions that the tests run with."""
    lock = (ROOT / "tests" / "fmpy" / "requirements.txt").read_text(encoding="utf-8")
    pins = (ROOT / "examples" / "requirements.txt").read_text(encoding="utf-8")
    for pin in re.findall(r"^\w.*$", pins, re.MULTILINE):
        assert re.search(rf"^{re.escape(pin)} ", lock, re.MULTILINE), pin
