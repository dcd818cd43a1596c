//! Errors in the numbers that describe a gas, a boundary condition or an exact state.

/// A parameter outside its range: its name, its value, and the accepted range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum InvalidParameter {
    /// A quantity that must be positive is not.
    #[error("the {quantity} is {value}, but it must be positive and finite")]
    NotPositive {
        /// The name of the quantity.
        quantity: &'static str,
        /// Its value.
        value: f64,
    },
    /// An impossible ratio of specific heats.
    #[error("the ratio of specific heats is {value}, but it must be finite and above 1 (air: 1.4)")]
    Gamma {
        /// The value given.
        value: f64,
    },
    /// A vector with a component that is not a number, or infinite.
    #[error("component {axis} of the {quantity} is {value}, but it must be finite")]
    NotFinite {
        /// The name of the vector.
        quantity: &'static str,
        /// The axis, counted from 0.
        axis: usize,
        /// Its value.
        value: f64,
    },
    /// A direction of length zero.
    #[error("the {quantity} has length 0, but it must point somewhere")]
    NoDirection {
        /// The name of the direction.
        quantity: &'static str,
    },
    /// A vortex with a negative absolute temperature at its centre.
    #[error(
        "the vortex strength is {strength}, but at Mach number {mach} and gamma = {gamma} its size must stay below {limit}"
    )]
    VortexTooStrong {
        /// The strength given.
        strength: f64,
        /// The Mach number of the free stream.
        mach: f64,
        /// The ratio of specific heats.
        gamma: f64,
        /// The strength at which the temperature at the centre is zero.
        limit: f64,
    },
    /// A wave of a manufactured state that would make density or pressure negative.
    #[error("the relative amplitude of the waves is {value}, but it must lie in [0, 1)")]
    Amplitude {
        /// The value given.
        value: f64,
    },
}

/// `value` if it is positive and finite.
pub(crate) fn positive(quantity: &'static str, value: f64) -> Result<f64, InvalidParameter> {
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err(InvalidParameter::NotPositive { quantity, value }) }
}

/// `vector` if all its components are finite.
pub(crate) fn finite<const D: usize>(quantity: &'static str, vector: [f64; D]) -> Result<[f64; D], InvalidParameter> {
    match vector.iter().position(|c| !c.is_finite()) {
        Some(axis) => Err(InvalidParameter::NotFinite { quantity, axis, value: vector[axis] }),
        None => Ok(vector),
    }
}
