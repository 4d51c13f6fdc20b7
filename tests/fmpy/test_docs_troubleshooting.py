"""docs/troubleshooting.md explains every message that a user can meet, and no other.

Messages are taken from the sources, and those about mechanism files also from the reviewed
answers to bad files in tests/snapshots. What varies in a message is `…` on the page.
"""

import re

import pytest
from harness import ROOT
from manual import tables
from rust_text import Literal, literals, reported, sources

PAGE = ROOT / "docs" / "troubleshooting.md"

FILES_WITHOUT_MESSAGES = {
    "cli/commands/check.rs": "its report, which is the answer and not a complaint",
    "cli/commands/range.rs": "likewise",
    "cli/commands/platforms.rs": "likewise",
    "dynamics/watch.rs": "descriptions in the FMU",
    "cli/pages/documentation.rs": "the page in the FMU",
    "cli/pages/server.rs": "what a browser is told",
    "fmi/mechanism_model/rule.rs": "descriptions in the FMU",
    "fmi/mechanism_model/variables.rs": "likewise",
    "kinematics/results/output.rs": "likewise",
    "mechanism/parameter.rs": "what `--set` says, not the reader",
    "fmi/model_description/writer.rs": "the FMU's XML",
    "fmi/model_description/xml.rs": "likewise",
    "cli/commands/check/forces.rs": "the report of `check`",
    "cli/commands/check/shapes.rs": "likewise, but for a warning",
    "cli/commands/range/forces.rs": "the report of `range`",
    "fmi/log.rs": "descriptions of the log categories",
    "exchange/linkage2/write.rs": "the XML of documents",
    "exchange/ssp.rs": "the XML of systems",
    "exchange/text.rs": "the mechanism file that `import` writes",
    "kinematics/reference.rs": "the oracle of the tests",
}

WITHOUT_MESSAGES = ("mechanism/", "write/", "drawing/", "studio/")
"""The reader's messages are FILE_MESSAGES; drawing has none. The studio answers at once to what the hand
does, and says what to do."""

NOT_FOR_PEOPLE = re.compile(
    r"(?:expect|unreachable!|panic!|assert!|debug_assert!)\(\s*$"
    r"|(?:assert|assert_eq|debug_assert)!\(.*,\s*$"
    r"|(?:reason|after_help|doc|value_name|help) =$"
    r"|\bdoc = concat!\(.*,\s*$"
)
"""Code before a string that is for programmers, or part of `--help`."""

