"""What all tests of the studio need: a browser with the studio of `make studio`, or with the one in the
folder that BIELA_STUDIO names, moved by real mouse and keyboard events."""

import os
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "fmpy"))

from browsing import browser as browser_program  # noqa: E402  (its folder has only just been added)
from drawing import Drawing  # noqa: E402
from harness import ROOT  # noqa: E402
from playwright.sync_api import sync_playwright  # noqa: E402

# What keeps Chromium from looking up hosts, which some machines refuse.
FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]


@pytest.fixture(scope="session")
def folder() -> Path:
    """The studio's static folder."""
    folder = ROOT / os.environ.get("BIELA_STUDIO", "target/studio")
    if not (folder / "index.html").is_file():
        pytest.exit("run `make studio` first", returncode=2)
    return folder


@pytest.fixture(scope="session")
def chromium():
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=browser_program(), args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture
def sheet(chromium, folder, tmp_path):
    """An empty sheet; at the end no error may be in the console."""
    context = chromium.new_context(viewport={"width": 1440, "height": 900}, accept_downloads=True)
    page = context.new_page()
    drawing = Drawing(page, folder / "index.html", tmp_path)
    yield drawing
    context.close()
    assert drawing.errors == []
