//! Requests of a page's scripts.

use serde::Deserialize;

/// A request, in JSON with its name under `do`. Values are SI, points are in the picture. An outcome has
/// `outcome` (`reached`, `stopped`, `refused`), and unless reached `message`, `at` (in the picture) and
/// `assembles`. A request that cannot be done is answered by `error`.
#[derive(Debug, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum Request {
    /// Opens a file with the contents of others beside it; answers `page`, or `problems`. Undo returns
    /// to the file before if that is `kept`.
    Open {
        name: String,
        text: String,
        #[serde(default)]
        files: Vec<(String, String)>,
        #[serde(default)]
        kept: bool,
    },
    /// Answers the parts of the moving picture.
    Picture {},
    /// Draws anew, at the same scale if that is to be kept; answers `picture` and `page`.
    Redraw {
        #[serde(default)]
        keep: bool,
    },
    /// Moves a driver; answers an outcome.
    Drive { driver: usize, value: f64 },
    /// Sets the rates of a driver.
    Speed {
        driver: usize,
        velocity: f64,
        acceleration: f64,
    },
    /// Sets an input, or that of a force; answers an outcome, and the `value` reached.
    Load { input: usize, value: f64 },
    /// Goes to a time; answers an outcome.
    Time { value: f64 },
    /// Sets a parameter, maybe by assembling anew; answers an outcome.
    Set {
        parameter: usize,
        value: f64,
        #[serde(default)]
        anew: bool,
    },
    /// Answers `grip`: the point of a body at a place.
    Grab { body: usize, at: [f64; 2] },
    /// Pulls a grip towards a place; answers an outcome.
    Drag {
        body: usize,
        grip: [f64; 2],
        at: [f64; 2],
    },
    /// Holds a grip by a spring to a place; answers an outcome.
    Hold {
        body: usize,
        grip: [f64; 2],
        at: [f64; 2],
    },
    /// Lets go what is held.
    LetGo {},
    /// Keeps the present state for undo; answers `done`.
    Keep {},
    /// Returns to the values and the pose of the file; answers `done`.
    Reset {},
    /// Returns to the state before; answers `done`, of another file `page` and `file`.
    Undo {},
    /// Returns to the state that undo left; answers `done`, of another file `page` and `file`.
    Redo {},
    /// Answers `pictures` of all ways to close, and whether they are `complete`.
    Assemblies {},
    /// Takes one of the ways to close; answers an outcome.
    Choose { index: usize },
    /// Answers `x`, `y` and `events` of variables along a driver, without one along time.
    Chart {
        driver: Option<usize>,
        variables: Vec<usize>,
        samples: usize,
    },
    /// Traces a point of a body, without them none; answers `done`.
    Trace {
        body: Option<usize>,
        grip: Option<[f64; 2]>,
    },
    /// Answers `points` of the traced point's path, in the picture.
    Path {
        driver: Option<usize>,
        samples: usize,
    },
    /// Answers `poses`, lists of the places of the parts.
    Poses {
        driver: Option<usize>,
        samples: usize,
    },
    /// Answers `svg`: the diagram.
    Diagram {},
    /// Answers `text`: the file as the mechanism is now, or with its `parameters` alone.
    Text {
        #[serde(default)]
        parameters: bool,
    },
}
