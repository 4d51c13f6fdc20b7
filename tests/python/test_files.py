"""Commands of the program as functions: mechanisms from data and from other programs, files for others,
reports, pages, pictures."""

from __future__ import annotations

import pickle
import subprocess
import sys
import warnings
import zipfile
from xml.etree import ElementTree as xml

import biela
import numpy as np
import pytest
from numpy.testing import assert_allclose
from shipped import MECHANISMS, ROOT

try:
    import tomllib
except ModuleNotFoundError:
    tomllib = None


@pytest.mark.skipif(tomllib is None, reason="Python 3.11 reads TOML")
@pytest.mark.parametrize("path", MECHANISMS, ids=lambda path: path.stem)
def test_data_mean_the_same_mechanism(path):
    text = path.read_text(encoding="utf-8")
    if ".csv" in text:
        pytest.skip("the table is beside the file")
    data = tomllib.loads(text)
    own, again = biela.load(path), biela.loads(data)
    assert tomllib.loads(again.text) == data
    assert again.variables == own.variables and again.check().data["ok"]
    poses = own.check().poses
    for body, pose in again.check().poses.items():
        np.testing.assert_array_equal(pose, poses[body])


def test_odd_data_are_refused_or_escaped():
    odd = 'é "\\ \x7f'
    assert biela.loads({"format": 1, "name": "a", "description": odd, **LEVER}).description == odd
    for wrong in (3, None, {"format": object()}, {1: 2}, ["format"]):
        with pytest.raises(biela.UsageError, match="expected"):
            biela.loads(wrong)
    assert [d.code for d in biela.check({"format": 1, "name": "a"}).diagnostics] == ["no-bodies"]
    numbers = biela.check({"format": np.int64(1), "name": "a", "ground": {"markers": {"O": np.zeros(2)}}})
    assert [d.code for d in numbers.diagnostics] == ["no-bodies"]


LEVER = {
    "ground": {"markers": {"O": [0, 0]}},
    "bodies": {"arm": {"markers": {"A": [0, 0]}}},
    "joints": {"O": {"type": "revolute", "markers": ["ground.O", "arm.A"]}},
    "drivers": {"angle": {"coordinate": "angle", "markers": ["ground.O", "arm.A"], "start": 0.5}},
}


def test_new_writes_a_mechanism_and_overwrites_none(tmp_path):
    path = biela.new("my_cam", "cam_points", tmp_path)
    assert path == tmp_path / "my_cam.toml" and (tmp_path / "cam_points.csv").is_file()
    assert biela.load(path).name == "my_cam"
    with pytest.raises(biela.UsageError, match="is there already"):
        biela.new("my_cam", "four_bar", tmp_path)
    with pytest.raises(biela.UsageError, match="did you mean `four_bar`"):
        biela.new("mine", "four_bra", tmp_path)
    with pytest.raises(biela.UsageError, match="`my-bar` is no name of a mechanism"):
        biela.new("my-bar", folder=tmp_path)
    with pytest.raises(biela.FileError, match="cannot write"):
        biela.new("mine", folder=tmp_path / "none")


@pytest.mark.parametrize("to", ["pmks", "pylinkage", "linkage", "asmt"])
def test_a_mechanism_comes_back_from_other_programs(four_bar, tmp_path, to):
    """Angles over a turn are those before, to the 10 µm in 0.1 m that a link of PMKS+ has."""
    extension = {"pylinkage": "json", "linkage": "linkage2"}.get(to, to)
    file, toml = tmp_path / f"x.{extension}", tmp_path / "back.toml"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", biela.MechanismWarning)
        text = four_bar.convert(to, file)
        back = biela.import_mechanism(text.strip() if to == "pmks" else file, toml)
    assert toml.read_text(encoding="utf-8") == back.text
    assert file.read_bytes().decode("utf-8") == text

    def swings(mechanism):
        (name,) = mechanism.range(mechanism._coordinates[0]).driver.split()
        start = mechanism.drivers[name].start or 0.0
        turn = start + np.linspace(0, 2 * np.pi, 181)
        result = mechanism.run(drive={name: turn})
        return sorted(np.ptp(result[f"{body}.phi"]) for body in mechanism.bodies)

    assert_allclose(swings(back), swings(four_bar), atol=2e-3 if to == "pmks" else 1e-6)


def test_what_no_other_program_has_is_refused(mechanism, four_bar, tmp_path):
    with pytest.raises(biela.UsageError, match="no program `pmsk`; did you mean `pmks`"):
        four_bar.convert("pmsk")
    with pytest.raises(biela.UsageError, match="`contact` has no counterpart there"):
        mechanism("cam_points").convert("pmks")
    with pytest.raises(biela.FileError, match="cannot read"):
        biela.import_mechanism(tmp_path / "none.json")
    (tmp_path / "x.json").write_text("{}", encoding="utf-8")
    with pytest.raises(biela.FileError, match="x.json"):
        biela.import_mechanism(tmp_path / "x.json")
    with pytest.raises(biela.UsageError, match="no unit of lengths `feet`"):
        biela.import_mechanism(tmp_path / "x.json", length="feet")


