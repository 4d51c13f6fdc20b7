"""The notebook in `examples` runs, and prints what it shows."""

from __future__ import annotations

import contextlib
import io
import json

import pytest
from shipped import ROOT

NOTEBOOK = ROOT / "examples" / "four_bar.ipynb"


def test_the_notebook_runs_and_prints_what_it_shows(monkeypatch):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    monkeypatch.chdir(NOTEBOOK.parent)
    cells = json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]
    names: dict = {}
    printed = 0
    for cell in cells:
        if cell["cell_type"] != "code":
            continue
        source = "".join(cell["source"])
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            exec(compile(source, str(NOTEBOOK), "exec"), names)
        shown = "".join(line for output in cell["outputs"] for line in output["text"])
        assert out.getvalue() == shown, source
        printed += bool(shown)
    assert printed >= 4
    # What the two first cells show in a notebook.
    assert "<svg " in names["four_bar"]._repr_svg_()
    assert "<iframe" in names["result"]._repr_html_()
