"""Results as tables of pandas and as datasets of xarray."""

from __future__ import annotations

import sys

import biela
import numpy as np
import pytest
from numpy.testing import assert_array_equal

CRANK, BASE = np.array([0.08, 0.1]), np.array([0.38, 0.4, 0.42])
TIMES = [0.0, 0.5]


@pytest.fixture(scope="module")
def result(four_bar):
    """A motion in time."""
    variables = ["rocker", "transmission"]
    return four_bar.run(t=TIMES, drive={"crank_angle": "1 + t"}, variables=variables)


@pytest.fixture(scope="module")
def poses(four_bar):
    """Poses without times."""
    return four_bar.run(drive={"crank_angle": [1.0, 1.1, 1.2]})


@pytest.fixture(scope="module")
def grid(four_bar):
    """A grid of two parameters, at a value of a third one, in time."""
    crank, base = np.meshgrid(CRANK, BASE, indexing="ij")
    parameters = {"crank_length": crank, "base": base, "rocker_length": 0.31, "coupler_length": "250*mm"}
    drive = {"crank_angle": "1 + t"}
    return four_bar.sweep(parameters, t=TIMES, drive=drive, variables=["rocker.phi", "rocker.omega"])


def test_a_data_frame_has_the_times_as_index(result):
    frame = result.to_pandas()
    assert list(frame.columns) == list(result)
    assert list(result)[0] == "rocker.x" and list(result)[-1] == "transmission.acceleration"
    assert frame.index.name == "time" and list(frame.index) == TIMES
    assert frame["rocker.phi"].loc[0.5] == result["rocker.phi"][1]
    assert result.units["rocker.alpha"] == "rad/s2"


def test_poses_without_times_are_numbered(poses):
    frame = poses.to_pandas()
    assert frame.index.name == "pose" and list(frame.index) == [0, 1, 2]
    assert not poses.timed


def test_a_sweep_is_a_data_frame_with_a_level_per_parameter(grid):
    frame = grid.to_pandas()
    assert list(frame.index.names) == ["crank_length", "base", "rocker_length", "time"]
    assert list(frame.columns) == ["rocker.phi", "rocker.omega"]
    for name in frame:
        assert_array_equal(frame[name], grid[name].reshape(-1))
    assert frame["rocker.phi"].loc[0.1, 0.42, 0.31, 0.5] == grid["rocker.phi"][1, 2, 1]


def test_a_sweep_of_equal_times_and_values_is_a_data_frame(four_bar):
    sweep = four_bar.sweep(
        {"base": [0.4, 0.42, 0.4]}, t=[0.0, 0.0], drive={"crank_angle": "1 + t"}, variables="rocker.phi"
    )
    frame = sweep.to_pandas()
    assert_array_equal(frame["rocker.phi"], sweep["rocker.phi"].reshape(-1))
    assert list(frame.index) == [(0.4, 0.0)] * 2 + [(0.42, 0.0)] * 2 + [(0.4, 0.0)] * 2


def test_a_sweep_of_no_arrays_has_the_index_of_a_run(four_bar):
    sweep = four_bar.sweep({"base": "410*mm"}, drive={"crank_angle": [1.0, 1.1]}, variables="rocker.phi")
    frame = sweep.to_pandas()
    assert frame.index.name == "pose" and list(frame["rocker.phi"]) == list(sweep["rocker.phi"])


def test_a_dataset_has_units_and_times(result, poses):
    pytest.importorskip("xarray")
    data = result.to_xarray()
    assert list(data) == list(result) and data.sizes == {"time": 2}
    assert data.time.attrs == {"units": "s"} and list(data.time) == TIMES
    assert data["rocker.alpha"].attrs == {"units": "rad/s2"}
    assert data["rocker.phi"].sel(time=0.5) == result["rocker.phi"][1]
    assert poses.to_xarray().sizes == {"pose": 3} and not poses.to_xarray().coords


def test_a_sweep_over_a_grid_is_a_dataset_over_its_parameters(grid):
    pytest.importorskip("xarray")
    data = grid.to_xarray()
    assert data["rocker.phi"].dims == ("crank_length", "base", "time")
    assert_array_equal(data.crank_length, CRANK)
    assert_array_equal(data.base, BASE)
    assert data.base.attrs == {"units": "m"} and data.rocker_length == 0.31
    at = data["rocker.phi"].sel(crank_length=0.1, base=0.42, time=0.5)
    assert at == grid["rocker.phi"][1, 2, 1]


@pytest.mark.parametrize(
    ("parameters", "dims"),
    [
        ({"base": BASE}, ("base",)),
        ({"base": BASE, "rocker_length": 0.31}, ("base",)),
        ({"base": [0.4]}, ("base",)),
        ({"base": [0.4, 0.4]}, ("base",)),
        ({"base": BASE, "crank_length": BASE / 4}, ("variant",)),
        ({"base": BASE[:, None], "crank_length": CRANK}, ("base", "crank_length")),
        ({"base": [BASE, BASE], "crank_length": [BASE / 4, BASE / 5]}, ("variant_0", "base")),
        ({"base": 0.41}, ()),
    ],
)
def test_axes_of_a_sweep_have_the_name_of_their_parameter(four_bar, parameters, dims):
    pytest.importorskip("xarray")
    sweep = four_bar.sweep(parameters, drive={"crank_angle": [1.0]}, variables="rocker.phi")
    data = sweep.to_xarray()
    assert data["rocker.phi"].dims == (*dims, "pose")
    assert_array_equal(data["rocker.phi"], sweep["rocker.phi"])
    for name, values in sweep.parameters.items():
        assert_array_equal(data[name].broadcast_like(data["rocker.phi"].isel(pose=0)), values)


@pytest.mark.parametrize("package", ["pandas", "xarray"])
def test_a_missing_package_is_named(result, grid, monkeypatch, package):
    monkeypatch.setitem(sys.modules, package, None)
    text = f"^to_{package} needs the package {package}: pip install {package}$"
    for motion in (result, grid):
        with pytest.raises(ImportError, match=text) as raised:
            getattr(motion, f"to_{package}")()
        assert isinstance(raised.value, biela.UsageError) and raised.value.name == package
