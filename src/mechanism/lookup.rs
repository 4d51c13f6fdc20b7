//! Search for parts of a mechanism by name.

use super::expression::{FunctionNames, Scope, Signature};
use super::names::NameTable;
use super::{BodyId, DriverId, Expression, ExpressionError, Mechanism, ParameterId, Variable};

impl Mechanism {
    /// Returns the parameter called `name`.
    #[must_use]
    pub fn parameter_id(&self, name: &str) -> Option<ParameterId> {
        let index = self.parameters.iter().position(|p| p.name == name)?;
        Some(ParameterId(index))
    }

    /// Returns the moving body called `name`.
    #[must_use]
    pub fn body_id(&self, name: &str) -> Option<BodyId> {
        let index = self.bodies.iter().position(|body| body.name == name)?;
        Some(BodyId(index))
    }

    /// Returns the driver called `name`.
    #[must_use]
    pub fn driver_id(&self, name: &str) -> Option<DriverId> {
        let index = self.drivers.iter().position(|driver| driver.name == name)?;
        Some(DriverId(index))
    }

    /// Parses an expression over this mechanism's parameters, its functions and `variable`.
    ///
    /// # Errors
    ///
    /// First fault of the text: syntax, an unknown name, or a constant part that is not finite.
    pub fn parse_expression(
        &self,
        text: &str,
        variable: Option<Variable>,
    ) -> Result<Expression, ExpressionError> {
        let names = self.parameters.iter().map(|p| p.name.as_str());
        let parameters: NameTable<'_, ParameterId> = names.zip((0..).map(ParameterId)).collect();
        let functions = self.functions.list().iter().enumerate();
        let known = functions.map(|(place, function)| {
            let arguments = Some(function.arguments);
            (function.name.as_str(), Signature { place, arguments })
        });
        let functions = FunctionNames {
            known: known.collect(),
            list: self.functions.clone(),
        };
        let scope = Scope {
            functions: Some(&functions),
            ..Scope::new(&parameters, variable.as_slice())
        };
        Expression::parse(text, scope)
    }
}
