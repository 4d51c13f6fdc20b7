"""The demo runs, says so in its exit status, and writes what it promises."""

import os
import subprocess
import sys

from closed_form import CLOSED_FORMS
from fmpy.validation import validate_fmu
from harness import ROOT, program


def run_demo(out, biela):
    return subprocess.run(
        [sys.executable, ROOT / "demo" / "demo.py", "--out", out],
        capture_output=True,
        text=True,
        encoding="utf-8",
        env={**os.environ, "BIELA_BIN": str(biela), "PYTHONIOENCODING": "utf-8"},
    )


def test_demo(tmp_path):
    done = run_demo(tmp_path / "out", program())
    assert done.returncode == 0, done.stdout + done.stderr
    for name in CLOSED_FORMS:
        (row,) = [line for line in done.stdout.splitlines() if line.startswith(f"{name} ")]
        assert " valid " in row
        assert validate_fmu(str(tmp_path / "out" / f"{name}.fmu")) == []
        picture = (tmp_path / "out" / f"{name}.png").read_bytes()
        assert picture.startswith(b"\x89PNG")
        assert len(picture) > 50_000, "not an empty page"
    assert "simulate_fmu(" in done.stdout, "how to load one"


def test_demo_without_a_program(tmp_path):
    missing = tmp_path / "biela"
    done = run_demo(tmp_path / "out", missing)
    assert done.returncode == 2
    assert str(missing) in done.stderr
    assert "make build" in done.stderr


def test_demo_fails_when_an_error_exceeds_its_limit(tmp_path, monkeypatch, capsys):
    """With limits nothing can meet every row says what is wrong and the status is 1."""
    import demo

    monkeypatch.setattr(demo, "LIMITS", {"position": 0.0, "velocity": 0.0, "acceleration": 0.0})
    monkeypatch.setenv("BIELA_BIN", str(program()))
    monkeypatch.setattr(sys, "argv", ["demo.py", "--out", str(tmp_path)])
    assert demo.main() == 1
    printed = capsys.readouterr().out
    assert printed.count("exceeds its limit") >= len(CLOSED_FORMS)
