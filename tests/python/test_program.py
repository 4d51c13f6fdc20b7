"""The table of Python beside the program: each command and each option of the program is in it, and
each call in it is one of the package."""

from __future__ import annotations

import inspect
import re
import subprocess
import sys
from functools import lru_cache

import biela
import pytest
from shipped import ROOT

OWNERS = {"biela": biela, "m": biela.Mechanism, "r": biela.Result}


def rows():
    """Returns the cells of the table in docs/python.md."""
    page = (ROOT / "docs/python.md").read_text(encoding="utf-8")
    lines = page.split("<!-- program -->\n")[1].split("<!-- end -->")[0].splitlines()[2:]
    return [tuple(cell.strip() for cell in line.strip("|").split(" | ")) for line in lines]


ROWS = rows()


@lru_cache(None)
def shown(*arguments):
    """Returns what the program prints."""
    code = "import sys; sys.path.insert(0, sys.argv.pop(1)); import biela.__main__ as m; sys.exit(m.main())"
    command = [sys.executable, "-c", code, ROOT / "crates/python", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def commands():
    listed = shown("--help").split("Commands:\n")[1].split("\n\n")[0]
    return set(re.findall(r"^  ([a-z]+) ", listed, re.MULTILINE)) - {"help"}


def options(command):
    """Returns the arguments and the long options of a command."""
    text = shown(command, "--help")
    usage = re.search(r"^Usage: biela \w+(.*)$", text, re.MULTILINE)[1]
    places = re.findall(r"(?:^| )[<\[]([A-Z]+)[>\]]", re.sub(r"--\S+ <[^>]*>", "", usage))
    return set(places) - {"OPTIONS"} | set(re.findall(r"^ +(?:-\w, )?(--[a-z-]+)(?: <|$)", text, re.MULTILINE)) - {"--help"}


def told(row):
    """Returns the command of a row and what the row says of it."""
    first, *others = re.findall(r"`([^`]*)`", row[0])
    command, *own = first.split()
    return command, [*own, *others]


def test_the_table_has_each_command_and_option_once():
    found = {}
    for row in ROWS:
        command, own = told(row)
        assert len(row) == 2, row
        for option in own:
            assert option not in found.setdefault(command, set()), (command, option)
            found[command].add(option)
        found.setdefault(command, set())
    assert found == {command: options(command) for command in commands()}


@pytest.mark.parametrize("row", ROWS, ids=[" ".join(re.findall("`([^`]*)`", row[0])) for row in ROWS])
def test_calls_of_the_table_are_those_of_the_package(row):
    calls = re.findall(r"`(biela|m|r)\.(\w+)(\(([^)]*)\))?`", row[1])
    # Without a call there is a reason.
    assert calls or re.match(r"none: \S+ \S+", row[1])
    for owner, name, is_call, arguments in calls:
        known = getattr(OWNERS[owner], name, None)
        if known is None:
            assert not is_call and f"self.{name}: " in inspect.getsource(OWNERS[owner]), (owner, name)
            continue
        given = set(re.findall(r"(\w+)=…", arguments))
        assert given <= set(inspect.signature(known).parameters), (owner, name, given)
        assert bool(is_call) == callable(known)
