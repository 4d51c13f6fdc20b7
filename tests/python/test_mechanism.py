"""Mechanisms: files, reports, ranges, modes, pictures, FMUs."""

from __future__ import annotations

import doctest
import importlib
import pickle
import re
import subprocess
import sys
import xml.etree.ElementTree as xml

import biela
import fmpy
import fmpy.validation
import numpy as np
import pytest
from shipped import ROOT
from numpy.testing import assert_allclose

MODULES = ["biela", *(f"biela.{path.stem}" for path in (ROOT / "crates/python/biela").glob("[!_]*.py"))]


def test_errors_of_a_file_are_diagnostics(tmp_path):
    file = tmp_path / "wrong.toml"
    text = (ROOT / "mechanisms/four_bar.toml").read_text(encoding="utf-8")
    file.write_text(text.replace('"crank.A", "coupler.A"', '"cranck.A", "coupler.A"'), encoding="utf-8")
    with pytest.raises(biela.MechanismError, match="did you mean `crank`") as raised:
        biela.load(file)
    (problem,) = raised.value.diagnostics
    line = 1 + text[: text.index('"crank.A", "coupler.A"')].count("\n")
    assert (problem.severity, problem.code, problem.line) == ("error", "unknown-body", line)
    assert f"{file}:{line}:" in str(raised.value)
    again = pickle.loads(pickle.dumps(raised.value))
    assert again.diagnostics == raised.value.diagnostics and str(again) == str(raised.value)
    assert biela.check(file).diagnostics == (problem,)


@pytest.mark.parametrize("read", [biela.load, biela.check])
def test_a_missing_file_is_told(tmp_path, read):
    with pytest.raises(FileNotFoundError, match="cannot read `.*none.toml`: No such file") as raised:
        read(tmp_path / "none.toml")
    assert isinstance(raised.value, biela.FileError)
    # A folder is there, and cannot be read.
    with pytest.raises(biela.FileError, match="cannot read") as raised:
        read(tmp_path)
    assert not isinstance(raised.value, FileNotFoundError)


def test_warnings_of_a_file_are_warnings():
    text = (ROOT / "mechanisms/four_bar.toml").read_text(encoding="utf-8")
    with pytest.warns(biela.MechanismWarning, match="unused"):
        mechanism = biela.loads(text.replace("[parameters]", "[parameters]\nspare = 1"))
    assert [problem.code for problem in mechanism.diagnostics] == ["unused-parameter"]


def test_a_report_has_the_pose(four_bar):
    report = four_bar.check(modes=True)
    assert report.ok and report.error is None and report.degrees_of_freedom == 1
    assert_allclose(np.degrees(report.poses["rocker"][2]), 122.824_780, atol=1e-6)
    assert report.rcond > 0.01 and report.residual < 1e-12 and report.warnings == ()
    assert report.data["assembled"]["modes"]["complete"]


def test_motions_beyond_limits_are_warnings_of_a_report():
    text = (ROOT / "mechanisms/four_bar.toml").read_text(encoding="utf-8")
    assert 'start = "60*deg"' in text
    mechanism = biela.loads(text.replace('start = "60*deg"', 'motion = "1 + t", max = 1.5'))
    (warning,) = mechanism.check().warnings
    assert "beyond its `max` = 1.5" in warning


def test_attributes_tell_the_file(four_bar):
    assert four_bar.name == "four_bar" and four_bar.bodies == ["crank", "coupler", "rocker"]
    base = four_bar.parameters["base"]
    assert (base.value, base.unit, base.min, base.derived) == (0.4, "m", 0.001, False)
    assert_allclose(four_bar.drivers["crank_angle"].start, np.radians(60))
    assert four_bar.variables["rocker.alpha"] == "rad/s2"


def test_the_range_of_a_triangle_ends_at_dead_points(mechanism):
    """A triangle with sides a, b closes for third sides from |a - b| to a + b."""
    triangle = mechanism("tlv")
    found = triangle.range("side_length")
    values = {name: p.value for name, p in triangle.parameters.items()}
    sides = sorted(values.values())[-2:]
    assert found.lower.kind == found.upper.kind == "singular" and not found.turns
    report = triangle.check()
    assert found.lower.value < found.values[0] + 1e-6
    assert found.poses[triangle.bodies[0]].shape == (len(found.values), 3)
    assert report.ok and len(sides) == 2
    # The ends are samples: there the transmission angle is zero.
    assert [found.values[0], found.values[-1]] == [found.lower.value, found.upper.value]
    assert_allclose(found.transmission[[0, -1]], 0, atol=1e-7)
    assert "body `arm` and body `rod` line up" in found.lower.text


