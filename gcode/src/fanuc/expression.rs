//! Values of custom macro B. In: a cursor, the variables, the state. Out: an f64, always finite, or vacant;
//! angles in degrees.
//!
//! Highest first: functions · `*` `/` `AND` `MOD` · `+` `-` `OR` `XOR` · `EQ` `NE` `GT` `GE` `LT` `LE`, those
//! of one rank from left to right. A vacant variable alone stays vacant: an address with it is left out of
//! its block, EQ and NE tell it from 0. Everywhere else it counts as 0.

use super::variables::Variables;
use crate::problem::{Blame, Problem, Span, short};
use crate::state::State;
use crate::text::{Cursor, Depth, Operator, degrees, number};

/// A value; `None` is vacant.
pub(super) type Value = Result<Option<f64>, Box<Problem>>;

/// Numbers nearer than this are equal: half of what a control with nine digits shows.
const EQUAL: f64 = 1e-8;

/// Reads the values of one line.
pub(super) struct Values<'a> {
    pub(super) variables: &'a Variables,
    pub(super) state: &'a State,
    pub(super) depth: Depth,
}

#[derive(Clone, Copy)]
enum Function {
    /// One argument; not finite where there is no value.
    Of(&'static str, fn(f64) -> f64),
    ArcTangent,
    Power,
}

/// The longer of two names that begin alike comes first.
const FUNCTIONS: [(&str, Function); 20] = [
    ("sin", Function::Of("SIN", degrees::sine)),
    ("cos", Function::Of("COS", degrees::cosine)),
    ("tan", Function::Of("TAN", degrees::tangent)),
    ("asin", Function::Of("ASIN", |a| libm::asin(a).to_degrees())),
    ("acos", Function::Of("ACOS", |a| libm::acos(a).to_degrees())),
    ("atan", Function::ArcTangent),
    ("sqrt", Function::Of("SQRT", f64::sqrt)),
    ("sqr", Function::Of("SQRT", f64::sqrt)),
    ("abs", Function::Of("ABS", f64::abs)),
    ("bin", Function::Of("BIN", |a| recoded(a, 16, 10))),
    ("bcd", Function::Of("BCD", |a| recoded(a, 10, 16))),
    ("round", Function::Of("ROUND", f64::round)),
    ("rnd", Function::Of("ROUND", f64::round)),
    ("fix", Function::Of("FIX", f64::trunc)),
    ("fup", Function::Of("FUP", |a| a.abs().ceil().copysign(a))),
    ("ln", Function::Of("LN", libm::log)),
    ("exp", Function::Of("EXP", libm::exp)),
    ("pow", Function::Power),
    ("asn", Function::Of("ASIN", |a| libm::asin(a).to_degrees())),
    ("acs", Function::Of("ACOS", |a| libm::acos(a).to_degrees())),
];

impl Values<'_> {
    /// Reads one value: a number, a variable, a function, brackets, with a sign or without.
    ///
    /// # Errors
    /// It is missing, or cannot be computed.
    pub(super) fn value(&mut self, cursor: &mut Cursor) -> Value {
        match cursor.peek() {
            Some(b'0'..=b'9' | b'.') => number(cursor).map(Some),
            Some(sign @ (b'-' | b'+')) => {
                cursor.skip();
                let value = self.nested(cursor, Values::value)?;
                Ok(value.map(|value| if sign == b'-' { -value } else { value }))
            }
            Some(b'#') => self.variable(cursor),
            Some(b'[') => self.bracket(cursor),
            Some(b'a'..=b'z') => self.function(cursor).map(Some),
            _ => {
                let help = "write a number, a variable such as #101, or an expression such as [#1+2.5]";
                Err(cursor.error_here("missing-value", "a value is missing here", help))
            }
        }
    }

    /// `[...]`.
    ///
    /// # Errors
    /// A bracket is missing, or the value cannot be computed.
    pub(super) fn bracket(&mut self, cursor: &mut Cursor) -> Value {
        open(cursor)?;
        let value = self.nested(cursor, Values::expression)?;
        close(cursor)?;
        Ok(value)
    }

