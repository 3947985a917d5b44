//! Operators between two values. In: two numbers. Out: a number; 1 or 0 for comparisons and logic.

use crate::text::{Cursor, Operator};

/// Numbers that differ by less than this are equal for EQ, NE, GE and LE (LinuxCNC's value).
const EQUAL: f64 = 1e-6;

/// Takes an operator, if one comes next.
#[inline]
pub(super) fn take(cursor: &mut Cursor) -> Option<Operator> {
    let operator = Operator::take(cursor)?;
    Some(if operator == Operator::Times && cursor.take_if(b'*') { Operator::Power } else { operator })
}

/// Operators of higher rank come first.
pub(super) fn rank(operator: Operator) -> u8 {
    use Operator::*;
    match operator {
        Power => 5,
        Times | Divide | Modulo => 4,
        Plus | Minus => 3,
        Equal | NotEqual | Greater | GreaterOrEqual | Less | LessOrEqual => 2,
        And | Or | ExclusiveOr => 1,
    }
}

/// Its value.
///
/// # Errors
/// There is none; the reason is returned.
pub(super) fn apply(operator: Operator, a: f64, b: f64) -> Result<f64, &'static str> {
    use Operator::*;
    let equal = (a - b).abs() < EQUAL;
    let truth = match operator {
        Plus => return Ok(a + b),
        Minus => return Ok(a - b),
        Times => return Ok(a * b),
        Divide if b == 0.0 => return Err("division by zero"),
        Divide => return Ok(a / b),
        Modulo if b == 0.0 => return Err("MOD by zero"),
        Modulo => return Ok(a.rem_euclid(b)),
        Power => return power(a, b),
        Equal => equal,
        NotEqual => !equal,
        Greater => a > b,
        GreaterOrEqual => a > b || equal,
        Less => a < b,
        LessOrEqual => a < b || equal,
        And => a != 0.0 && b != 0.0,
        Or => a != 0.0 || b != 0.0,
        ExclusiveOr => (a != 0.0) != (b != 0.0),
    };
    Ok(f64::from(truth))
}

fn power(a: f64, b: f64) -> Result<f64, &'static str> {
    if a < 0.0 && b.fract() != 0.0 {
        return Err("a negative number has whole powers only");
    }
    if a == 0.0 && b < 0.0 {
        return Err("0 has no negative power");
    }
    Ok(libm::pow(a, b))
}