def test_a_range_ends_at_stops(mechanism):
    """The bolt is 0.03 m times the sine of the handle's angle from its middle place."""
    latch = mechanism("latch")
    found = latch.range("handle_angle")
    assert found.lower.kind == found.upper.kind == "stop"
    assert_allclose([found.lower.value, found.upper.value], [np.radians(-40), np.arcsin(2 / 3)])
    assert "stop `strike` reached: throw = 0.020000000 m" in found.upper.text
    with pytest.raises(biela.StoppedError, match="stop `strike` reached"):
        latch.run(t=np.linspace(0, 1, 11), drive={"handle_angle": "t"})


def test_a_range_has_the_extremes_of_measures(four_bar):
    """Coupler and rocker span 0.3 m or 0.5 m where the crank lies along the base."""
    found = four_bar.range("crank_angle")
    least, greatest = found.extremes["transmission"]
    a, b = 0.25, 0.3
    angle = lambda d: np.arccos((a**2 + b**2 - d**2) / (2 * a * b))
    assert_allclose([least.value, greatest.value], [angle(0.3), angle(0.5)], rtol=1e-14)
    assert_allclose(greatest.at, np.pi, rtol=1e-13)
    sampled = found.measures["transmission"]
    assert len(sampled) == len(found.values)
    assert least.value <= sampled.min() and sampled.max() <= greatest.value


def test_a_range_is_found_between_two_values(four_bar):
    found = four_bar.range("crank_angle", between=(0.5, 2.0))
    assert (found.lower.kind, found.upper.kind) == ("bound", "bound")
    assert_allclose([found.lower.value, found.upper.value], [0.5, 2.0], rtol=1e-14)
    assert four_bar.range("crank_angle", between=(0.5, None)).lower.value == found.lower.value
    again = four_bar.range("crank_angle", between=("0.5*base/(400*mm)", "2"))
    assert_allclose([again.lower.value, again.upper.value], [0.5, 2.0], rtol=1e-14)
    with pytest.raises(biela.UsageError, match="between: no parameter `a`"):
        four_bar.range("crank_angle", between=("a", None))
    with pytest.raises(biela.UsageError, match=r"between\[0\], 2, must be less than between\[1\], 0.5"):
        four_bar.range("crank_angle", between=(2, 0.5))
    with pytest.raises(biela.UsageError, match="speed is of forces"):
        four_bar.range("crank_angle", speed=1.0)
    for between in [(0.5,), (0.5, np.nan), 1.0]:
        with pytest.raises(biela.UsageError, match="between: expected"):
            four_bar.range("crank_angle", between=between)


