"""What all tests of pages need: the program with the solver of `make page`, or with the one that
BIELA_PAGE_SOLVER names."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "fmpy"))

from browsing import browser  # noqa: E402  (its folder has only just been added)
from harness import ROOT, program  # noqa: E402


@pytest.fixture(scope="session")
def solver() -> Path:
    """The solver for pages."""
    path = ROOT / os.environ.get("BIELA_PAGE_SOLVER", "target/runtimes/page.wasm")
    if not path.is_file():
        pytest.exit("run `make page` first", returncode=2)
    return path


@pytest.fixture(scope="session")
def page_of(tmp_path_factory, solver):
    """Returns the page of a mechanism file, by default a shipped one."""
    browser()
    folder = tmp_path_factory.mktemp("pages")

    def write(file) -> Path:
        file = Path(file) if Path(file).suffix else ROOT / "mechanisms" / f"{file}.toml"
        page = folder / f"{file.stem}.html"
        command = [program(), "page", file, "--solver", solver, "-o", page]
        subprocess.run(command, check=True, capture_output=True)
        return page

    return write
