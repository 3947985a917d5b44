//! Taylor series of order 3: a function of a parameter about one place, with all of its first three
//! derivatives.
//!
//! | symbol | meaning |
//! |---|---|
//! | τ | the parameter from the place of the series |
//! | cₙ | coefficients: u = c₀ + c₁ τ + c₂ τ² + c₃ τ³, so the n-th derivative is n! cₙ |
//! | fₙ | coefficients of a function about c₀ |
//! | s, σ | length of a curve, and its speed \|dp/dτ\| = ds/dτ |
//!
//! ```text
//! product    wₙ = Σ uₖ vₙ₋ₖ            quotient   qₙ = (uₙ − Σ qₖ vₙ₋ₖ)/v₀, k < n
//! f(u) = f₀ + f₁ c₁ τ + (f₁ c₂ + f₂ c₁²) τ² + (f₁ c₃ + 2 f₂ c₁ c₂ + f₃ c₁³) τ³
//! s = a₁ τ + a₂ τ² + a₃ τ³  ⇒  τ = s/a₁ − a₂/a₁³ s² + (2 a₂² − a₁ a₃)/a₁⁵ s³                        (M83)
//! ```
//!
//! Source: arithmetic of power series, cut after the third power; the reversion is Lagrange's.

use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::number::{Function, Number};

/// A function of a parameter t about one place: `c0 + c1 τ + c2 τ² + c3 τ³`, τ from that place.
///
/// ```
/// use shape::{Function, Number, Series};
/// let sine = Series::variable(0.0).apply(Function::Sin);
/// assert_eq!(sine.0, [0.0, 1.0, 0.0, -1.0 / 6.0]);
/// assert_eq!(sine.derivative(3), -1.0);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Series(pub [f64; 4]);

impl Series {
    /// The parameter itself, about `t`.
    #[must_use]
    pub fn variable(t: f64) -> Series {
        Series([t, 1.0, 0.0, 0.0])
    }

    /// The value at its place.
    #[must_use]
    pub fn value(&self) -> f64 {
        self.0[0]
    }

    /// The n-th derivative at its place; the value for n = 0, and 0 for n > 3, which the series does not
    /// know.
    #[must_use]
    pub fn derivative(&self, n: usize) -> f64 {
        const FACTORIAL: [f64; 4] = [1.0, 1.0, 2.0, 6.0];
        self.0.get(n).zip(FACTORIAL.get(n)).map_or(0.0, |(c, factorial)| c * factorial)
    }

    /// The value beside its place. The error is that of the cut: of order τ⁴.
    #[must_use]
    pub fn at(&self, tau: f64) -> f64 {
        let [c0, c1, c2, c3] = self.0;
        c0 + tau * (c1 + tau * (c2 + tau * c3))
    }

    /// The derivative as a series. It is known to order 2; its third coefficient is 0 for that reason.
    #[must_use]
    pub fn slope(&self) -> Series {
        let [_, c1, c2, c3] = self.0;
        Series([c1, 2.0 * c2, 3.0 * c3, 0.0])
    }

    /// The integral from the place of the series on. What the last coefficient would add is beyond order 3.
    #[must_use]
    pub fn integral(&self) -> Series {
        let [c0, c1, c2, _] = self.0;
        Series([0.0, c0, c1 / 2.0, c2 / 3.0])
    }

    /// Whether all coefficients are finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.0.iter().all(|c| c.is_finite())
    }

    /// f(u) for a function with the coefficients `f` about the value of u.
    fn chain(self, [f0, f1, f2, f3]: [f64; 4]) -> Series {
        let [_, c1, c2, c3] = self.0;
        Series([f0, f1 * c1, f1 * c2 + f2 * c1 * c1, f1 * c3 + 2.0 * f2 * c1 * c2 + f3 * c1 * c1 * c1])
    }

    /// This function of another parameter: `inner` is the own parameter τ, as a function of the other one. So
    /// `inner` begins with 0 where both series have their place; its value is not looked at.
    #[must_use]
    pub fn of(self, inner: Series) -> Series {
        inner.chain(self.0)
    }

    /// The inverse function (M83): from s(τ), whose value is not looked at, τ as a function of the way s from
    /// there. Not finite where s′ = 0.
    #[must_use]
    pub fn reversed(self) -> Series {
        let [_, a1, a2, a3] = self.0;
        let b1 = 1.0 / a1;
        let square = b1 * b1;
        Series([0.0, b1, -a2 * b1 * square, (2.0 * a2 * a2 - a1 * a3) * b1 * square * square])
    }

    /// Length of the square root of a sum of squares.
    #[must_use]
    pub fn hypot(self, other: Series) -> Series {
        (self * self + other * other).sqrt()
    }

    /// Angle of the point (`x`, self), rad, −π … π; not finite at the origin. It is found by turning the
    /// point to the direction of x first, so no quadrant is special.
    #[must_use]
    pub fn atan2(self, x: Series) -> Series {
        let (x0, y0) = (x.value(), self.value());
        let along = x * x0 + self * y0;
        let across = self * x0 - x * y0;
        let mut angle = (across / along).apply(Function::Atan);
        angle.0[0] += libm::atan2(y0, x0);
        angle
    }
}

