//! Parameters and their derivation from one another.

use super::{Expression, Mechanism, Number, Unit};

/// Named number that can be changed without exporting again, or is derived from such numbers.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// Name, unique among all named things of the mechanism.
    pub name: String,
    /// One line for people, empty if the file gives none.
    pub description: String,
    /// Value as the file gives it.
    pub expression: Expression,
    /// Value in the file \[SI\].
    pub default: f64,
    /// Whether its value uses another parameter: it cannot be set then.
    pub derived: bool,
    /// Whether it may change between steps.
    pub tunable: bool,
    /// Unit for the FMU's description and for labels; values are SI in any case.
    pub unit: Option<Unit>,
    /// Smallest permitted value \[SI\].
    pub min: Option<f64>,
    /// Largest permitted value \[SI\].
    pub max: Option<f64>,
    /// Largest deviation of the real value from the value in the file, up or down \[SI\].
    pub tolerance: Option<f64>,
}

/// A parameter that follows from others cannot be set.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{name}` is derived from other parameters; set those")]
pub struct DerivedParameter {
    /// Name of the parameter.
    pub name: String,
}

impl Parameter {
    /// Checks that it can be set.
    ///
    /// # Errors
    ///
    /// It is derived.
    pub fn check_settable(&self) -> Result<(), DerivedParameter> {
        if self.derived {
            return Err(DerivedParameter {
                name: self.name.clone(),
            });
        }
        Ok(())
    }
}

impl Mechanism {
    /// Returns the file's values of all parameters, in parameter order.
    #[must_use]
    pub fn default_parameters(&self) -> Vec<f64> {
        self.parameters.iter().map(|p| p.default).collect()
    }

    /// Computes the derived parameters from the others. Allocates nothing.
    ///
    /// `values` is as long as [`Mechanism::parameters`]. A derivation that leaves its domain gives
    /// a value that is not finite. On [`Jet`](super::Jet)s it carries derivatives along.
    pub fn derive_parameters<N: Number>(&self, values: &mut [N]) {
        for id in &self.derivation_order {
            values[id.index()] = self.parameters[id.index()]
                .expression
                .evaluate(&|p| values[p.index()], N::constant(0.0));
        }
    }
}