def test_files_are_those_of_the_program(mechanism, tmp_path):
    """The same bytes, for the same values."""
    code = "import sys; sys.path.insert(0, sys.argv.pop(1)); import biela.__main__ as m; sys.exit(m.main())"

    def program(*arguments):
        command = [sys.executable, "-c", code, ROOT / "crates/python", *arguments]
        done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
        assert done.returncode == 0, done.stderr

    for name, drive in [("four_bar", "crank_angle=1.25"), ("pendulum_free", None), ("toggle_press", None)]:
        own = mechanism(name)
        file = ROOT / f"mechanisms/{name}.toml"
        given = ["--drive", drive] if drive else []
        motion = dict([drive.split("=")]) if drive else None
        program("report", file, "-o", "own.html", *given)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", biela.MechanismWarning)
            assert own.report(tmp_path / "r.html", motion).read_text() == (tmp_path / "own.html").read_text()
        for extension in ("svg", "png", "dxf"):
            program("draw", file, "-o", f"own.{extension}", *given)
            own.draw(motion, path=tmp_path / f"x.{extension}")
            found = [(tmp_path / f"{stem}.{extension}").read_bytes() for stem in ("own", "x")]
            assert found[0] == found[1], extension
        for fmi in (2, 3):
            program("export", file, "--fmi", str(fmi), "--model-description", "own.xml")
            assert own.model_description(fmi) == (tmp_path / "own.xml").read_text(encoding="utf-8")


def test_options_of_pictures_are_refused_for_the_workshop(four_bar, tmp_path):
    with pytest.raises(biela.UsageError, match="poses is of pictures"):
        four_bar.draw(poses=2, path=tmp_path / "x.dxf")
    with pytest.raises(biela.UsageError, match="neither the extension .svg nor .png"):
        four_bar.draw(path=tmp_path / "x.jpg")
    with pytest.raises(biela.FileError, match="there is no folder `.*none`"):
        four_bar.draw(path=tmp_path / "none/x.svg")
    narrow = four_bar.draw(poses=3, between=("20*deg", "40*deg"))
    assert narrow != four_bar.draw(poses=3, driver="crank_angle")


def test_a_page_needs_a_solver(four_bar, tmp_path):
    (tmp_path / "solver.wasm").write_bytes(b"\0asm and more")
    path = four_bar.page(tmp_path / "x.html", solver=tmp_path / "solver.wasm", share="solver.js")
    assert path == tmp_path / "x.html" and 'src="solver.js"' in path.read_text(encoding="utf-8")
    assert (tmp_path / "solver.js").is_file()
    (tmp_path / "wrong.wasm").write_bytes(b"no solver")
    with pytest.raises(biela.UsageError, match="is no solver for pages"):
        four_bar.page(tmp_path / "y.html", solver=tmp_path / "wrong.wasm")
    with pytest.raises(biela.UsageError, match="must be the plain name of a file"):
        four_bar.page(tmp_path / "y.html", solver=tmp_path / "solver.wasm", share="../solver.js")


def test_a_system_holds_the_fmu(four_bar, tmp_path):
    (tmp_path / "linux64").mkdir()
    (tmp_path / "linux64/biela.so").write_bytes(b"\x7fELF")
    system = four_bar.export(tmp_path / "x.ssp", runtime=tmp_path, ssp=True, page=False)
    fmu = four_bar.export(tmp_path / "x.fmu", runtime=tmp_path, page=False)
    with zipfile.ZipFile(system) as archive:
        (name,) = (name for name in archive.namelist() if name.endswith(".fmu"))
        assert archive.read(name) == fmu.read_bytes()
    with pytest.raises(biela.FileError, match="a system of SSP 1.0 holds FMUs of FMI 2.0"):
        four_bar.export(tmp_path / "x.ssp", runtime=tmp_path, ssp=True, fmi=3)
    with pytest.raises(biela.FileError, match="there is no folder"):
        four_bar.export(tmp_path / "none/x.fmu", runtime=tmp_path)
    (linux,) = (p for p in biela.platforms(tmp_path) if p.library is not None)
    assert linux.name == "linux64" and linux.library.endswith("biela.so")


def test_the_schema_is_that_of_the_program():
    assert {"bodies", "joints"} <= set(biela.schema()["properties"])


