//! Other words for quantities in the names of variables, such as `crank.w` for `crank.omega`.

use super::names::nearest;
use super::wording::either;

/// Words that people write, with the last parts of the names that they may mean.
const WORDS: [(&[&str], &[&str]); 6] = [
    (
        &[
            "w",
            "omega",
            "angular_velocity",
            "angle_velocity",
            "angular_speed",
            "phi_dot",
            "rpm",
        ],
        &["omega", "velocity"],
    ),
    (
        &["v", "vx", "vel", "velocity", "speed"],
        &["velocity", "vx", "vy", "omega"],
    ),
    (
        &[
            "alpha",
            "angular_acceleration",
            "angle_acceleration",
            "omega_dot",
        ],
        &["alpha", "acceleration"],
    ),
    (
        &["a", "ax", "acc", "accel", "acceleration"],
        &["acceleration", "ax", "ay", "alpha"],
    ),
    (&["phi", "angle", "theta", "rotation"], &["phi", "position"]),
    (
        &["x", "pos", "position", "displacement"],
        &["position", "x", "y"],
    ),
];

/// Returns "did you mean `crank.omega`?" for a variable whose quantity is in another word, of an
/// owner that is known or near to one.
pub fn in_our_words(name: &str, known: &[&str]) -> Option<String> {
    let (owner, word) = name.rsplit_once('.')?;
    let (_, parts) = WORDS.iter().find(|(words, _)| {
        let mut words = words.iter();
        words.any(|known| known.eq_ignore_ascii_case(word))
    })?;
    let owners = known
        .iter()
        .filter_map(|name| Some(name.rsplit_once('.')?.0));
    let owners: Vec<&str> = owners.collect();
    let owner = if owners.contains(&owner) {
        owner
    } else {
        nearest(owner, &owners)?
    };
    let meant: Vec<String> = parts.iter().map(|part| format!("{owner}.{part}")).collect();
    let meant = meant.iter().map(String::as_str);
    let meant: Vec<&str> = meant.filter(|name| known.contains(name)).collect();
    (!meant.is_empty()).then(|| format!("did you mean {}?", either(&meant)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_is_translated_for_its_owner() {
        let known = [
            "crank.phi",
            "crank.omega",
            "crank.alpha",
            "crank.x",
            "crank.vx",
            "crank.vy",
            "crank.A.vx",
            "crank.A.vy",
            "turn.position",
            "turn.velocity",
        ];
        for (name, meant) in [
            ("crank.w", Some("`crank.omega`")),
            ("crank_shaft.w", Some("`crank.omega`")),
            ("crank.Angle_Velocity", Some("`crank.omega`")),
            (
                "crank.speed",
                Some("`crank.vx`, `crank.vy` or `crank.omega`"),
            ),
            ("crank.A.v", Some("`crank.A.vx` or `crank.A.vy`")),
            ("crank.acc", Some("`crank.alpha`")),
            ("crank.angle", Some("`crank.phi`")),
            ("turn.speed", Some("`turn.velocity`")),
            ("turn.omega", Some("`turn.velocity`")),
            ("turn.angle", Some("`turn.position`")),
            ("crank.energy", None),
            ("slider.w", None),
            ("w", None),
        ] {
            let help = meant.map(|meant| format!("did you mean {meant}?"));
            assert_eq!(in_our_words(name, &known), help, "{name}");
        }
    }
}