/// Length of a curve from the place of its series on, as a function of their parameter: s, with s = 0 there.
/// Not finite where the curve stands still.
#[must_use]
pub fn length(curve: &[Series]) -> Series {
    let square = curve.iter().fold(Series::default(), |sum, axis| {
        let slope = axis.slope();
        sum + slope * slope
    });
    square.sqrt().integral()
}

impl Add for Series {
    type Output = Series;

    fn add(self, other: Series) -> Series {
        let ([a0, a1, a2, a3], [b0, b1, b2, b3]) = (self.0, other.0);
        Series([a0 + b0, a1 + b1, a2 + b2, a3 + b3])
    }
}

impl Sub for Series {
    type Output = Series;

    fn sub(self, other: Series) -> Series {
        let ([a0, a1, a2, a3], [b0, b1, b2, b3]) = (self.0, other.0);
        Series([a0 - b0, a1 - b1, a2 - b2, a3 - b3])
    }
}

impl Neg for Series {
    type Output = Series;

    fn neg(self) -> Series {
        Series(self.0.map(|c| -c))
    }
}

impl Mul<f64> for Series {
    type Output = Series;

    fn mul(self, factor: f64) -> Series {
        Series(self.0.map(|c| c * factor))
    }
}

impl Mul for Series {
    type Output = Series;

    fn mul(self, other: Series) -> Series {
        let ([a0, a1, a2, a3], [b0, b1, b2, b3]) = (self.0, other.0);
        Series([
            a0 * b0,
            a0 * b1 + a1 * b0,
            a0 * b2 + a1 * b1 + a2 * b0,
            a0 * b3 + a1 * b2 + a2 * b1 + a3 * b0,
        ])
    }
}

impl Div for Series {
    type Output = Series;

    fn div(self, other: Series) -> Series {
        let ([a0, a1, a2, a3], [b0, b1, b2, b3]) = (self.0, other.0);
        let q0 = a0 / b0;
        let q1 = (a1 - q0 * b1) / b0;
        let q2 = (a2 - q0 * b2 - q1 * b1) / b0;
        Series([q0, q1, q2, (a3 - q0 * b3 - q1 * b2 - q2 * b1) / b0])
    }
}

impl Number for Series {
    fn constant(value: f64) -> Series {
        Series([value, 0.0, 0.0, 0.0])
    }

    fn apply(self, function: Function) -> Series {
        let u = self.value();
        let f = u.apply(function);
        self.chain(match function {
            Function::Sqrt => [f, 0.5 / f, -0.125 / (f * u), 0.0625 / (f * u * u)],
            Function::Exp => [f, f, f / 2.0, f / 6.0],
            Function::Ln => [f, 1.0 / u, -0.5 / (u * u), 1.0 / (3.0 * u * u * u)],
            Function::Sin => {
                let c = libm::cos(u);
                [f, c, -f / 2.0, -c / 6.0]
            }
            Function::Cos => {
                let s = libm::sin(u);
                [f, -s, -f / 2.0, s / 6.0]
            }
            Function::Tan => {
                let q = 1.0 + f * f;
                [f, q, f * q, q * (1.0 + 3.0 * f * f) / 3.0]
            }
            Function::Asin => inverse_sine(f, u, 1.0),
            Function::Acos => inverse_sine(f, u, -1.0),
            Function::Atan => {
                let q = 1.0 / (1.0 + u * u);
                [f, q, -u * q * q, (3.0 * u * u - 1.0) * q * q * q / 3.0]
            }
            Function::Sinh => {
                let c = libm::cosh(u);
                [f, c, f / 2.0, c / 6.0]
            }
            Function::Cosh => {
                let s = libm::sinh(u);
                [f, s, f / 2.0, s / 6.0]
            }
            Function::Tanh => {
                let q = 1.0 - f * f;
                [f, q, -f * q, q * (3.0 * f * f - 1.0) / 3.0]
            }
        })
    }
}

/// Coefficients of the inverse sine (`sign` 1) or cosine (−1) of u, whose value is `f`.
fn inverse_sine(f: f64, u: f64, sign: f64) -> [f64; 4] {
    let square = 1.0 / ((1.0 - u) * (1.0 + u));
    let r = sign * libm::sqrt(square);
    [f, r, r * u * square / 2.0, r * (1.0 + 2.0 * u * u) * square * square / 6.0]
}
