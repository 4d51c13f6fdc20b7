//! Partial derivatives, output derivatives and dependencies.

use super::access::check_count;
use super::types::{
    fmi3Constant, fmi3DependencyKind, fmi3Dependent, fmi3Float64, fmi3Int32, fmi3ValueReference,
};
use crate::fmi::abi::arguments::{fill, room, slice, write};
use crate::fmi::abi::calls::instance_calls;
use crate::fmi::{Call, DependencyKind};

/// Defines the functions of partial derivatives, each with the lengths of its seed and of its
/// sensitivity for some unknowns and knowns.
macro_rules! partial_derivatives {
    ($($(#[$doc:meta])* $function:ident = $method:ident, $lengths:expr;)*) => {
        instance_calls! {
                    $(
                $(#[$doc])*
                $function(
                    unknowns: *const fmi3ValueReference,
                    n_unknowns: usize,
                    knowns: *const fmi3ValueReference,
                    n_knowns: usize,
                    seed: *const fmi3Float64,
                    n_seed: usize,
                    sensitivity: *mut fmi3Float64,
                    n_sensitivity: usize,
                ) = |instance| {
                    let [of_seed, of_sensitivity] = ($lengths)(n_unknowns, n_knowns);
                    check_count("nSeed", n_seed, of_seed)?;
                    check_count("nSensitivity", n_sensitivity, of_sensitivity)?;
                    let unknowns = slice("unknowns", unknowns, n_unknowns)?;
                    let knowns = slice("knowns", knowns, n_knowns)?;
                    let seed = slice("seed", seed, n_seed)?;
                    let room = room("sensitivity", sensitivity, n_sensitivity)?;
                    fill(room, instance.$method(&unknowns, &knowns, &seed)?);
                    Ok(())
                };
            )*
        }
    };
}

partial_derivatives! {
    /// `fmi3GetDirectionalDerivative`.
    fmi3GetDirectionalDerivative = directional_derivative, |unknowns, knowns| [knowns, unknowns];
    /// `fmi3GetAdjointDerivative`.
    fmi3GetAdjointDerivative = adjoint_derivative, |unknowns, knowns| [unknowns, knowns];
}

instance_calls! {
    /// `fmi3GetOutputDerivatives`.
    fmi3GetOutputDerivatives(
        value_references: *const fmi3ValueReference,
        n_value_references: usize,
        orders: *const fmi3Int32,
        values: *mut fmi3Float64,
        n_values: usize,
    ) = |instance| {
        check_count("nValues", n_values, n_value_references)?;
        let references = slice("valueReferences", value_references, n_value_references)?;
        let orders = slice("orders", orders, n_value_references)?;
        let room = room("values", values, n_values)?;
        fill(room, instance.output_derivatives(&references, &orders)?);
        Ok(())
    };
    /// `fmi3GetNumberOfVariableDependencies`.
    fmi3GetNumberOfVariableDependencies(
        value_reference: fmi3ValueReference,
        n_dependencies: *mut usize,
    ) = |instance| {
        let call = Call::GetNumberOfVariableDependencies;
        let dependencies = instance.dependencies(call, value_reference)?;
        write("nDependencies", n_dependencies, dependencies.len())
    };
    /// `fmi3GetVariableDependencies`. Each variable has one element, for which the index 1 stands.
    fmi3GetVariableDependencies(
        dependent: fmi3ValueReference,
        element_indices_of_dependent: *mut usize,
        independents: *mut fmi3ValueReference,
        element_indices_of_independents: *mut usize,
        dependency_kinds: *mut fmi3DependencyKind,
        n_dependencies: usize,
    ) = |instance| {
        let found = instance.dependencies(Call::GetVariableDependencies, dependent)?;
        check_count("nDependencies", n_dependencies, found.len())?;
        let n = n_dependencies;
        let of_dependent = room("elementIndicesOfDependent", element_indices_of_dependent, n)?;
        let variables = room("independents", independents, n)?;
        let name = "elementIndicesOfIndependents";
        let of_independents = room(name, element_indices_of_independents, n)?;
        let kinds = room("dependencyKinds", dependency_kinds, n)?;
        fill(of_dependent, found.iter().map(|_| 1));
        fill(variables, found.iter().map(|(vr, _)| *vr));
        fill(of_independents, found.iter().map(|_| 1));
        fill(kinds, found.iter().map(|(_, kind)| match kind {
            DependencyKind::Dependent => fmi3Dependent,
            DependencyKind::Constant => fmi3Constant,
        }));
        Ok(())
    };
}
