"""Systems of SSP: valid against the standard's schemas, and simulated by FMPy."""

import math
import zipfile
from pathlib import Path

import fmpy.ssp
import numpy as np
import pytest
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import read_ssd
from harness import ROOT, SHIPPED, run_biela
from lxml import etree

SCHEMAS = Path(fmpy.ssp.__file__).parent / "schema"


def schema(name):
    return etree.XMLSchema(etree.parse(str(SCHEMAS / name)))


@pytest.fixture(scope="module")
def ssp(tmp_path_factory):
    """Returns the system of a shipped mechanism."""
    folder = tmp_path_factory.mktemp("ssp")

    def export(name, *options):
        path = folder / f"{name}.ssp"
        mechanism = ROOT / "mechanisms" / f"{name}.toml"
        done = run_biela("export", mechanism, "--ssp", "--no-page", "-o", path, *options)
        assert done.returncode == 0, done.stderr
        return path

    return export


NAMES = [name for name in SHIPPED if name in {"four_bar", "engine_free", "excavator_arm", "hatch", "corexy", "andrews"}]


@pytest.mark.parametrize("name", NAMES)
def test_descriptions_are_valid(ssp, name):
    with zipfile.ZipFile(ssp(name)) as archive:
        assert archive.namelist() == [
            "SystemStructure.ssd",
            f"resources/{name}.ssv",
            f"resources/{name}.fmu",
        ]
        ssd = etree.fromstring(archive.read("SystemStructure.ssd"))
        ssv = etree.fromstring(archive.read(f"resources/{name}.ssv"))
    # Hosts look for these very prefixes.
    assert (ssd.prefix, ssv.prefix) == ("ssd", "ssv")
    schema("SystemStructureDescription.xsd").assertValid(ssd)
    schema("SystemStructureParameterValues.xsd").assertValid(ssv)
    # Each unit that is used is defined.
    for root in (ssd, ssv):
        used = {e.get("unit") for e in root.iter("{*}Real")} - {None}
        defined = {e.get("name") for e in root.iter("{*}Unit")}
        assert used == defined


def test_values_are_those_of_the_file(ssp):
    with zipfile.ZipFile(ssp("four_bar")) as archive:
        ssv = etree.fromstring(archive.read("resources/four_bar.ssv"))
    values = {
        parameter.get("name"): (float(parameter[0].get("value")), parameter[0].get("unit"))
        for parameter in ssv.iter("{*}Parameter")
    }
    assert values["crank_length"] == (0.1, "m")
    assert values["base"] == (0.4, "m")
    assert values["rates"] == (1.0, None)


def test_a_system_moves_as_the_mechanism(ssp):
    path = ssp("four_bar")
    description = read_ssd(path)
    assert [component.name for component in description.system.elements] == ["four_bar"]

    def crank(time):
        return math.radians(60) + time

    result = simulate_ssp(
        str(path),
        stop_time=1.0,
        step_size=0.01,
        input={"crank_angle.position": crank},
    )
    names = result.dtype.names
    assert {"rocker.phi", "four_bar.rocker.phi"} <= set(names)
    # Law of cosines: the rocker from the diagonal between crank pin and rocker pivot. Inputs reach the
    # FMU a step later.
    times = result["time"] - 0.01
    rows = slice(2, None)
    angle = np.radians(60) + times
    x, y = 0.1 * np.cos(angle), 0.1 * np.sin(angle)
    d = np.hypot(0.4 - x, y)
    inner = np.arccos((0.3**2 + d**2 - 0.25**2) / (2 * 0.3 * d))
    rocker = np.pi - np.arctan2(y, 0.4 - x) - inner
    assert np.abs(result["four_bar.rocker.phi"] - rocker)[rows].max() < 1e-12


def test_fmi_3_is_refused():
    done = run_biela("export", ROOT / "mechanisms" / "four_bar.toml", "--ssp", "--fmi", "3")
    assert done.returncode == 2
    assert "SSP 1.0" in done.stderr