def test_the_effort_of_a_press_is_that_of_runs(mechanism):
    """The largest effort of the range is at least that of any pose, and that of the pose where it is."""
    arm = mechanism("excavator_arm")
    found = arm.range("boom_cylinder")
    effort = lambda value: arm.run(drive={"boom_cylinder": value})["boom_cylinder.effort"]
    inner = found.values[1:-1]
    # Rounding of the poses times the condition number, a thousand at most.
    assert abs(found.effort.value) >= np.abs(effort(inner)).max() * (1 - 1e-12)
    assert_allclose(effort([found.effort.at])[0], found.effort.value, rtol=1e-9)
    at = arm.run(drive={"boom_cylinder": [found.reaction.at]})
    joint = found.reaction.joint
    assert_allclose(np.hypot(at[f"{joint}.fx"], at[f"{joint}.fy"])[0], found.reaction.value, rtol=1e-9)
    fast = arm.range("boom_cylinder", speed=0.5)
    assert fast.speed == 0.5 and fast.effort.value != found.effort.value


def test_motions_are_swept(four_bar, mechanism):
    angles = np.radians([30, 60, 90])
    sweep = four_bar.sweep({"base": [0.40, 0.42]}, drive={"crank_angle": angles[:, None]}, outer=True)
    assert sweep.shape == (2, 3) and sweep.ok.all()
    for i, base in enumerate([0.40, 0.42]):
        for j, angle in enumerate(angles):
            own = four_bar.run(drive={"crank_angle": [angle]}, parameters={"base": base})
            assert sweep["rocker.phi"][i, j, 0] == own["rocker.phi"][0]
    t = np.linspace(0, 1, 21)
    speeds = np.array([[1.0], [2.0]])
    turning = four_bar.sweep(t=t, drive={"crank_angle": 1 + speeds * t})
    for k in range(2):
        own = four_bar.run(t=t, drive={"crank_angle": 1 + speeds[k] * t})
        for name in ("rocker.phi", "rocker.omega", "rocker.alpha"):
            np.testing.assert_array_equal(turning[name][k], own[name])
    assert turning.to_pandas().index.names == ["variant", "time"]
    assert turning.to_xarray()["rocker.phi"].dims == ("variant", "time")
    torque = mechanism("slider_crank_motor")
    pushed = torque.sweep(t=t, inputs={"motor.effort": np.array([[1.0], [2.0]])}, variables=["crank.phi"])
    for k, size in enumerate([1.0, 2.0]):
        own = torque.run(t=t, inputs={"motor.effort": np.full(21, size)}, variables=["crank.phi"])
        np.testing.assert_array_equal(pushed["crank.phi"][k], own["crank.phi"])
    lost = four_bar.sweep(drive={"crank_angle": [[1.0], [np.nan]]})
    assert lost.ok.tolist() == [True, False] and "finite" in lost.reason(1)
    for wrong in (np.ones((2, 3)), np.ones((3, 21, 2))):
        with pytest.raises(biela.UsageError, match="drive: `crank_angle` has . values for 21 times"):
            four_bar.sweep(t=t, drive={"crank_angle": wrong})
    with pytest.raises(biela.UsageError, match="shapes do not fit together"):
        four_bar.sweep({"base": [0.4, 0.41, 0.42]}, drive={"crank_angle": np.ones((2, 1))})


def test_a_result_is_what_pandas_takes(four_bar):
    pandas = pytest.importorskip("pandas")
    result = four_bar.run(t=[0, 0.5, 1], drive={"crank_angle": "1 + t"})
    frame = pandas.DataFrame(result)
    assert list(frame.columns) == list(result) == list(four_bar.variables)
    np.testing.assert_array_equal(frame.to_numpy(), result.to_numpy())
    assert all(np.shares_memory(values, result.to_numpy()) for values in result.values())
    again = pickle.loads(pickle.dumps(result))
    assert again.to_html() == result.to_html() and list(again) == list(result)
    assert all(np.shares_memory(values, again.to_numpy()) for values in again.values())
    assert "time" in result and result["time"] is result.t


def test_what_notebooks_and_consoles_show_is_short(four_bar, mechanism):
    assert "<svg" in four_bar._repr_html_() and "<td>base</td><td>0.4</td><td>m</td>" in four_bar._repr_html_()
    shown = four_bar.check()._repr_html_()
    xml.fromstring(f"<div>{shown}</div>")
    assert "rocker" in shown and "closes" in shown
    broken = biela.check({"format": 1, "name": "a"})._repr_html_()
    assert "no-bodies" in broken
    pendulum = mechanism("pendulum_free")
    texts = [repr(four_bar.modes()), repr(four_bar.modes().others[0]), repr(pendulum.balance()), repr(pendulum.linearize())]
    assert all(text.startswith("<biela.") and len(text) < 120 for text in texts), texts
