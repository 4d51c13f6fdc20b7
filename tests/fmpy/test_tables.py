"""Tables in CSV files: they travel with the FMU and belong to its identity."""

import shutil
import zipfile

import fmpy
import pytest
from harness import ERROR, Fmu, Slave, export, mechanism_file, run_biela

CAM = mechanism_file("cam_points")


@pytest.fixture
def copy(tmp_path):
    """The cam's two files in a folder of their own; called with a change of the CSV's text."""

    def make(change=lambda text: text, folder="copy"):
        place = tmp_path / folder
        place.mkdir()
        shutil.copy(CAM, place)
        table = CAM.with_suffix(".csv").read_text(encoding="utf-8")
        (place / "cam_points.csv").write_text(change(table), encoding="utf-8")
        return place / CAM.name

    return make


def test_the_file_travels(copy, tmp_path):
    """The FMU runs where the mechanism's folder is gone."""
    path = copy()
    fmu = export(path, tmp_path / "cam.fmu")
    shutil.rmtree(path.parent)
    with zipfile.ZipFile(fmu) as archive:
        travelled = archive.read("resources/cam_points.csv")
    assert travelled == CAM.with_suffix(".csv").read_bytes()
    result = fmpy.simulate_fmu(str(fmu), stop_time=0.1, output=["lift.position"])
    # At 90° from the polar axis, in the table's row of 90°.
    assert result["lift.position"][-1] == pytest.approx(0.032172, abs=1e-15)


def guid(path, fmu):
    return fmpy.read_model_description(str(export(path, fmu))).guid


def test_values_are_in_the_guid_and_layout_is_not(copy, tmp_path):
    original = guid(CAM, tmp_path / "original.fmu")
    changes = {
        "comment": (lambda text: "# measured anew\n" + text, True),
        "layout": (lambda text: text.replace(",", " , "), True),
        "digits": (lambda text: text.replace("25.000", "25"), True),
        "value": (lambda text: text.replace("32.172", "32.173"), False),
        "point": (lambda text: text.replace("\n350,25.000", ""), False),
    }
    for name, (change, same) in changes.items():
        changed = guid(copy(change, name), tmp_path / f"{name}.fmu")
        assert (changed == original) == same, name


def test_rows_belong_to_their_table(tmp_path):
    """The same rows divided between two tables in another way are another mechanism."""
    text = """
        format = 1
        name = "two_tables"
        [ground.markers]
        O = [0, 0]
        [bodies.a]
        markers = { O = [0, 0] }
        [bodies.b]
        markers = { O = [0, 0] }
        [joints]
        way = { type = "translational", markers = ["ground.O", "a.O"] }
        other = { type = "translational", markers = ["ground.O", "b.O"] }
        [drivers]
        x = { coordinate = "x", markers = ["ground.O", "a.O"], motion = { file = "a.csv" } }
        y = { coordinate = "x", markers = ["ground.O", "b.O"], motion = { file = "b.csv" } }
    """
    rows = ["0,1", "1,2", "2,3", "3,4", "4,5"]
    found = set()
    for first in (2, 3):
        folder = tmp_path / str(first)
        folder.mkdir()
        (folder / "two_tables.toml").write_text(text, encoding="utf-8")
        (folder / "a.csv").write_text("\n".join(rows[:first]), encoding="utf-8")
        (folder / "b.csv").write_text("\n".join(rows[first:]), encoding="utf-8")
        found.add(guid(folder / "two_tables.toml", folder / "two_tables.fmu"))
    assert len(found) == 2


def test_a_changed_table_is_refused(tmp_path, messages):
    """As with the mechanism file, nothing in `resources` may differ from what the XML describes."""
    folder = tmp_path / "cam"
    fmu = Fmu.unpack(export(CAM, tmp_path / "cam.fmu"), folder)
    table = folder / "resources" / "cam_points.csv"
    table.write_text(table.read_text(encoding="utf-8").replace("32.172", "32.173"))
    with pytest.raises(Exception, match="instantiate"):
        Slave(fmu, messages=messages)
    assert any("guid" in text.lower() for text in messages.texts(ERROR)), messages
    table.unlink()
    with pytest.raises(Exception, match="instantiate"):
        Slave(fmu, messages=messages)
    assert any("cam_points.csv" in text for text in messages.texts(ERROR)), messages


def test_a_missing_file_is_named(copy):
    path = copy()
    path.with_suffix(".csv").unlink()
    done = run_biela("check", path)
    assert done.returncode != 0
    assert "cannot read the file `cam_points.csv`" in done.stderr
    assert "cam_points.toml:" in done.stderr


def test_a_hollow_is_warned_of(tmp_path):
    """A roller that does not fit into a hollow: told by `check`, which succeeds all the same."""
    text = mechanism_file("cam_roller").read_text(encoding="utf-8")
    start = text.index("profile = ")
    path = tmp_path / "hollow.toml"
    path.write_text(
        text[:start]
        + 'profile = "0.04 + eccentricity*cos(2*theta) + 0*disc_radius"\n'
        + text[text.index("\n", start) + 1 :],
        encoding="utf-8",
    )
    done = run_biela("check", path)
    assert done.returncode == 0, done.stderr
    # At 90° R = 25 mm and R″ = 60 mm: the radius of curvature is R³/(R R″ − R²) = 17.857 mm.
    assert "warning" not in done.stderr
    wide = path.read_text(encoding="utf-8").replace("value = 0.010,", "value = 0.018,")
    path.write_text(wide, encoding="utf-8")
    done = run_biela("check", path)
    assert done.returncode == 0, done.stderr
    assert "warning" in done.stderr
    assert "goes down to 0.017857 m" in done.stderr
