"""Fixtures of the tests of the Python module."""

from __future__ import annotations

import sys

import pytest
from shipped import MECHANISMS, ROOT

sys.path.insert(0, str(ROOT / "crates" / "python"))

try:
    import biela
except ModuleNotFoundError as error:
    pytest.exit(f"{error}: run `make module` first", returncode=2)


@pytest.fixture(scope="session")
def mechanism():
    """`mechanism(name)`: a shipped mechanism."""
    return lambda name: biela.load(ROOT / "mechanisms" / f"{name}.toml")


@pytest.fixture(scope="session")
def four_bar(mechanism):
    """The four-bar linkage."""
    return mechanism("four_bar")


@pytest.fixture(params=MECHANISMS, ids=lambda path: path.stem)
def any_mechanism(request):
    """Each shipped mechanism in turn."""
    return biela.load(request.param)