def test_the_library_has_the_shipped_mechanisms(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shipped = sorted(path.stem for path in (ROOT / "mechanisms").glob("*.toml"))
    assert sorted(biela.library()) == shipped
    cam = biela.library("cam_points")
    again = pickle.loads(pickle.dumps(cam))
    assert again.text == cam.text == (ROOT / "mechanisms/cam_points.toml").read_text(encoding="utf-8")
    assert_allclose(cam.changed().check().residual, 0, atol=1e-9)
    with pytest.raises(biela.UsageError, match="no shipped mechanism `four_bra`; did you mean `four_bar`"):
        biela.library("four_bra")


def test_a_crank_turns_fully(four_bar):
    found = four_bar.range("crank_angle", drive={"crank_angle": 1.0})
    assert found.turns and found.upper.turns == 1
    assert repr(found) == "<biela.Range of crank_angle: no limit to no limit>"
    with pytest.raises(biela.UsageError, match="did you mean `crank_angle`"):
        four_bar.range("crank")
    with pytest.raises(biela.UsageError, match="drive: expected one number as `crank_angle`"):
        four_bar.range("crank_angle", drive={"crank_angle": [1.0, 2.0]})


def test_the_other_mode_of_a_four_bar_mirrors_the_dyad(four_bar):
    modes = four_bar.modes()
    (other,) = modes.others
    own = four_bar.check().poses
    assert modes.complete
    joint = lambda poses: poses["rocker"][:2] + 0.3 * np.array(
        [np.cos(poses["rocker"][2]), np.sin(poses["rocker"][2])]
    )
    for poses in (own, other.poses):
        assert_allclose(np.hypot(*(joint(poses) - poses["coupler"][:2])), 0.25, rtol=1e-12)
    assert abs(joint(own) - joint(other.poses)).max() > 0.1


def test_pictures_are_shown_in_notebooks(four_bar):
    drawing = four_bar.draw(drive={"crank_angle": 2.0}, width=300)
    assert xml.fromstring(drawing).tag.endswith("svg") and drawing._repr_svg_() == drawing
    assert four_bar._repr_svg_() != drawing
    full = four_bar.draw(poses=4, driver="crank_angle", dimensions=True, instant_centres=True)
    assert 'class="poses"' in full and "lengths in mm" in full and "I coupler" in full
    with pytest.raises(biela.UsageError, match="did you mean `crank_angle`"):
        four_bar.draw(poses=4, driver="crank_angel")
    with pytest.raises(biela.UsageError, match="poses: expected a whole number, at least 0"):
        four_bar.draw(poses=-3)
    result = four_bar.run(t=[0, 0.1, 0.3], drive={"crank_angle": "1 + t"})
    assert "four_bar" in result.to_html() and result._repr_html_().startswith("<iframe srcdoc=")
    assert four_bar.run(drive={"crank_angle": [1.0, 1.1]}).to_html()


def test_paths_in_a_film_have_all_poses_of_uneven_times(four_bar):
    # Moments with equal times between them would have 4 of the first 51 poses.
    times = [*np.linspace(0, 0.5, 51), 10]
    angles = [*np.linspace(1, 6, 51), 6.1]
    page = four_bar.run(t=times, drive={"crank_angle": angles}).to_html()
    path = re.search(r'<g class="traces"[^>]*><path d="M([^"]*)"', page).group(1)
    assert len(set(path.split("L"))) == len(times)


def test_an_exported_fmu_has_the_motion_of_the_module(four_bar, tmp_path):
    built = [ROOT / "target" / kind / "libbiela_runtime.so" for kind in ("release", "debug")]
    built = [path for path in built if path.is_file()]
    if sys.platform != "linux" or not built:
        pytest.skip("no library was built for this platform")
    folder = tmp_path / "runtime" / "linux64"
    folder.mkdir(parents=True)
    newest = max(built, key=lambda path: path.stat().st_mtime)
    (folder / "biela.so").write_bytes(newest.read_bytes())
    path = four_bar.export(tmp_path / "four_bar.fmu", runtime=tmp_path / "runtime")
    assert not fmpy.validation.validate_fmu(str(path))
    t = np.linspace(0, 1, 11)
    signal = np.array([(s, 1 + 2 * s) for s in t], dtype=[("time", float), ("crank_angle.position", float)])
    simulated = fmpy.simulate_fmu(
        str(path), stop_time=1, output_interval=0.1, step_size=0.1, input=signal,
        output=["rocker.phi"], fmi_call_logger=None,
    )
    own = four_bar.run(t=t, drive={"crank_angle": 1 + 2 * t})
    # Held inputs lag by one step.
    assert_allclose(simulated["rocker.phi"][1:], own["rocker.phi"][:-1], rtol=1e-12)
    with pytest.raises(biela.FileError, match="no runtime library"):
        four_bar.export(tmp_path / "a.fmu", runtime=tmp_path)


def test_mechanisms_travel_to_other_processes(mechanism):
    for name in ("four_bar", "cam_points"):
        own = mechanism(name)
        again = pickle.loads(pickle.dumps(own))
        assert again.text == own.text and again.variables == own.variables


def test_the_program_is_the_module():
    command = [sys.executable, "-c", "import sys; sys.path.insert(0, sys.argv.pop(1)); "
               "import biela.__main__ as m; assert 'numpy' not in sys.modules; sys.exit(m.main())"]
    run = lambda *arguments: subprocess.run(
        [*command, ROOT / "crates/python", *arguments], capture_output=True, text=True
    )
    assert run("--version").stdout.strip() == f"biela {biela.__version__}"
    assert run("check", "none.toml").returncode == 2


@pytest.mark.parametrize("name", MODULES)
def test_examples_of_docstrings_run(name, four_bar, mechanism):
    module = importlib.import_module(name)
    names = {
        "np": np,
        "biela": biela,
        "four_bar": four_bar,
        "pendulum": mechanism("pendulum_free"),
        "text": four_bar.text,
    }
    tests = doctest.DocTestFinder().find(module, extraglobs=names)
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE)
    for test in tests:
        runner.run(test, clear_globs=False)
    assert runner.failures == 0