PARTS = {
    "; `biela run --animate` writes pictures that move": "`…` has neither the extension .svg nor .png…",
    "a fixed parameter, and initialization has ended": "cannot be set: it is …",
    "a parameter derived from others": "cannot be set: it is …",
    "an event indicator": "cannot be set: it is …",
    "a state, and initialization has ended": "cannot be set: it is …",
    "an output, and initialization has ended": "cannot be set: it is …",
    "a state, which initialization computes": "cannot be set: it is …",
    "joint or constraint": "`…` names `…`, which is no … of `mechanism.toml`: …",
    "the derivatives are not finite": "no step leads on from t = … s: …",
    "the estimated error is … times the tolerance": "likewise",
    "the matrix of the stiff method is singular": "likewise",
    "events follow each other too fast": "likewise",
    "no input, and only inputs have input derivatives": "cannot be set: it is …",
    "Integer or Enumeration": "`…` is …, not …",
    "the mechanism has none": "no … `…`; …",
    ", for example --drive '… = … … …*t'": "note: nothing moves; …",
    "crank_angle=60*deg + 10*t": "the example for --drive",
    "crank_length=120*mm": "the example for --set",
    "beyond, …, redundant up to here": "… at t = … s: the mechanism cannot go on, with …",
    "at … of … poses, first at …": "`range`: … has no value …, no forces …",
    "at t [s]": "a heading of the table of `tolerance`",
    "about the solver": "cannot be set: it is …",
    "the running program": "cannot read `…`",
    "it is not UTF-8: save it as UTF-8": "cannot read `…`",
    "expected one of …": "told by the parser of options",
    "macOS, x86-64 and Apple silicon": "a name of `biela platforms`",
    "Linux, ARM 64-bit": "likewise",
    "macOS, Apple silicon": "likewise",
    "a table of the mechanism": "nothing is written to …: it is …, `…`",
    " and no input of a force": "--input: `…`: column `…` is no variable of a driver…",
    "the file of --input": "nothing is written to …: it is …, `…`",
    "a runtime library": "nothing is written to …: it is …, `…`",
    "the normal of ": "where … passes through …",
    "the line of ": "where … passes through …",
    "degree of freedom": "the mechanism has … and …",
    "degrees of freedom": "the mechanism has … and …",
    "the estimate of body `…`": "… has no finite value",
    "an equation of the mechanism": "… has no finite value",
    "the radius of joint `…`": "… has no finite value",
    "a limit of stop `…`": "… has no finite value",
    "a wheel's size in joint `…`": "… has no finite value",
    "a pulley's radius in joint `…`": "… has no finite value",
    "a number of parts in joint `…`": "… has no finite value",
    "a number of joint `…`": "… has no finite value",
    "the mass, inertia or center of body `…`": "… has no finite value",
    "the … of body `…`": "the … of body `…` is …; it must …",
    "… is …; it must …": "the … of body `…` is …; it must …",
    "`…` and `…` are … apart, `…` and `…` together span … to …": "cannot close: …; …",
    "whatever the angle of `…`": "cannot close: …; …",
    "bounds exclude all angles of …": "cannot close: …; …",
    "degree of freedom": "the mechanism has … and …",
    "degrees of freedom": "the mechanism has … and …",
    "add … drivers for them": "free to move: …",
    "it follows from the others; it is": "the constraint equation of … is redundant",
    "1 of its … follows from the others; it is": "constraint equations of … are redundant",
    "all … follow from the others; they are": "constraint equations of … are redundant",
    "beyond, …, redundant up to here": "why a motion ends where redundant constraints stop to hold",
    "it has … bytes too many": "no instance can be in the serialized FMU state: …",
    "a value … bytes before its end is impossible": "no instance can be in the serialized FMU state: …",
    "its change points do not belong to this mechanism": "no instance can be in the serialized FMU state: …",
    "its joints are open by …": "no instance can be in the serialized FMU state: …",
    "its choice of equations is none of this mechanism": "no instance can be in the serialized FMU state: …",
    "from theta = … to … deg": "does not fit into hollows: …",
    ", and in … more places": "does not fit into hollows: …",
    "initialized at t = … s": "an event",
    "a discrete input, which changes in event mode": "cannot be set: it is …",
    "a tunable parameter, which changes in event mode": "cannot be set: it is …",
    "its GUID is longer than itself": "no instance can be in the serialized FMU state: …",
    "it is in state …": "no instance can be in the serialized FMU state: …",
    "this FMU provides no directional derivatives": "of a model without them, which none is",
    "…, glibc … or newer": "wrote …",
    "FMU state set: … at t = … s": "an event",
    "the rate input": "an event: … now comes from …",
    "differences of the velocity": "an event: … now comes from …",
    "an estimate from positions": "an event: … now comes from …",
    "t = … s: sub-steps ……, iterations …, residual …": "solver detail",
    " (… checked, not proved)": "solver detail",
    "unit of lengths": "told by the parser of options",
    "the imported file": "nothing is written to …: it is …, `…`",
    "a reference point": "line …: … has no `…`",
    "`EOF`, the end of the drawing": "line …: `…`; expected …",
    "`RotationLimit` or `TranslationLimit`": "line …: `…`; expected …",
    "a code and its value": "line …: `…`; expected …",
    "the number of a code": "line …: `…`; expected …",
    "AutoCAD Binary DXF": "the start of a file",
    "line of layer `…`": "note: … × … left out: …",
    "only lines, polylines, arcs, circles and texts are read": "note: … × … left out: …",
    "no circle makes the layer a body": "note: … × … left out: …",
    "it ends before its first element does": "it is not well-formed XML: …",
    "of the driver": "a description in the mechanism file",
    "its lists of joints and links do not end": "the link of PMKS+ breaks off or was changed: …",
    "its check character does not fit its length": "the link of PMKS+ breaks off or was changed: …",
    "Linkage of the former classes": "it is a `…` of pylinkage, …",
    "a link through both its joints, of": "… names … `…`, which is not in the file",
    "two numbers up to 1e9": "`…` is not …",
    "a list of ids": "`…` is not …",
    "it limits nothing in the plane": "note: limit `…` is left out: …",
    "its value has no counterpart": "note: limit `…` is left out: …",
    "the ends of an arc are no limits of a coordinate": "note: limit `…` is left out: …",
    "they are the placeholders of the source, 1 and 1": "note: masses are left out: …",
    "the unit of their inertias is known for lengths in metres only": "note: masses are left out: …",
    "the link does not tell their unit": "note: masses are left out: …",
    "the other program has units of its own": "note: masses are left out: …",
    "no link has it": "note: … `…` is left out: …",
    "forces move it": "note: … `…` is left out: …",
    "a distance has no motion there": "note: … `…` is left out: …",
    "its axes are those of a third marker": "note: … `…` is left out: …",
    "it is not along a slide": "note: … `…` is left out: …",
    "its motion has no counterpart": "note: … `…` is left out: …",
    "it has no two points, as a link has": "note: … `…` is left out: …",
    "it drives nothing": "note: … `…` is left out: …",
    "it is drawn beyond it": "note: limit `…` is left out: …",
    "the axes of the assembly are not those of its plane": "note: … `…` is left out: …",
    "its unit is known for lengths in metres only": "note: … `…` is left out: …",
    "its type is not known": "note: … `…` is left out: …",
    "its ends have no line in the plane": "note: … `…` is left out: …",
    "its twist is not in the plane": "note: … `…` is left out: …",
    "both its ends are on one body": "note: … `…` is left out: …",
    "it is not between ground and a body": "note: … `…` is left out: …",
    "its axes are inclined to the plane": "note: … `…` is left out: …",
    "it has components out of the plane": "note: … `…` is left out: …",
    "with one connector it is no body": "note: … `…` is left out: …",
    "it is fastened to a link that is no body": "note: … `…` is left out: …",
    "it is fastened to a connector that moves": "note: … `…` is left out: …",
    "the fastening of": "note: … `…` is left out: …",
    "the trace of": "note: … `…` is left out: …",
    "the point does not move": "note: … `…` is left out: …",
    "its two ends are not on two bodies": "note: … `…` is left out: …",
    "the stroke of actuator": "note: … `…` is left out: …",
    "its ends are no lengths around the drawn one": "note: … `…` is left out: …",
    "a further link is free to turn about it": "note: … `…` is left out: …",
    "limits of input": "note: … `…` is left out: …",
    "its start is not between them": "note: … `…` is left out: …",
    "its way is on its own body": "note: … `…` is left out: …",
    "only links about pins on ground are driven there, one for each pin": "note: … `…` is left out: …",
    "inputs turn at one speed there: it has that of the start": "note: … `…` is left out: …",
    "the course of driver": "note: … `…` is left out: …",
    "the angle of joint": "note: … `…` is left out: …",
    "the parts are drawn at another one, at which they are held": "note: … `…` is left out: …",
    "its type is neither gears nor chain": "note: … `…` is left out: …",
    "its unit is not known": "note: … `…` is left out: …",
    "its arrow is drawn the other way round": "note: … `…` is left out: …",
    "it moves nothing": "note: … `…` is left out: …",
    "the motions give them": "note: velocities at the start are left out: …",
    "without masses no forces move it": "note: velocities at the start are left out: …",
    "element of the drawing": "note: … × … left out: …",
    "drawings and measures move nothing": "note: … × … left out: …",
    "the slider is drawn beyond it": "note: limit `…` is left out: …",
    "the slot goes on beyond its ends": "note: limit `…` is left out: …",
    "it is drawn beside its way": "note: `…` is moved to where it can be: …",
    "held lengths and angles": "note: left out, as they do not change the mechanism: …",
    "anchors of centres of mass": "note: left out, as they do not change the mechanism: …",
    "further fields of joint": "note: left out, as their meaning is not known: …",
    "g and kg cm²": "note: masses and inertias are taken as …",
    "kg and kg m²": "note: masses and inertias are taken as …",
    "slider without a way": "joint `…` has the type `…`, which biela does not have",
    "a speed of … …/s": "the motion of `…` is left out, …",
    "its wheels have no axles or no sizes": "note: … `…` is left out: …",
}
"""Texts that are no messages by themselves, each with the message that it is a part of."""

