"""FMPy and pandas read the output of `biela run` as it is."""

import math

import numpy as np
import pandas
from fmpy.util import read_csv
from harness import ROOT, run_biela


def test_fmpy_and_pandas_read_the_same(tmp_path):
    mechanism = ROOT / "mechanisms" / "four_bar.toml"
    results = tmp_path / "results.csv"
    motion = "crank_angle = 60*deg + 10*t"
    done = run_biela("run", mechanism, "-d", motion, "--stop", 0.5, "--step", 0.01, "-o", results)
    assert done.returncode == 0, done.stderr

    table = pandas.read_csv(results)
    array = read_csv(results)
    assert list(table.columns) == list(array.dtype.names)
    assert all(kind == np.float64 for kind in table.dtypes)
    for name in table.columns:
        assert np.array_equal(table[name].to_numpy(), array[name]), name
    assert len(table) == 51
    # Decimal numbers are written so that they are read back to the last bit; the sum has one
    # rounding, and 60° another one.
    crank = math.pi / 3 + 10 * table["time"]
    assert np.abs(table["crank.phi"] - crank).max() <= 4 * np.finfo(float).eps * crank.max()
