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
from serving import Server, free_port  # noqa: E402

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


@pytest.fixture
def tab(sheet, tmp_path):
    """Opens another tab of the same browser."""

    def open_tab(address=None):
        page = sheet.page.context.new_page()
        drawing = Drawing(page, sheet.index, tmp_path, address)
        drawing.errors = sheet.errors
        return drawing

    return open_tab


@pytest.fixture
def served(sheet, tmp_path):
    """A studio that keeps a file in step: its sheet, its server and the file."""
    file = tmp_path / "rod.toml"
    server = Server(file, "--port", str(free_port()))
    sheet.page.goto(server.address)
    sheet.page.wait_for_selector(".studio.ready")
    yield sheet, server, file
    server.stop()
    # The browser tells of requests that fail, until its pages are closed.
    for page in sheet.page.context.pages:
        page.close()
    sheet.errors[:] = [error for error in sheet.errors if "Failed to load resource" not in error]
