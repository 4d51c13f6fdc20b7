//! Requests of the studio's scripts, and gestures.

use serde::{Deserialize, Serialize};
use serde_json::Value;

/// A request, in JSON with its name under `do`. Each that draws may have the `scale` of the picture
/// \[units per metre\]. A view has `text`, `problems`, `is_stale` (the drawing is of an earlier text),
/// `status`, `sketch`, `picture`, `can_undo`, `can_redo`; one that is only shown has status and picture.
/// A refusal, under `refused`, has `message`, or asks by `parameter`, `formula` and `value`. A request
/// that cannot be read is answered by `error`.
#[derive(Debug, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum Request {
    /// Begins with a file, with the contents of others beside it, and maybe with the history that its
    /// text had; answers a view.
    Begin {
        name: String,
        text: String,
        #[serde(default)]
        files: Vec<(String, String)>,
        history: Option<History>,
        scale: Option<f64>,
    },
    /// Answers the `history` of the text, by which another studio begins where this one is.
    History {},
    /// Takes a text that was typed, maybe `joined` to the change before; answers a view.
    Type {
        text: String,
        #[serde(default)]
        joined: bool,
        scale: Option<f64>,
    },
    /// Does a gesture with lengths of these decimals, or only shows it; answers a view or a refusal.
    Gesture {
        gesture: Gesture,
        #[serde(default)]
        keep: bool,
        decimals: Option<usize>,
        scale: Option<f64>,
    },
    /// Returns to the text before; answers a view.
    TextUndo { scale: Option<f64> },
    /// Returns to the text that undo left; answers a view.
    TextRedo { scale: Option<f64> },
    /// Answers a view.
    View { scale: Option<f64> },
    /// Answers a form of a thing by its name, of a point by its markers' paths, or of the mechanism:
    /// `title`, `kind`, `rows` and `actions`; or a refusal.
    Inspect { names: Vec<String> },
    /// A request of the page.
    #[serde(other)]
    OfPage,
}

/// The texts to which undo and redo return: each as its change from the one that is left for it, the next
/// one last.
#[derive(Debug, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct History {
    pub(super) before: Vec<Change>,
    pub(super) undone: Vec<Change>,
}

/// A change of a text: begin and end of the bytes that are replaced, and what takes their place.
pub(super) type Change = (usize, usize, String);

