//! What a formula can be evaluated for: numbers, and Taylor series of a parameter.

use core::ops::{Add, Div, Mul, Neg, Sub};

use serde::{Deserialize, Serialize};

/// Smooth functions of one argument that a formula may hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Function {
    /// Square root.
    Sqrt,
    /// Natural exponential.
    Exp,
    /// Natural logarithm.
    Ln,
    /// Sine of an angle in rad, as of all that follow.
    Sin,
    /// Cosine.
    Cos,
    /// Tangent.
    Tan,
    /// Inverse sine.
    Asin,
    /// Inverse cosine.
    Acos,
    /// Inverse tangent.
    Atan,
    /// Hyperbolic sine.
    Sinh,
    /// Hyperbolic cosine.
    Cosh,
    /// Hyperbolic tangent.
    Tanh,
}

/// A value that formulas are evaluated for. Outside the domain of a function the result is not finite.
pub trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// A constant.
    fn constant(value: f64) -> Self;
    /// A function of it.
    fn apply(self, function: Function) -> Self;
    /// A whole power.
    fn powi(self, exponent: i32) -> Self;
}

/// A function of a parameter t about one place: `c0 + c1 τ + c2 τ² + c3 τ³`, τ from that place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Series(pub [f64; 4]);