FILE_TABLE = "In the mechanism file"

SYMPTOMS = "First aid"
"""The table without messages."""


def rows() -> list[tuple[str, str, str]]:
    """Heading, code (empty elsewhere than in the table of the file) and message of each row."""
    found = []
    for heading, table in tables(PAGE):
        for row in table:
            if heading == FILE_TABLE:
                found.append((heading, row[0].strip("`"), row[1]))
            elif heading != SYMPTOMS:
                found.append((heading, "", row[0]))
    return found


def plain(text: str) -> str:
    """A message without what differs between sources and page: quotes round what varies."""
    return text.removeprefix("warning: ").replace("`…`", "…").strip()


def pattern(message: str) -> re.Pattern:
    return re.compile(".*".join(map(re.escape, message.split("…"))))


def explained(literal: Literal, among: list[tuple[str, str, str]]) -> bool:
    """Whether a row shows the literal, as it is or within a larger message."""
    text = plain(literal.text)
    wanted = pattern(text)
    messages = [plain(message) for _, _, message in among]
    return any(wanted.search(m) or ("…" != m and pattern(m).fullmatch(text)) for m in messages)


def words_in(text: str) -> int:
    return len(re.findall(r"[A-Za-z]{2,}|\b[a-z]\b", text))


def is_message(literal: Literal) -> bool:
    """Whether people are to read it: three words or more, no markup, not for programmers."""
    text = literal.text
    is_text = " " in text and "<" not in text and words_in(text) >= 3
    return is_text and not NOT_FOR_PEOPLE.search(literal.before)


