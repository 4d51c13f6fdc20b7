//! Reasons why a file gives no mechanism.

/// A file that cannot be imported.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Neither extension nor content tells the format.
    #[error(
        "it has no format that biela imports; expected .asmt, .linkage2, .dxf, .json of pylinkage, or a link of PMKS+"
    )]
    UnknownFormat,
    /// The file has too many bytes.
    #[error("it has more than 64 MiB")]
    TooLong,
    /// The file nests deeper than any real one.
    #[error("line {line}: it is nested too deeply")]
    TooDeep {
        /// Line of the file, from 1.
        line: usize,
    },
    /// A key is not there.
    #[error("line {line}: {place} has no `{key}`")]
    Missing {
        /// Line of the file, from 1.
        line: usize,
        /// Kind and name of what lacks it.
        place: String,
        /// The missing key.
        key: &'static str,
    },
    /// A line is not the expected one.
    #[error("line {line}: `{found}`; expected {expected}")]
    Unexpected {
        /// Line of the file, from 1.
        line: usize,
        /// Text of the file.
        found: String,
        /// Right text.
        expected: &'static str,
    },
    /// A number is none, or too large for a length or an angle.
    #[error("line {line}: `{found}` is not a number up to 1e9")]
    Number {
        /// Line of the file, from 1.
        line: usize,
        /// Text of the file.
        found: String,
    },
    /// The file is not well-formed XML.
    #[error("line {line}: it is not well-formed XML: {reason}")]
    Xml {
        /// Line of the file, from 1.
        line: usize,
        /// The parser's reason.
        reason: String,
    },
    /// The file is not JSON.
    #[error("line {line}: it is not JSON: {reason}")]
    Json {
        /// Line of the file, from 1.
        line: usize,
        /// The parser's reason.
        reason: String,
    },
    /// A value of a JSON file has not the expected type.
    #[error("`{place}` is not {expected}")]
    JsonType {
        /// Path of the value.
        place: String,
        /// Right type.
        expected: &'static str,
    },
    /// A JSON file of pylinkage that is no mechanism.
    #[error(
        "it is a `{kind}` of pylinkage, which has no links with positions; save a `Mechanism` of pylinkage as JSON"
    )]
    OtherJson {
        /// Kind of the file.
        kind: &'static str,
    },
    /// A name stands for nothing in the file.
    #[error("{place} names {kind} `{name}`, which is not in the file")]
    Unknown {
        /// Kind and name of what names it.
        place: String,
        /// Kind of what is named.
        kind: &'static str,
        /// Name that stands for nothing.
        name: String,
    },
    /// A joint turns about, or moves along, a direction that the plane of the others does not permit.
    #[error(
        "joint `{joint}` (`{class}`) is not in the plane of the other joints; biela has planar mechanisms only"
    )]
    OutOfPlane {
        /// Name of the joint.
        joint: String,
        /// Its class in the source.
        class: String,
    },
    /// A joint that no joint of biela replaces.
    #[error("joint `{joint}` has the type `{class}`, which biela does not have")]
    UnknownJoint {
        /// Name of the joint.
        joint: String,
        /// Its type in the source.
        class: String,
    },
    /// A motion that no driver of biela replaces.
    #[error("motion `{motion}` has the type `{class}`, which biela does not have")]
    UnknownMotion {
        /// Name of the motion.
        motion: String,
        /// Its type in the source.
        class: String,
    },
    /// A slider without a body that carries its limits.
    #[error(
        "slider `{slider}` has no link that carries both ends of its way; put them on one link or anchor both"
    )]
    SliderWay {
        /// Name of the slider.
        slider: String,
    },
    /// A slider that is not on its arc.
    #[error(
        "slider `{slider}` is not on an arc of radius {} through both ends of its way",
        biela::mechanism::shown(*radius)
    )]
    SliderArc {
        /// Name of the slider.
        slider: String,
        /// Radius in the file's unit.
        radius: f64,
    },
    /// A drawing in the binary form.
    #[error("it is a binary DXF; save it as ASCII DXF")]
    BinaryDxf,
    /// A file that does not tell the unit of its lengths.
    #[error("it does not tell the unit of its lengths; --length mm, cm, m or inch does")]
    NoUnit,
    /// A link of PMKS+ that was cut or changed.
    #[error("the link of PMKS+ breaks off or was changed: {part}")]
    BrokenLink {
        /// Part that is wrong.
        part: String,
    },
    /// A mechanism that programs for linkages do not have.
    #[error(
        "`{joint}` has no counterpart there: links with pins, rods, and slides or slots on ground have"
    )]
    NoLinkage {
        /// Name of the joint or constraint.
        joint: String,
    },
    /// A mechanism that OndselSolver does not have.
    #[error(
        "`{joint}` has no counterpart there: pins, slides, slots, rods, welds, gears and belts on ground, and racks have"
    )]
    NoJoint {
        /// Name of the joint or constraint.
        joint: String,
    },
    /// Nothing is joined to anything.
    #[error("it has no two parts that a joint connects")]
    NoJoints,
    /// Nothing stands still.
    #[error("none of its joints is on ground: anchor two points, or fix one part")]
    NoGround,
}

impl Error {
    /// Returns an error of a line that is not as expected.
    pub(super) fn unexpected(line: usize, found: &str, expected: &'static str) -> Self {
        Self::Unexpected {
            line,
            found: start_of(found),
            expected,
        }
    }
}

/// Returns the start of a text that a message can repeat: in one line, and not too long.
pub(super) fn start_of(text: &str) -> String {
    const LONGEST: usize = 100;
    let mut characters = text.chars();
    let start = characters.by_ref().take(LONGEST);
    let mut start: String = start
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect();
    if characters.next().is_some() {
        start.push('…');
    }
    start
}

/// Reads a number of a file.
pub(super) fn number(text: &str, line: usize) -> Result<f64, Error> {
    let number = text.trim().parse().ok();
    number
        .filter(|number: &f64| is_usable(*number))
        .ok_or_else(|| Error::Number {
            line,
            found: start_of(text),
        })
}

/// Returns whether a number of a file can be a length or an angle.
pub(super) fn is_usable(number: f64) -> bool {
    number.abs() <= 1e9
}
