"""The gallery's page, `mechanisms/README.md`: pictures, what they show and how exact the FMUs are."""

from __future__ import annotations

import math

from harness import ROOT, mechanism_file, run_biela

from .runner import ORDERS, Row

try:
    import tomllib
except ModuleNotFoundError:  # Python 3.10: pytest itself brings the same reader along
    import tomli as tomllib

FOLDER = ROOT / "mechanisms"

HEAD = """\
# Mechanisms

Each file is a mechanism that `biela export` turns into an FMU, drawn here by `biela draw` at its
start. The FMUs are run in FMPy over a full motion and compared with a truth that shares no code
with biela; the tests do so each time (`tests/fmpy/test_gallery.py`). The largest errors over the
motion are given for position, velocity and acceleration, relative to the largest magnitude of
their kind. They are rounded up and differ a little from machine to machine.

Made by `make refresh`; do not edit.
"""

LINKAGES = "Linkages"
CAMS = "Cams and curves"
GEARS = "Gears, belts, ropes and couplings"
FREE = "Free motion"
CONTACT = "Stops, friction and contact"
GROUPS = (LINKAGES, CAMS, GEARS, FREE, CONTACT)


def draw(name: str) -> None:
    """Draws the picture of a mechanism."""
    picture = FOLDER / "pictures" / f"{name}.svg"
    picture.parent.mkdir(exist_ok=True)
    # All have the width that the tests draw.
    done = run_biela("draw", mechanism_file(name), "-o", picture, "--width", "640")
    assert done.returncode == 0, done.stderr


def write(rows: list[Row]) -> None:
    """Writes the page and its pictures, and removes pictures of nothing."""
    names = {row.name for row in rows}
    for picture in (FOLDER / "pictures").glob("*.svg"):
        if picture.stem not in names:
            picture.unlink()
    for row in rows:
        draw(row.name)
    text = "\n".join([HEAD, *sections([(row.name, section(row)) for row in rows])])
    (FOLDER / "README.md").write_text(text, encoding="utf-8", newline="\n")


def sections(of_mechanisms: list[tuple[str, str]]) -> list[str]:
    """Returns the sections of mechanisms, given with their names, in groups with headings."""
    groups = {heading: [] for heading in GROUPS}
    for name, text in of_mechanisms:
        groups[group(read(name))].append(text)
    return [part for heading, texts in groups.items() if texts for part in (f"## {heading}\n", *texts)]


def read(name: str) -> dict:
    """Reads a mechanism file."""
    return tomllib.loads(mechanism_file(name).read_text(encoding="utf-8"))


def group(mechanism: dict) -> str:
    """Returns the heading of the group that a mechanism belongs to."""
    joints = mechanism.get("joints", {}).values()
    kinds = {joint["type"] for joint in joints}
    opens = any({"unilateral", "backlash"} & joint.keys() for joint in joints)
    if opens or {"stops", "friction", "contacts"} & mechanism.keys():
        return CONTACT
    if "freedoms" in mechanism:
        return FREE
    if kinds & {"cam", "curve", "geneva"}:
        return CAMS
    if kinds & {"gear", "belt", "rack_and_pinion", "rolling", "rope", "coupling"}:
        return GEARS
    return LINKAGES


def section(row: Row) -> str:
    """Returns the section of a mechanism."""
    mechanism = read(row.name)
    description = mechanism["description"]
    errors = " · ".join(f"{order} {rounded_up(row.errors.get(order))}" for order in ORDERS)
    return f"""\
### [{row.name}]({row.name}.toml)

{description}.

![{description}](pictures/{row.name}.svg)

Truth: {row.source}. Errors: {errors}.
"""


def rounded_up(error: float | None) -> str:
    """An error to one digit, not less than it is: 2e-15."""
    if error is None or not math.isfinite(error):
        return "unknown"
    if error == 0:
        return "0"
    exponent = math.floor(math.log10(error))
    digit = math.ceil(error / 10.0**exponent)
    if digit > 9:
        digit, exponent = 1, exponent + 1
    return f"{digit}e{exponent:+03d}"
