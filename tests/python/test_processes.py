"""Processes: forked and spawned children, what travels between them, and Ctrl-C."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import textwrap
import time

import biela
import numpy as np
import pytest
from numpy.testing import assert_array_equal
from shipped import ROOT

THETA = 1.0 + np.linspace(0, 2 * np.pi, 37)
BASE = np.linspace(0.36, 0.44, 101)
SOON = 1.0
"""Time within which Ctrl-C ends a call [s]."""
METHODS = [method for method in ("fork", "spawn") if method in multiprocessing.get_all_start_methods()]


def swing(base):
    """Sweeps the four-bar linkage and returns the rocker's angles."""
    four_bar = biela.load(ROOT / "mechanisms/four_bar.toml")
    return four_bar.sweep({"base": base}, drive={"crank_angle": THETA}, variables="rocker.phi")["rocker.phi"]


def stop(_):
    """Moves a triangle to its dead point."""
    triangle = biela.load(ROOT / "mechanisms/tlv.toml")
    drive = {name: f"{d.start!r} + 0.5*t" for name, d in triangle.drivers.items()}
    triangle.run(t=np.linspace(0, 10, 101), drive=drive)


@pytest.fixture(params=METHODS)
def pool(request):
    """Two processes, whose children find the module where this one does."""
    with multiprocessing.get_context(request.param).Pool(2) as pool:
        yield pool


def test_children_sweep_after_their_parent_has(pool):
    expected = swing(BASE)
    # A hang, as of threads that the fork has left behind, is an error after a minute.
    for found in pool.map_async(swing, [BASE] * 3).get(60):
        assert_array_equal(found, expected)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="the system does not fork")
def test_a_child_forked_after_a_sweep_sweeps():
    code = textwrap.dedent(
        """
        import os, sys, warnings
        sys.path[:0] = sys.argv[1:3]
        from test_processes import swing, BASE
        warnings.simplefilter("ignore")
        own = swing(BASE)
        child = os.fork()
        if child == 0:
            os._exit(0 if (swing(BASE) == own).all() else 3)
        sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
        """
    )
    command = [sys.executable, "-c", code, ROOT / "crates/python", ROOT / "tests/python"]
    assert subprocess.run(command, timeout=60).returncode == 0


def test_a_worker_tells_why_a_motion_has_stopped(pool):
    with pytest.raises(biela.StoppedError, match="the mechanism cannot go on") as stopped:
        pool.map_async(stop, [0]).get(60)
    assert 1 < len(stopped.value.result.t) < 101 and stopped.value.result.stopped


def test_results_travel_with_their_film(four_bar):
    drive = {"crank_angle": (THETA, 2.0, 0.0)}
    own = four_bar.run(drive=drive, parameters={"base": "410*mm"}, gradient=["base"])
    again = pickle.loads(pickle.dumps(own))
    assert list(again) == list(own) and again.units == own.units
    assert_array_equal(again.to_numpy(), own.to_numpy())
    assert_array_equal(again.gradient.to_numpy(), own.gradient.to_numpy())
    assert again.to_html() == own.to_html()


def test_all_kinds_of_results_travel(four_bar, mechanism):
    drive = {"crank_angle": THETA}
    results = [
        biela.tolerance(four_bar, drive=drive, tolerances={"base": 5e-5}, corners=True, samples=3),
        four_bar.sweep({"base": BASE}, drive=drive),
        four_bar.range("crank_angle"),
        four_bar.modes(),
        four_bar.check(),
        four_bar.draw(),
        four_bar.parameters,
        biela.points("coupler.P", [[0.2, 0.2]], free="crank_angle"),
        biela.fit(four_bar, biela.Target({"rocker.phi": [2.1]}, {"crank_angle": [1.0]}), ["base"]),
        mechanism("pendulum_free").linearize(balance=True),
    ]
    for own in results:
        again = pickle.loads(pickle.dumps(own))
        assert type(again) is type(own) and repr(again) == repr(own)
    assert_array_equal(
        pickle.loads(pickle.dumps(results[0])).extremes("rocker.phi"), results[0].extremes("rocker.phi")
    )


@pytest.mark.parametrize("name", [name for name in biela.__all__ if name.endswith("Error")])
def test_each_error_travels(name):
    own = getattr(biela, name)("why")
    again = pickle.loads(pickle.dumps(own))
    assert type(again) is type(own) and str(again) == str(own) and again.args == own.args


LONG = {
    "a sweep": """
        base = np.linspace(0.36, 0.44, 200_000)
        four_bar.sweep({"base": base}, drive={"crank_angle": np.linspace(1, 7, 61)}, variables="rocker.phi")
        """,
    "a run": """
        t = np.linspace(0, 1000, 500_000)
        four_bar.run(t=t, drive={"crank_angle": "1 + t"}, variables="rocker.phi")
        """,
    "a free motion": """
        t = np.linspace(0, 1e6, 500_000)
        biela.load(root + "/mechanisms/double_pendulum.toml").run(t=t, variables="upper.phi")
        """,
}


@pytest.mark.skipif(sys.platform == "win32", reason="Ctrl-C goes to all processes of a console there")
@pytest.mark.parametrize("what", LONG)
def test_ctrl_c_ends_a_call(what):
    code = textwrap.dedent(
        """
        import sys
        root = sys.argv[1]
        sys.path.insert(0, root + "/crates/python")
        import biela
        import numpy as np
        four_bar = biela.load(root + "/mechanisms/four_bar.toml")
        print("ready", flush=True)
        try:
            {}
        except KeyboardInterrupt:
            four_bar.sweep({{"base": [0.4, 0.41]}}, drive={{"crank_angle": [1.0]}})
            print("ended", flush=True)
        """
    ).format(textwrap.dedent(LONG[what]).strip().replace("\n", "\n    "))
    command = [sys.executable, "-c", code, str(ROOT)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "ready\n"
        time.sleep(2.0)
        asked = time.monotonic()
        process.send_signal(signal.SIGINT)
        assert process.stdout.readline() == "ended\n"
        assert time.monotonic() - asked < SOON
