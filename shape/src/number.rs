//! What a formula can be evaluated for: numbers, Taylor series of a parameter, and either with its gradient.
//!
//! In: values of the variables, numbers as they are written in the formula, angles in rad. Out: the value in
//! the same form. All functions are those of libm, so they are the same on every machine.

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

impl Function {
    /// All of them; the place of each is its number in machine code.
    pub const ALL: [Function; 12] = [
        Function::Sqrt,
        Function::Exp,
        Function::Ln,
        Function::Sin,
        Function::Cos,
        Function::Tan,
        Function::Asin,
        Function::Acos,
        Function::Atan,
        Function::Sinh,
        Function::Cosh,
        Function::Tanh,
    ];
}

/// A value that formulas are evaluated for. Outside the domain of a function the result is not finite.
pub trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// A constant.
    fn constant(value: f64) -> Self;

    /// A function of it.
    fn apply(self, function: Function) -> Self;

    /// A whole power, by squaring; so it exists at 0 with all its derivatives if the exponent is not
    /// negative.
    fn powi(self, exponent: i32) -> Self {
        let mut left = exponent.unsigned_abs();
        let (mut square, mut power) = (self, None);
        while left > 0 {
            if left & 1 == 1 {
                power = Some(power.map_or(square, |power| power * square));
            }
            left >>= 1;
            if left > 0 {
                square = square * square;
            }
        }
        let one = Self::constant(1.0);
        match power {
            None => one,
            Some(power) if exponent < 0 => one / power,
            Some(power) => power,
        }
    }

    /// The square root.
    fn sqrt(self) -> Self {
        self.apply(Function::Sqrt)
    }
}

impl Number for f64 {
    fn constant(value: f64) -> f64 {
        value
    }

    fn apply(self, function: Function) -> f64 {
        match function {
            Function::Sqrt => libm::sqrt(self),
            Function::Exp => libm::exp(self),
            Function::Ln => libm::log(self),
            Function::Sin => libm::sin(self),
            Function::Cos => libm::cos(self),
            Function::Tan => libm::tan(self),
            Function::Asin => libm::asin(self),
            Function::Acos => libm::acos(self),
            Function::Atan => libm::atan(self),
            Function::Sinh => libm::sinh(self),
            Function::Cosh => libm::cosh(self),
            Function::Tanh => libm::tanh(self),
        }
    }
}

/// A value with its partial derivatives by both variables. `Gradient<Series>` holds ψ, ψ_x, ψ_y as series
/// along a path.
///
/// ```
/// use shape::{Gradient, Number};
/// let [x, y] = Gradient::variables(3.0, 2.0);
/// let product = x * x * y;
/// assert_eq!((product.value, product.x, product.y), (18.0, 12.0, 9.0));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gradient<T> {
    /// The value.
    pub value: T,
    /// Its derivative by x.
    pub x: T,
    /// Its derivative by y.
    pub y: T,
}

impl<T: Number> Gradient<T> {
    /// The variables at a place.
    #[must_use]
    pub fn variables(x: T, y: T) -> [Gradient<T>; 2] {
        let (zero, one) = (T::constant(0.0), T::constant(1.0));
        [Gradient { value: x, x: one, y: zero }, Gradient { value: y, x: zero, y: one }]
    }

    /// A function with this `value` and `slope` here.
    fn chain(self, value: T, slope: T) -> Gradient<T> {
        Gradient { value, x: slope * self.x, y: slope * self.y }
    }
}

impl<T: Number> Add for Gradient<T> {
    type Output = Gradient<T>;

    fn add(self, other: Gradient<T>) -> Gradient<T> {
        Gradient { value: self.value + other.value, x: self.x + other.x, y: self.y + other.y }
    }
}

impl<T: Number> Sub for Gradient<T> {
    type Output = Gradient<T>;

    fn sub(self, other: Gradient<T>) -> Gradient<T> {
        Gradient { value: self.value - other.value, x: self.x - other.x, y: self.y - other.y }
    }
}

impl<T: Number> Neg for Gradient<T> {
    type Output = Gradient<T>;

    fn neg(self) -> Gradient<T> {
        Gradient { value: -self.value, x: -self.x, y: -self.y }
    }
}

impl<T: Number> Mul for Gradient<T> {
    type Output = Gradient<T>;

    fn mul(self, other: Gradient<T>) -> Gradient<T> {
        let (a, b) = (self.value, other.value);
        Gradient { value: a * b, x: a * other.x + b * self.x, y: a * other.y + b * self.y }
    }
}

impl<T: Number> Div for Gradient<T> {
    type Output = Gradient<T>;

    #[expect(
        clippy::suspicious_arithmetic_impl,
        reason = "the rule of quotients has a difference and a product"
    )]
    fn div(self, other: Gradient<T>) -> Gradient<T> {
        let value = self.value / other.value;
        let by = |above: T, below: T| (above - value * below) / other.value;
        Gradient { value, x: by(self.x, other.x), y: by(self.y, other.y) }
    }
}

impl<T: Number> Number for Gradient<T> {
    fn constant(value: f64) -> Gradient<T> {
        let zero = T::constant(0.0);
        Gradient { value: T::constant(value), x: zero, y: zero }
    }

    fn apply(self, function: Function) -> Gradient<T> {
        let u = self.value;
        let value = u.apply(function);
        let one = T::constant(1.0);
        let slope = match function {
            Function::Sqrt => T::constant(0.5) / value,
            Function::Exp => value,
            Function::Ln => one / u,
            Function::Sin => u.apply(Function::Cos),
            Function::Cos => -u.apply(Function::Sin),
            Function::Tan => one + value * value,
            Function::Asin => one / (one - u * u).sqrt(),
            Function::Acos => -(one / (one - u * u).sqrt()),
            Function::Atan => one / (one + u * u),
            Function::Sinh => u.apply(Function::Cosh),
            Function::Cosh => u.apply(Function::Sinh),
            Function::Tanh => one - value * value,
        };
        self.chain(value, slope)
    }
}
