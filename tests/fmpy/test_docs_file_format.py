"""docs/file-format.md against the reader of mechanism files.

A bad file is shown to `biela check`, whose answers say which keys, words and units it knows, and
which keys it misses.
"""

import re

import pytest
from harness import ROOT, run_biela
from manual import tables, words

PAGE = ROOT / "docs" / "file-format.md"

TABLES = {
    "The file": ("", "the file"),
    "Parameters": ("[parameters]\np = { NONE }", "parameter `p`"),
    "Ground": ("[ground]\nNONE", "`[ground]`"),
    "Bodies": ("[bodies.b]\nNONE", "body `b`"),
    "Joints": ("[joints.j]\ntype = 'revolute'\nNONE", "joint `j`"),
    "Pulleys": ("[joints.r]\ntype = 'rope'\nmarkers = [{ NONE }, 'ground.O']", "the pulley"),
    "Constraints": ("[constraints.c]\nNONE", "constraint `c`"),
    "Drivers": ("[drivers.d]\nNONE", "driver `d`"),
    "Stops of a measure or driver": ("[stops.s]\nof = 'd'\nNONE", "stop `s`"),
    "Stops of any coordinate": ("[stops.r]\ncoordinate = 'angle'\nNONE", "stop `r`"),
    "Measures": ("[measures.m]\nNONE", "measure `m`"),
    "Computed measures": ("[measures.n]\nvalue = 1\nNONE", "measure `n`"),
    "Forces along a coordinate": ("[forces.f]\ncoordinate = 'angle'\nNONE", "force `f`"),
    "Forces at a marker": ("[forces.g]\nmarker = 'ground.O'\nNONE", "force `g`"),
    "Motions": ("[drivers.e]\nmotion = { NONE }", "the motion"),
    "Profiles": ("[joints.k]\ntype = 'cam'\nprofile = { NONE }", "the profile"),
    "Outputs": ("[outputs]\nNONE", "`[outputs]`"),
    "Simulation": ("[simulation]\nNONE", "`[simulation]`"),
}
"""For each heading with a table of keys: a place in a file for a wrong key, and what the reader
calls the table there."""

JOINT_TYPES = [
    "revolute",
    "translational",
    "slot",
    "link",
    "revolute_translational",
    "weld",
    "gear",
    "belt",
    "rack_and_pinion",
    "rolling",
    "cam",
    "coupling",
    "rope",
    "curve",
]

WORDS = {
    "joint type": "[joints.J]\ntype = 'none_such'",
    "coordinate": "[measures.M]\ncoordinate = 'none_such'",
    "motion law": "[drivers.L]\nmotion = { law = 'none_such' }",
    "kind of ends": "[drivers.N]\nmotion = { ends = 'none_such' }",
    "follower": "[joints.F]\ntype = 'cam'\nfollower = 'none_such'",
    "side": "[joints.S]\ntype = 'rack_and_pinion'\nside = 'none_such'",
    "side of a pulley": "[joints.P]\ntype = 'rope'\nmarkers = [{ side = 'none_such' }, 'g.O']",
    "treatment": "[outputs]\nindeterminate = 'none_such'",
}
"""For each choice of words, by what the reader calls it, a place with a wrong one."""


@pytest.fixture(scope="module")
def answers(tmp_path_factory):
    """Returns the answer of the reader to a file with a wrong key in each table and a wrong word for each
    choice: pairs of message and help."""
    places = [place for place, _ in TABLES.values()] + list(WORDS.values())
    places += [f"[joints.T_{kind}]\ntype = '{kind}'\nNONE" for kind in JOINT_TYPES]
    # One a file: the reader shows a hundred problems, not more.
    folder = tmp_path_factory.mktemp("reader")
    found: list[tuple[str, str]] = []
    for number, place in enumerate(["none_such = 1", *places]):
        file = folder / f"bad{number}.toml"
        file.write_text(place.replace("NONE", "none_such = 1") + "\n", encoding="utf-8")
        for line in run_biela("check", file).stderr.splitlines():
            if said := re.fullmatch(r"error\[[a-z-]+\]: (.*)", line):
                found.append((said[1], ""))
            elif help_ := re.fullmatch(r" *= help: (.*)", line):
                found[-1] = (found[-1][0], help_[1])
    return found


def expected(answers, message) -> set[str]:
    """The words that the help of a message lists."""
    helps = {help_ for said, help_ in answers if said == message}
    assert len(helps) == 1, (message, helps)
    (help_,) = helps
    assert help_.startswith("expected "), (message, help_)
    return set(words(help_))


def missed(answers, subject) -> set[str]:
    """The keys that the reader asks for in a table that it calls `subject`."""
    missing = re.compile(rf"{re.escape(subject)} has no `(\w+)`")
    return {match[1] for said, _ in answers if (match := missing.fullmatch(said))}


def documented(heading) -> dict[str, list[str]]:
    """The rows under a heading by the keys in their first cell."""
    found = {}
    for under, rows in tables(PAGE):
        if under == heading:
            for row in rows:
                for key in words(row[0]):
                    assert key not in found, f"{heading}: `{key}` twice"
                    found[key] = row
    return found


@pytest.mark.parametrize("heading", TABLES)
def test_keys(answers, heading):
    subject = TABLES[heading][1]
    known = expected(answers, f"unknown key `none_such` in {subject}")
    assert set(documented(heading)) == known


@pytest.mark.parametrize("heading", TABLES)
def test_required_keys(answers, heading):
    required = {key for key, row in documented(heading).items() if row[2] == "required"}
    # Some probes have a required key already.
    given = {"Joints": "type", "Forces along a coordinate": "coordinate"}
    given["Forces at a marker"] = "marker"
    given["Computed measures"] = "value"
    given["Stops of a measure or driver"] = "of"
    given["Stops of any coordinate"] = "coordinate"
    known = missed(answers, TABLES[heading][1]) | ({given[heading]} if heading in given else set())
    assert required == known


@pytest.mark.parametrize("joint_type", JOINT_TYPES)
def test_keys_of_joints(answers, joint_type):
    common = set(documented("Joints"))
    known = expected(answers, f"unknown key `none_such` in joint `T_{joint_type}`") - common
    rows = documented("Keys of each type")
    assert joint_type in rows
    own = {key for row in [rows[joint_type]] for key in words(row[1])}
    assert own == known


def test_all_joint_types(answers):
    assert expected(answers, "no joint type `none_such`") == set(JOINT_TYPES)
    assert set(documented("Keys of each type")) == set(JOINT_TYPES)


@pytest.mark.parametrize("choice", WORDS)
def test_words(answers, choice):
    """Each word of a choice stands somewhere on the page in backquotes."""
    page = set(words(PAGE.read_text(encoding="utf-8").replace("```", "")))
    assert expected(answers, f"no {choice} `none_such`") <= page


def test_functions():
    source = (ROOT / "src/mechanism/expression/function.rs").read_text(encoding="utf-8")
    known = set(re.findall(r'\("(\w+)", Operation::', source))
    assert known
    assert set(documented("Functions")) == known
