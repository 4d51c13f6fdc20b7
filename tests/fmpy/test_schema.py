"""The JSON Schema that `biela schema` prints, as an independent validator understands it."""

import json
import subprocess

import pytest
from harness import ROOT, program
from jsonschema import Draft202012Validator

tomllib = pytest.importorskip("tomllib", reason="Python 3.10 has no TOML reader")

# The files of crates/tools/tests/file/diagnostics that are wrong in one place, or in a choice, a type or a key.
# Only the reader knows the faults of the others: names that stand for nothing, values.
WRONG = {
    "bad-profile",
    "bad-profile_curve",
    "bad-table",
    "bad-table_law",
    "driver-source",
    "duplicate-output",
    "force-shape",
    "friction-coordinate",
    "friction-coordinate_joint",
    "illegal-name",
    "illegal-name_device",
    "illegal-name_keyword",
    "illegal-name_long",
    "illegal-value",
    "illegal-value_function",
    "illegal-value_rope",
    "illegal-value_stop",
    "missing-key",
    "missing-key_stop",
    "no-bodies",
    "out-of-range_input",
    "reserved-name",
    "shape",
    "shape_contact",
    "stop-coordinate",
    "too-many-problems",
    "unknown-coordinate",
    "unknown-format",
    "unknown-joint-type",
    "unknown-joint-type_coupling",
    "unknown-key",
    "unknown-key_driver",
    "unknown-key_elsewhere",
    "unknown-key_freedom",
    "unknown-key_friction",
    "unknown-key_other-words",
    "unknown-key_point",
    "unknown-key_slip",
    "unknown-marker",
    "wheel-sizes",
    "wrong-type",
    "wrong-type_law",
    "wrong-type_markers",
    "wrong-type_named",
    "wrong-type_points",
}


@pytest.fixture(scope="module")
def validator():
    printed = subprocess.run([program(), "schema"], check=True, capture_output=True, text=True)
    schema = json.loads(printed.stdout)
    Draft202012Validator.check_schema(schema)
    return Draft202012Validator(schema)


def load(path):
    return tomllib.loads(path.read_text(encoding="utf-8"))


def test_shipped_mechanisms_are_right(validator):
    paths = sorted((ROOT / "mechanisms").glob("*.toml"))
    assert len(paths) >= 30
    for path in paths:
        assert [error.message for error in validator.iter_errors(load(path))] == [], path


def test_broken_mechanisms_are_wrong(validator):
    refused = set()
    for path in sorted((ROOT / "crates/tools/tests/file/diagnostics").glob("*.toml")):
        try:
            document = load(path)
        except (tomllib.TOMLDecodeError, UnicodeDecodeError):
            continue
        if not validator.is_valid(document):
            refused.add(path.stem)
    assert refused == WRONG


def four_bar():
    return load(ROOT / "mechanisms" / "four_bar.toml")


@pytest.mark.parametrize(
    ("where", "value", "message"),
    [
        (["joints", "A", "type"], "revolut", "'revolut' is not one of"),
        (["joints", "A", "length"], 0.1, "'length' was unexpected"),
        (["joints", "A", "markers"], ["crank.A"], "is too short"),
        (["joints", "A", "markers"], ["crank", "coupler.A"], "does not match"),
        (["drivers", "crank_angle", "motion"], "t", "is valid under each of"),
        (["drivers", "crank_angle", "coordinate"], "phi", "is not one of"),
        (["bodies", "crank", "estimate"], [0, 0], "is too short"),
        (["bodies", "deg"], {}, "should not be valid under"),
        (["bodies", "crank", "markers", "omega"], [0, 0], "should not be valid under"),
        (["parameters", "base"], True, "is not valid under any"),
        (["outputs", "markers"], "coupler.P", "is not of type 'array'"),
        (["colour"], "red", "'colour' was unexpected"),
    ],
)
def test_each_fault_is_named(validator, where, value, message):
    document = four_bar()
    *way, last = where
    place = document
    for key in way:
        place = place[key]
    place[last] = value
    messages = [error.message for error in validator.iter_errors(document)]
    assert any(message in found for found in messages), messages


def contour(law):
    return {"table": [[0, 0.04], ["90*deg", 0.05]], "law": law}


def test_a_link_needs_its_length_and_gears_one_kind_of_size(validator):
    for joint, right in [
        ({"type": "link", "length": "2*base"}, True),
        ({"type": "link"}, False),
        ({"type": "gear", "teeth": [20, 40]}, True),
        ({"type": "gear", "teeth": [20, 40], "radii": [1, 2]}, False),
        ({"type": "gear"}, False),
        ({"type": "cam", "follower": "flat", "profile": "0.04"}, True),
        ({"type": "cam", "follower": "round", "profile": "0.04"}, False),
        ({"type": "cam", "follower": "flat", "profile": contour("cycloidal")}, True),
        ({"type": "cam", "follower": "flat", "profile": contour("sine")}, False),
    ]:
        document = four_bar()
        document["joints"]["more"] = {"markers": ["crank.A", "coupler.A"], **joint}
        assert validator.is_valid(document) == right, joint
