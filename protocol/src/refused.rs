//! Why what arrives is not taken.

/// Why a packet was refused. The receiver counts it, says so, and changes nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refused {
    /// A number is NaN or infinite.
    #[error("{0} is not a finite number")]
    NotFinite(&'static str),
    /// A number is outside what the field allows.
    #[error("{0} is out of range")]
    OutOfRange(&'static str),
    /// A code stands for nothing this version knows.
    #[error("{field} holds an unknown code {code}")]
    UnknownCode {
        /// Which.
        field: &'static str,
        /// What it holds.
        code: u32,
    },
    /// A message is missing, doubled, or out of order.
    #[error("{what}: number {expected} was expected, and {received} came")]
    OutOfOrder {
        /// What is counted.
        what: &'static str,
        /// The number that was due.
        expected: u64,
        /// The number that came.
        received: u64,
    },
    /// The bytes are none that this version writes: damaged, cut off, or more than there should be.
    #[error("{0} that cannot be read")]
    Unreadable(&'static str),
    /// The packet came after the cycle in which it should have acted.
    #[error("the packet came too late")]
    TooLate,
}

/// Refuses a value that is not finite.
pub(crate) fn finite(value: f64, name: &'static str) -> Result<f64, Refused> {
    if value.is_finite() { Ok(value) } else { Err(Refused::NotFinite(name)) }
}

/// Refuses a value that is not above 0.
pub(crate) fn positive(value: f64, name: &'static str) -> Result<(), Refused> {
    if finite(value, name)? > 0.0 { Ok(()) } else { Err(Refused::OutOfRange(name)) }
}

/// Refuses a value below 0.
pub(crate) fn not_negative(value: f64, name: &'static str) -> Result<(), Refused> {
    if finite(value, name)? >= 0.0 { Ok(()) } else { Err(Refused::OutOfRange(name)) }
}
