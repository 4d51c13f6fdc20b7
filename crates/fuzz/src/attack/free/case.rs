//! A case: a mechanism that moves freely, and what is known of its motion.

use super::align::Happening;

/// A mechanism that moves freely, and what is known of its motion.
pub struct Case {
    /// The mechanism file.
    pub text: String,
    /// Length of the motion \[s\].
    pub duration: f64,
    /// Invariants at any time.
    pub checks: Vec<Check>,
    /// The motion itself, in closed form.
    pub truth: Option<Truth>,
    /// Parts of messages with which the motion may be refused.
    pub refusals: &'static [&'static str],
}

impl Case {
    /// A case of which nothing more is known.
    pub fn new(text: String, duration: f64) -> Self {
        Self {
            text,
            duration,
            checks: Vec::new(),
            truth: None,
            refusals: &[],
        }
    }
}

/// A gap as a function of x, y and phi of all bodies \[m\].
pub type Gap = Box<dyn Fn(&[f64]) -> f64>;

/// Something that holds at any time of a motion.
pub enum Check {
    /// A variable stays between two values.
    Within {
        /// Its name.
        variable: String,
        /// Least and largest value \[SI\].
        limits: [f64; 2],
    },
    /// Friction along a coordinate follows Coulomb's law.
    Friction {
        /// Name of the friction.
        name: String,
        /// Variable of the coordinate's rate.
        rate: String,
        /// Force while it slides, largest force while it sticks, and force per speed \[SI\].
        law: [f64; 3],
    },
    /// A gap is not negative.
    Gap {
        /// Name of the contact.
        name: String,
        /// The gap.
        gap: Gap,
    },
    /// Kinetic energy and that of gravity do not grow.
    Energy,
}

impl Check {
    /// Checks a stop of a coordinate, by a measure of it.
    pub fn stop(measure: &str, limits: [f64; 2]) -> Self {
        Self::Within {
            variable: format!("{measure}.position"),
            limits,
        }
    }

    /// Checks friction along the coordinate of a measure, driver or freedom.
    pub fn friction(name: &str, along: &str, law: [f64; 3]) -> Self {
        Self::Friction {
            name: name.to_owned(),
            rate: format!("{along}.velocity"),
            law,
        }
    }
}

/// A motion in closed form.
pub struct Truth {
    /// Time up to which it is known \[s\].
    pub until: f64,
    /// The variables that are compared.
    pub variables: Vec<String>,
    /// Their values at a time \[SI\].
    pub values: Box<dyn Fn(f64) -> Vec<f64>>,
    /// Its impacts.
    pub impacts: Vec<Happening>,
}
