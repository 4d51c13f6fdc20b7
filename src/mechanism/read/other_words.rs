//! Keys that people write for others, as other programs call them, or in a table that does not have
//! them.

use toml::de::DeValue;

use crate::mechanism::names::is_legal;
use crate::mechanism::syntax::Value;

use super::kind::word_here;

/// Words for keys, each list with the key here.
const WORDS: [(&[&str], &str); 20] = [
    (
        &["cog", "com", "cg", "centre", "center_of_mass", "centroid"],
        "center",
    ),
    (&["moment_of_inertia", "j", "jzz", "izz"], "inertia"),
    (&["pose", "guess", "initial"], "estimate"),
    (&["points", "pins", "nodes"], "markers"),
    (&["initial", "init", "position", "angle", "value"], "start"),
    (&["speed", "omega", "rate"], "velocity"),
    (
        &["initial_velocity", "initial_speed", "v0", "omega0"],
        "velocity",
    ),
    (
        &["bounce", "bounciness", "elasticity", "cor"],
        "restitution",
    ),
    (&["spline", "points", "data", "values", "lookup"], "table"),
    (&["mu"], "coefficient"),
    (&["k", "spring", "rate"], "stiffness"),
    (&["d", "damper"], "damping"),
    (&["l0", "free_length", "rest", "rest_length"], "free"),
    (&["end", "duration", "t_end", "stop_time"], "stop"),
    (&["dt", "step_size", "time_step"], "step"),
    (&["csv", "filename", "path"], "file"),
    (&["links", "parts", "members"], "bodies"),
    (&["springs", "dampers", "loads", "torques"], "forces"),
    (&["motors", "inputs", "motions"], "drivers"),
    (&["limits", "end_stops"], "stops"),
];

/// Help for keys that other programs have in their joints.
const FRICTION: &str = "friction has a section of its own: `[friction]` with \
                        `pin = { joint = \"A\", coefficient = 0.1, radius = \"8*mm\" }`";
const SPRING: &str = "forces have a section of their own: `[forces]` with `spring = { coordinate \
                      = \"angle\", markers = [\"ground.O\", \"crank.O\"], stiffness = 5, free = 0 }`";
const STOP: &str = "limits have a section of their own: `[stops]` with `end = { of = \"MEASURE\", \
                    min = 0, max = \"90*deg\" }`";
const STOP_OF_FREEDOM: &str = "forces move a freedom, and its limits are stops: `[stops]` with `end = { of = \
                               \"FREEDOM\", min = 0, max = \"90*deg\" }`";
const COEFFICIENT: &str = "a coefficient needs a force that presses, which is that of a joint: `joint = \"A\", \
                           coefficient = 0.1` without a coordinate; along a coordinate friction has a `force`";

/// Returns the key of a table for another word, of the keys that the table knows.
pub(super) fn key_for(word: &str, known: &[&'static str]) -> Option<&'static str> {
    let mut words = WORDS.iter();
    let has = |words: &[&str]| words.iter().any(|other| word.eq_ignore_ascii_case(other));
    let known = |key: &str| known.iter().copied().find(|known| *known == key);
    words.find_map(|(words, key)| known(key).filter(|_| has(words)))
}

/// Returns help for a key that the table does not have, and the keys that it was meant to give.
pub(super) fn help(
    word: &str,
    value: &Value<'_>,
    known: &[&'static str],
) -> Option<(String, Vec<&'static str>)> {
    let has = |key: &str| known.contains(&key);
    let is_joint = has("type");
    let is_driver = has("motion");
    let alone = |help: &str| Some((help.to_owned(), Vec::new()));
    match word {
        "friction" if has("shapes") => {
            return alone("there is no friction between shapes: they slide on each other");
        }
        "friction" => return alone(FRICTION),
        "stiffness" | "damping" | "spring" | "damper" | "torque" | "force" if is_joint => {
            return alone(SPRING);
        }
        "limit" | "limits" | "min" | "max" if is_joint => return alone(STOP),
        "limit" | "limits" | "min" | "max" if has("velocity") && has("start") => {
            return alone(STOP_OF_FREEDOM);
        }
        "start" | "velocity" if is_joint => {
            return alone(
                "a joint has no motion of its own: a coordinate under `[drivers]` is given, one under \
                 `[freedoms]` moves by the forces; both have a `start`",
            );
        }
        "coefficient" | "mu" if has("force") && has("regularised") => {
            return Some((COEFFICIENT.to_owned(), vec!["force"]));
        }
        "of" | "coordinate" if has("joint") && has("coefficient") => {
            return alone(
                "friction in a joint acts where the joint moves: leave out the coordinate",
            );
        }
        "phase" if is_driver => {
            return alone("a driver has no phase: `start` or `motion` gives its value");
        }
        "length" if has("estimate") => {
            return alone(
                "the markers tell how long a body is: `markers = { A = [0, 0], B = [0.1, 0] }`",
            );
        }
        "speed" | "velocity" | "omega" | "rpm" if is_driver => {
            let help = "a driver moves by `motion = \"60*deg + 10*t\"`; only a freedom has a \
                        `velocity`, at the start";
            return Some((help.to_owned(), vec!["start", "motion"]));
        }
        "motion" if has("velocity") => {
            return alone("a coordinate with a `motion` is a driver, under `[drivers]`");
        }
        "gravity" if has("simulation") => {
            return alone("`gravity = [0, -9.81]` is a key of `[simulation]`");
        }
        "x" | "y" if has("r") => {
            let help = "a point is written `[x, y]`".to_owned();
            return Some((help, vec!["r", "angle"]));
        }
        _ => {}
    }
    let carries_markers = has("estimate") || known == ["markers", "shapes"];
    let is_point =
        matches!(value.get_ref(), DeValue::Array(items) if (2..=3).contains(&items.len()));
    if let Some(key) = key_for(word, known) {
        return Some((word_here(key), vec![key]));
    }
    (carries_markers && is_point && is_legal(word)).then(|| {
        let help = format!("a marker is one of the `markers`: `markers = {{ {word} = [0, 0] }}`");
        (help, Vec::new())
    })
}