    /// What stands after `=`.
    ///
    /// # Errors
    /// As for [`Values::value`].
    pub(super) fn expression(&mut self, cursor: &mut Cursor) -> Value {
        self.chain(1, cursor)
    }

    /// The number of a variable, its `#` taken already.
    ///
    /// # Errors
    /// It is vacant, or not a whole number.
    pub(super) fn index(&mut self, start: u32, cursor: &mut Cursor) -> Result<u32, Box<Problem>> {
        let index = self.nested(cursor, Values::value)?;
        match index.map(f64::round) {
            Some(whole) if (0.0..1e6).contains(&whole) => Ok(whole as u32),
            other => {
                let message = match other {
                    Some(value) => format!("there is no variable #{}", short(value)),
                    None => "the number of the variable is vacant".into(),
                };
                let help = "give a whole number, such as #101 or #[#1+100]";
                Err(cursor.error_from(start, "bad-parameter", message, help))
            }
        }
    }

    fn variable(&mut self, cursor: &mut Cursor) -> Value {
        let start = cursor.mark();
        cursor.skip();
        let index = self.index(start, cursor)?;
        self.variables.get(index, self.state, Blame::Span(cursor.span(start)))
    }

    fn nested(&mut self, cursor: &mut Cursor, what: fn(&mut Self, &mut Cursor) -> Value) -> Value {
        self.depth.enter(cursor, "variable")?;
        let value = what(self, cursor);
        self.depth.leave();
        value
    }

    /// A value and what operators of at least `rank` make of it.
    fn chain(&mut self, rank: u8, cursor: &mut Cursor) -> Value {
        let start = cursor.mark();
        let mut value = if rank > 3 { return self.value(cursor) } else { self.chain(rank + 1, cursor)? };
        loop {
            let before = cursor.clone();
            let Some(operator) = Operator::take(cursor).filter(|operator| rank_of(*operator) == rank) else {
                *cursor = before;
                return Ok(value);
            };
            let right = self.chain(rank + 1, cursor)?;
            let result = apply(operator, value, right);
            value = Some(result.map_err(|reason| arithmetic(reason, cursor.span(start)))?);
        }
    }

    fn function(&mut self, cursor: &mut Cursor) -> Result<f64, Box<Problem>> {
        let start = cursor.mark();
        let Some(function) = cursor.take_name(&FUNCTIONS) else {
            let help = "functions: SIN COS TAN ASIN ACOS ATAN SQRT ABS BIN BCD ROUND FIX FUP LN EXP POW; there is no \
                        printing (POPEN, DPRNT) and no SETVN";
            return Err(cursor.error_here("unknown-function", "there is no function of this name", help));
        };
        let value = match function {
            Function::ArcTangent => self.arc_tangent(cursor)?,
            Function::Power => {
                let (base, exponent) = self.pair(cursor)?;
                libm::pow(base, exponent.unwrap_or(1.0))
            }
            Function::Of(name, function) => {
                let argument = self.bracket(cursor)?.unwrap_or(0.0);
                let value = function(argument);
                if !value.is_finite() {
                    return Err(arithmetic(
                        &format!("{name} of {} has no value", short(argument)),
                        cursor.span(start),
                    ));
                }
                value
            }
        };
        if value.is_finite() { Ok(value) } else { Err(arithmetic("it has no value", cursor.span(start))) }
    }

    /// `ATAN[y]/[x]` and `ATAN[y,x]`, 0 to 360 degrees; `ATAN[a]`, -90 to 90 degrees.
    fn arc_tangent(&mut self, cursor: &mut Cursor) -> Result<f64, Box<Problem>> {
        let (y, mut x) = self.pair(cursor)?;
        let before = cursor.clone();
        if x.is_none() && cursor.take_if(b'/') {
            if cursor.peek() == Some(b'[') {
                x = Some(self.bracket(cursor)?.unwrap_or(0.0));
            } else {
                *cursor = before;
            }
        }
        Ok(match x {
            None => libm::atan(y).to_degrees(),
            Some(x) => match libm::atan2(y, x).to_degrees() {
                angle if angle < 0.0 => angle + 360.0,
                angle => angle,
            },
        })
    }

