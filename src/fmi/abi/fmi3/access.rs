//! Setting and getting variables, all of which are scalars.

use super::types::{
    fmi3Binary, fmi3Boolean, fmi3Float32, fmi3Float64, fmi3Instance, fmi3Int8, fmi3Int16,
    fmi3Int32, fmi3Int64, fmi3Status, fmi3String, fmi3UInt8, fmi3UInt16, fmi3UInt32, fmi3UInt64,
    fmi3ValueReference,
};
use crate::fmi::abi::arguments::{Room, slice};
use crate::fmi::abi::component::{CallError, with_instance};
use crate::fmi::{Call, Error};

/// Checks that there are as many values as variables.
pub(super) fn check_count(
    name: &'static str,
    given: usize,
    expected: usize,
) -> Result<(), CallError> {
    if given == expected {
        Ok(())
    } else {
        Err(CallError::Refused(Error::Count {
            name,
            given,
            expected,
        }))
    }
}

/// `fmi3GetFloat64`.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFloat64(
    instance: fmi3Instance,
    value_references: *const fmi3ValueReference,
    n_value_references: usize,
    values: *mut fmi3Float64,
    n_values: usize,
) -> fmi3Status {
    // SAFETY: the host's promise.
    unsafe {
        with_instance(instance, "fmi3GetFloat64", |instance| {
            check_count("nValues", n_values, n_value_references)?;
            let references = slice("valueReferences", value_references, n_value_references)?;
            let room = Room::new("values", values, n_values)?;
            instance.reals(references)?.write_to(room.items());
            Ok(())
        })
    }
}

/// `fmi3SetFloat64`.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFloat64(
    instance: fmi3Instance,
    value_references: *const fmi3ValueReference,
    n_value_references: usize,
    values: *const fmi3Float64,
    n_values: usize,
) -> fmi3Status {
    // SAFETY: the host's promise.
    unsafe {
        with_instance(instance, "fmi3SetFloat64", |instance| {
            check_count("nValues", n_values, n_value_references)?;
            let references = slice("valueReferences", value_references, n_value_references)?;
            Ok(instance.set_real(references, slice("values", values, n_values)?)?)
        })
    }
}

/// `fmi3GetInt64`: the choices.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetInt64(
    instance: fmi3Instance,
    value_references: *const fmi3ValueReference,
    n_value_references: usize,
    values: *mut fmi3Int64,
    n_values: usize,
) -> fmi3Status {
    // SAFETY: the host's promise.
    unsafe {
        with_instance(instance, "fmi3GetInt64", |instance| {
            check_count("nValues", n_values, n_value_references)?;
            let references = slice("valueReferences", value_references, n_value_references)?;
            let room = Room::new("values", values, n_values)?;
            room.fill(instance.integers(references)?.map(fmi3Int64::from));
            Ok(())
        })
    }
}

/// `fmi3SetInt64`.
///
/// # Safety
///
/// The [host's promise](crate::fmi::abi#safety).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetInt64(
    instance: fmi3Instance,
    value_references: *const fmi3ValueReference,
    n_value_references: usize,
    values: *const fmi3Int64,
    n_values: usize,
) -> fmi3Status {
    // SAFETY: the host's promise.
    unsafe {
        with_instance(instance, "fmi3SetInt64", |instance| {
            check_count("nValues", n_values, n_value_references)?;
            let references = slice("valueReferences", value_references, n_value_references)?;
            Ok(instance.set_int64(references, slice("values", values, n_values)?)?)
        })
    }
}

