//! Angles in degrees and their functions.
//!
//! LinuxCNC multiplies by π and divides by 180 in numbers of 64 bits (`long double`), so that the sine of 30
//! is 0.5 and the tangent of 45 is 1; in plain `f64` both are a little less, and FIX would make 0 of the
//! latter. Here an angle is a sum of two `f64`, rounded to 64 bits where LinuxCNC rounds, and
//!
//! | | |
//! |---|---|
//! | a = h + l, l of the order of an ulp of h | the angle, radians |
//! | sin a = sin h + l cos h, cos a = cos h - l sin h | its sine and cosine |

use libm::{sincos, tan};
use std::f64::consts::PI;

/// π of 64 bits is `PI + PI_LOW`.
const PI_LOW: f64 = 1.22514845490862e-16;

/// An angle in radians, as the sum of two numbers.
#[derive(Clone, Copy)]
struct Radians {
    high: f64,
    low: f64,
}

impl Radians {
    fn from_degrees(degrees: f64) -> Radians {
        let high = degrees * PI;
        let product = rounded(high, degrees.mul_add(PI, -high) + degrees * PI_LOW);
        let high = product.high / 180.0;
        rounded(high, ((-high).mul_add(180.0, product.high) + product.low) / 180.0)
    }
}

/// `high + low` with 64 bits: the last of them is 2^-63 of the power of two in `high`.
fn rounded(high: f64, low: f64) -> Radians {
    let power = f64::from_bits(high.to_bits() & (0x7ff << 52));
    let grid = 1.5 * power / 2048.0;
    Radians { high, low: (low + grid) - grid }
}

/// Sine of an angle in degrees.
pub(crate) fn sine(degrees: f64) -> f64 {
    let Radians { high, low } = Radians::from_degrees(degrees);
    let (sin, cos) = sincos(high);
    sin + low * cos
}

/// Cosine of an angle in degrees.
pub(crate) fn cosine(degrees: f64) -> f64 {
    let Radians { high, low } = Radians::from_degrees(degrees);
    let (sin, cos) = sincos(high);
    cos - low * sin
}

/// Tangent of an angle in degrees.
pub(crate) fn tangent(degrees: f64) -> f64 {
    let Radians { high, low } = Radians::from_degrees(degrees);
    let tangent = tan(high);
    if tangent.abs() > 1e6 {
        return sine(degrees) / cosine(degrees);
    }
    tangent + low * (1.0 + tangent * tangent)
}

/// The angle of a point, -180 to 180 degrees.
pub(crate) fn arc_tangent(y: f64, x: f64) -> f64 {
    from_radians(libm::atan2(y, x))
}

/// Radians in degrees: 180 times the angle, divided by π of 64 bits.
pub(crate) fn from_radians(radians: f64) -> f64 {
    let numerator = radians * 180.0;
    let quotient = numerator / PI;
    let rest = (-quotient).mul_add(PI, numerator) - quotient * PI_LOW;
    quotient + rest / PI
}