    /// `[a]` or `[a,b]`.
    fn pair(&mut self, cursor: &mut Cursor) -> Result<(f64, Option<f64>), Box<Problem>> {
        open(cursor)?;
        let first = self.nested(cursor, Values::expression)?.unwrap_or(0.0);
        let second = match cursor.take_if(b',') {
            true => Some(self.nested(cursor, Values::expression)?.unwrap_or(0.0)),
            false => None,
        };
        close(cursor)?;
        Ok((first, second))
    }
}

fn open(cursor: &mut Cursor) -> Result<(), Box<Problem>> {
    if cursor.take_if(b'[') {
        return Ok(());
    }
    let help = "put it in brackets, as in SQRT[2] or IF[#1 LT 10]";
    Err(cursor.error_here("missing-bracket", "an opening bracket is missing here", help))
}

fn close(cursor: &mut Cursor) -> Result<(), Box<Problem>> {
    if cursor.take_if(b']') {
        return Ok(());
    }
    if cursor.peek().is_none() {
        let help = "close every [ with a ]";
        return Err(cursor.error_here("missing-bracket", "the closing bracket is missing", help));
    }
    let help = "operators: + - * / AND OR XOR MOD EQ NE GT GE LT LE";
    Err(cursor.error_here("unknown-operator", "an operator or ] was expected here", help))
}

fn arithmetic(reason: &str, span: Span) -> Box<Problem> {
    let blame = Blame::Span(span);
    Problem::error(
        "arithmetic",
        blame,
        format!("cannot be computed: {reason}"),
        "check the values that enter it",
    )
}

/// Operators of higher rank come first.
fn rank_of(operator: Operator) -> u8 {
    use Operator::*;
    match operator {
        Times | Divide | And | Modulo => 3,
        Plus | Minus | Or | ExclusiveOr => 2,
        _ => 1,
    }
}

fn apply(operator: Operator, left: Option<f64>, right: Option<f64>) -> Result<f64, &'static str> {
    use Operator::*;
    let (a, b) = (left.unwrap_or(0.0), right.unwrap_or(0.0));
    let near = (a - b).abs() < EQUAL;
    let equal = near && left.is_some() == right.is_some();
    let value = match operator {
        // This dialect does not read `**`.
        Power => libm::pow(a, b),
        Times => a * b,
        Divide if b == 0.0 => return Err("division by zero"),
        Divide => a / b,
        Modulo if b.round() == 0.0 => return Err("MOD by zero"),
        Modulo => a.round() % b.round(),
        Plus => a + b,
        Minus => a - b,
        And => (bits(a)? & bits(b)?) as f64,
        Or => (bits(a)? | bits(b)?) as f64,
        ExclusiveOr => (bits(a)? ^ bits(b)?) as f64,
        Equal => f64::from(equal),
        NotEqual => f64::from(!equal),
        Greater => f64::from(a > b && !near),
        GreaterOrEqual => f64::from(a > b || near),
        Less => f64::from(a < b && !near),
        LessOrEqual => f64::from(a < b || near),
    };
    if value.is_finite() { Ok(value) } else { Err("the value is too large for a number") }
}

/// A number as 32 bits.
fn bits(value: f64) -> Result<i64, &'static str> {
    let whole = value.round();
    let fits = (-2_147_483_648.0..=4_294_967_295.0).contains(&whole);
    if fits { Ok(whole as i64) } else { Err("AND, OR and XOR take whole numbers of 32 bits") }
}

/// The digits of a number in one base, read as digits of another: BIN (16 to 10) and BCD (10 to 16).
fn recoded(value: f64, from: u64, to: u64) -> f64 {
    let mut rest = value.round();
    // Eight digits of either base.
    if !(0.0..(from as f64).powi(8)).contains(&rest) {
        return f64::NAN;
    }
    let (mut result, mut place) = (0.0, 1.0);
    while rest >= 1.0 {
        let digit = rest % from as f64;
        if digit > 9.0 {
            return f64::NAN;
        }
        result += digit * place;
        place *= to as f64;
        rest = (rest / from as f64).trunc();
    }
    result
}