/// A gesture, with its name under `kind`. Points are global \[m\], angles in radians.
#[derive(Debug, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum Gesture {
    /// Adds a bar or a plate through points.
    Link { points: Vec<Target> },
    /// Fixes a point to ground.
    Pivot { marker: String },
    /// Makes a weld of a pin, as it is drawn.
    Weld { joint: String },
    /// Welds a point to ground, as it is drawn.
    WeldToGround { marker: String },
    /// Moves a point onto another one and pins it there.
    Join {
        marker: String,
        onto: String,
        through: Option<Through>,
    },
    /// Lets a point slide on a guide of ground.
    Slider { target: Target, angle: f64 },
    /// Lets a point slide along a bar.
    Slot { marker: String, body: String },
    /// Drives the distance between two points.
    Cylinder { points: Vec<Target> },
    /// Adds two wheels: in mesh, which meet at a `contact`, or on a belt, with `radii`. Those that are
    /// `fixed` are part of the bodies of the markers at their centres.
    Wheels {
        r#type: WheelPair,
        points: Vec<Target>,
        #[serde(default)]
        fixed: [bool; 2],
        contact: Option<[f64; 2]>,
        radii: Option<[f64; 2]>,
    },
    /// Adds a pinion and its rack.
    Rack { point: Target, contact: [f64; 2] },
    /// Adds a cam and its follower, a knife unless another one is named; or a cam that a roller at a point
    /// `of` another body follows.
    Cam {
        point: Target,
        contact: [f64; 2],
        of: Option<String>,
        #[serde(default)]
        follower: Follower,
    },
    /// Lets a point run in a track of ground through its own place and others.
    Curve {
        marker: String,
        points: Vec<[f64; 2]>,
    },
    /// Adds a rope over points.
    Rope { points: Vec<Target> },
    /// Couples the coordinates of two joints one to one.
    Coupling { joints: [String; 2] },
    /// Adds a shape to a body, otherwise to one that has all the points. The radius of one that has a
    /// radius is the distance of its `rim`.
    Shape {
        shape: ShapeKind,
        body: Option<String>,
        points: Vec<Target>,
        rim: Option<[f64; 2]>,
    },
    /// Keeps the shapes at two points from entering each other.
    Contact { points: [Target; 2] },
    /// Adds a spring between two points.
    Spring { points: Vec<Target> },
    /// Adds a damper between two points.
    Damper { points: Vec<Target> },
    /// Adds a force at a point.
    Load { marker: String },
    /// Gives a body a mass \[kg\], the usual one if there is no number.
    Mass { body: String, mass: Option<f64> },
    /// Gives a joint friction.
    Friction { joint: String },
    /// Drives a joint.
    Driver { joint: String },
    /// Lets a joint move by the forces.
    Freedom { joint: String },
    /// Limits a driver, or else a joint; at usual limits if none is given.
    Stop {
        driver: Option<String>,
        joint: Option<String>,
        min: Option<f64>,
        max: Option<f64>,
    },
    /// Moves points.
    Shift {
        markers: Vec<String>,
        by: [f64; 2],
        through: Option<Through>,
    },
    /// Sets the distance between two points, or makes it a parameter with a name.
    Length {
        markers: Vec<String>,
        value: Option<f64>,
        name: Option<String>,
        through: Option<Through>,
    },
    /// Makes a number of the file a parameter.
    Parameter {
        path: Vec<String>,
        element: Option<usize>,
        name: String,
    },
    /// Sets a value of the file, or an element of a list there; takes it away without one.
    Put {
        path: Vec<String>,
        element: Option<usize>,
        #[serde(default)]
        value: Value,
    },
    /// Gives a thing another name.
    Rename { old: String, new: String },
    /// Takes things away.
    Delete { names: Vec<String> },
    /// Copies bodies by a way.
    Duplicate { bodies: Vec<String>, by: [f64; 2] },
    /// Copies bodies mirrored over the line through a point.
    Mirror {
        bodies: Vec<String>,
        at: [f64; 2],
        angle: f64,
    },
    /// Shows the path of a point, or no longer.
    Trace { marker: String },
}

/// Two wheels that turn together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum WheelPair {
    /// In mesh outside each other.
    Gear,
    /// In mesh, one inside the other.
    Internal,
    /// On an open belt.
    Belt,
    /// On a crossed belt.
    Crossed,
}

/// The part of a follower that touches the cam.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Follower {
    /// A point.
    #[default]
    Knife,
    /// A roller.
    Roller,
    /// A face.
    Flat,
}

/// Kind of a shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum ShapeKind {
    /// All within a radius of a point.
    Disc,
    /// All within a radius of the line through points.
    Bar,
    /// A polygon.
    Outline,
    /// A round hole in the others.
    Hole,
}

impl ShapeKind {
    /// Returns its key in the file.
    pub(super) fn word(self) -> &'static str {
        match self {
            Self::Disc => "disc",
            Self::Bar => "bar",
            Self::Outline => "outline",
            Self::Hole => "hole",
        }
    }

    /// Returns the word with its article.
    pub(super) fn phrase(self) -> String {
        let article = if self == Self::Outline { "an" } else { "a" };
        format!("{article} {}", self.word())
    }
}

/// The answer to the question whether a parameter changes or the number in its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Through {
    /// The parameter.
    Parameter,
    /// The number.
    Number,
}

/// A click: where it is, and what is there.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Click {
    at: [f64; 2],
    marker: Option<String>,
    body: Option<String>,
    #[serde(default)]
    ground: bool,
}

/// The place at which a gesture acts.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(from = "Click")]
pub(super) struct Target {
    /// Global point \[m\].
    pub(super) at: [f64; 2],
    pub(super) onto: Onto,
}

/// The thing at a place.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Onto {
    /// The bare sheet.
    Sheet,
    /// Ground.
    Ground,
    /// A body, by its name.
    Body(String),
    /// A marker, by its path.
    Marker(String),
}

impl From<Click> for Target {
    fn from(click: Click) -> Self {
        let onto = match (click.marker, click.body) {
            (Some(marker), _) => Onto::Marker(marker),
            (None, Some(body)) => Onto::Body(body),
            (None, None) if click.ground => Onto::Ground,
            (None, None) => Onto::Sheet,
        };
        Self { at: click.at, onto }
    }
}
