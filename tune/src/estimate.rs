//! A value that was identified, and how well it is known.

/// A value with its standard deviation, in the unit of the value.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Its standard deviation, from what the model leaves of the measurements.
    pub deviation: f64,
}