/// The access functions of types that no variable has: right for an empty list only.
macro_rules! without_variables {
    ($($(#[$doc:meta])* $function:ident($call:ident, $values:ty, $expected:literal);)*) => {
        $(
            $(#[$doc])*
            ///
            /// # Safety
            ///
            /// The [host's promise](crate::fmi::abi#safety). `values` is not touched.
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $function(
                instance: fmi3Instance,
                value_references: *const fmi3ValueReference,
                n_value_references: usize,
                _values: $values,
                n_values: usize,
            ) -> fmi3Status {
                // SAFETY: the host's promise.
                unsafe {
                    with_instance(instance, stringify!($function), |instance| {
                        check_count("nValues", n_values, n_value_references)?;
                        let references =
                            slice("valueReferences", value_references, n_value_references)?;
                        Ok(instance.no_variables(Call::$call, $expected, references)?)
                    })
                }
            }
        )*
    };
}

without_variables! {
    /// `fmi3GetFloat32`: there are no variables of this type.
    fmi3GetFloat32(GetFloat32, *mut fmi3Float32, "Float32");
    /// `fmi3SetFloat32`: there are no variables of this type.
    fmi3SetFloat32(SetFloat32, *const fmi3Float32, "Float32");
    /// `fmi3GetInt8`: there are no variables of this type.
    fmi3GetInt8(GetInt8, *mut fmi3Int8, "Int8");
    /// `fmi3SetInt8`: there are no variables of this type.
    fmi3SetInt8(SetInt8, *const fmi3Int8, "Int8");
    /// `fmi3GetUInt8`: there are no variables of this type.
    fmi3GetUInt8(GetUInt8, *mut fmi3UInt8, "UInt8");
    /// `fmi3SetUInt8`: there are no variables of this type.
    fmi3SetUInt8(SetUInt8, *const fmi3UInt8, "UInt8");
    /// `fmi3GetInt16`: there are no variables of this type.
    fmi3GetInt16(GetInt16, *mut fmi3Int16, "Int16");
    /// `fmi3SetInt16`: there are no variables of this type.
    fmi3SetInt16(SetInt16, *const fmi3Int16, "Int16");
    /// `fmi3GetUInt16`: there are no variables of this type.
    fmi3GetUInt16(GetUInt16, *mut fmi3UInt16, "UInt16");
    /// `fmi3SetUInt16`: there are no variables of this type.
    fmi3SetUInt16(SetUInt16, *const fmi3UInt16, "UInt16");
    /// `fmi3GetInt32`: there are no variables of this type.
    fmi3GetInt32(GetInt32, *mut fmi3Int32, "Int32");
    /// `fmi3SetInt32`: there are no variables of this type.
    fmi3SetInt32(SetInt32, *const fmi3Int32, "Int32");
    /// `fmi3GetUInt32`: there are no variables of this type.
    fmi3GetUInt32(GetUInt32, *mut fmi3UInt32, "UInt32");
    /// `fmi3SetUInt32`: there are no variables of this type.
    fmi3SetUInt32(SetUInt32, *const fmi3UInt32, "UInt32");
    /// `fmi3GetUInt64`: there are no variables of this type.
    fmi3GetUInt64(GetUInt64, *mut fmi3UInt64, "UInt64");
    /// `fmi3SetUInt64`: there are no variables of this type.
    fmi3SetUInt64(SetUInt64, *const fmi3UInt64, "UInt64");
    /// `fmi3GetBoolean`: there are no variables of this type.
    fmi3GetBoolean(GetBoolean, *mut fmi3Boolean, "Boolean");
    /// `fmi3SetBoolean`: there are no variables of this type.
    fmi3SetBoolean(SetBoolean, *const fmi3Boolean, "Boolean");
    /// `fmi3GetString`: there are no variables of this type.
    fmi3GetString(GetString, *mut fmi3String, "String");
    /// `fmi3SetString`: there are no variables of this type.
    fmi3SetString(SetString, *const fmi3String, "String");
}

/// Those of binary variables, which have sizes as well.
macro_rules! without_binaries {
    ($($(#[$doc:meta])* $function:ident($call:ident, $sizes:ty, $values:ty);)*) => {
        $(
            $(#[$doc])*
            ///
            /// # Safety
            ///
            /// The [host's promise](crate::fmi::abi#safety). Sizes and values are not touched.
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $function(
                instance: fmi3Instance,
                value_references: *const fmi3ValueReference,
                n_value_references: usize,
                _value_sizes: $sizes,
                _values: $values,
                n_values: usize,
            ) -> fmi3Status {
                // SAFETY: the host's promise.
                unsafe {
                    with_instance(instance, stringify!($function), |instance| {
                        check_count("nValues", n_values, n_value_references)?;
                        let references =
                            slice("valueReferences", value_references, n_value_references)?;
                        Ok(instance.no_variables(Call::$call, "Binary", references)?)
                    })
                }
            }
        )*
    };
}

without_binaries! {
    /// `fmi3GetBinary`: there are no variables of this type.
    fmi3GetBinary(GetBinary, *mut usize, *mut fmi3Binary);
    /// `fmi3SetBinary`: there are no variables of this type.
    fmi3SetBinary(SetBinary, *const usize, *const fmi3Binary);
}