SOURCES = list(sources())

MESSAGES = [
    literal
    for name, text in SOURCES
    if not name.startswith(WITHOUT_MESSAGES) and name not in FILES_WITHOUT_MESSAGES
    for literal in literals(name, text)
    if is_message(literal)
]
"""Messages of the program, the solver and the FMU."""

FILE_MESSAGES = [
    literal
    for name, text in SOURCES
    if name.startswith("mechanism/") and name not in FILES_WITHOUT_MESSAGES
    for literal in reported(name, text)
    if re.search(r" .*[a-z]", literal.text)
]
"""Messages of the reader."""

ANSWER = re.compile(r"^(?:error|warning)\[([a-z0-9-]+)\]: (.*)$", re.MULTILINE)

SNAPSHOTS = sorted(
    {
        found
        for path in (ROOT / "crates/tools/tests/file/snapshots").glob("file__diagnostics__*.snap")
        for found in ANSWER.findall(path.read_text(encoding="utf-8"))
    }
)
"""Codes and messages of the reviewed answers to bad files."""


def test_there_is_something_to_compare():
    assert min(map(len, (MESSAGES, FILE_MESSAGES, SNAPSHOTS))) > 50


def test_every_message_is_explained():
    missing = {str(m) for m in MESSAGES if m.text not in PARTS and not explained(m, rows())}
    if missing:
        pytest.fail(
            "add to docs/troubleshooting.md (or to PARTS here, if it is a part of another):\n"
            + "\n".join(sorted(missing))
        )


def test_every_message_about_a_file_is_explained():
    of_files = [row for row in rows() if row[0] == FILE_TABLE]
    missing = {str(m) for m in FILE_MESSAGES if not explained(m, of_files)}
    assert not missing, "add to docs/troubleshooting.md:\n" + "\n".join(sorted(missing))


@pytest.mark.parametrize("code", sorted({code for code, _ in SNAPSHOTS}))
def test_reviewed_answers_are_explained(code):
    patterns = [pattern(message) for _, known, message in rows() if known == code]
    for known, message in SNAPSHOTS:
        if known == code:
            assert any(p.fullmatch(message) for p in patterns), f"{code}: {message}"


def test_every_code_is_there():
    text = dict(SOURCES)["mechanism/diagnostic.rs"]
    codes = set(re.findall(r'^    [A-Z0-9_]+ = "([a-z0-9-]+)",$', text, re.MULTILINE))
    assert codes == {code for heading, code, _ in rows() if heading == FILE_TABLE}


def test_nothing_else_is_explained():
    files = [*SOURCES, *sources([ROOT / "crates/python/src"])]
    every = [plain(literal.text) for name, text in files for literal in literals(name, text)]
    texts = {text for text in every if words_in(text) >= 1 and " " in text}
    patterns = [pattern(text) for text in texts if words_in(text) >= 2]

    def is_said(message: str) -> bool:
        return any(text in message for text in texts) or any(p.search(message) for p in patterns)

    stale = [
        f"{heading}: {message}"
        for heading, code, message in rows()
        if not any(c == code and pattern(message).fullmatch(m) for c, m in SNAPSHOTS)
        and not is_said(plain(message))
    ]
    assert not stale, stale


def test_no_part_is_out_of_date():
    texts = {literal.text for name, text in SOURCES for literal in literals(name, text)}
    assert set(PARTS) <= texts, set(PARTS) - texts
