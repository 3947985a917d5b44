//! Real values of RS274/NGC: numbers, parameters `#n`, expressions `[...]`, functions. Angles in degrees.
//! In: a cursor in a line and the parameters. Out: a finite number.
//!
//! | binds | operators (all from left to right, `**` too) |
//! |---|---|
//! | tightest | `**` |
//! | | `*` `/` `MOD` |
//! | | `+` `-` |
//! | | `EQ` `NE` `GT` `GE` `LT` `LE`: 1 or 0; numbers closer than 0.0001 are equal |
//! | loosest | `AND` `OR` `XOR`: anything but 0 is true |

use core::f64::consts::PI;

use super::cursor::Cursor;
use super::parameters::{LAST, LAST_FREE, Parameters};
use crate::diagnostic::{Diagnostic, Spot, short};

/// How deeply brackets, signs and `##` may nest.
const DEPTH: u32 = 32;
/// Numbers closer than this are equal to EQ and NE.
const EQUAL: f64 = 1e-4;

#[derive(Clone, Copy, PartialEq, Debug)]
enum Operator {
    Power,
    Times,
    Divide,
    Modulo,
    Plus,
    Minus,
    Equal,
    NotEqual,
    Greater,
    GreaterOrEqual,
    Less,
    LessOrEqual,
    And,
    Or,
    Xor,
}

use Operator::*;

const OPERATORS: [(&str, Operator); 15] = [
    ("**", Power),
    ("*", Times),
    ("/", Divide),
    ("mod", Modulo),
    ("+", Plus),
    ("-", Minus),
    ("eq", Equal),
    ("ne", NotEqual),
    ("gt", Greater),
    ("ge", GreaterOrEqual),
    ("lt", Less),
    ("le", LessOrEqual),
    ("and", And),
    ("or", Or),
    ("xor", Xor),
];

impl Operator {
    fn precedence(self) -> u32 {
        match self {
            Power => 5,
            Times | Divide | Modulo => 4,
            Plus | Minus => 3,
            Equal | NotEqual | Greater | GreaterOrEqual | Less | LessOrEqual => 2,
            And | Or | Xor => 1,
        }
    }

    /// The result, or why there is none.
    fn apply(self, a: f64, b: f64) -> Result<f64, &'static str> {
        let truth = |holds: bool| Ok(if holds { 1.0 } else { 0.0 });
        match self {
            Power if a < 0.0 && b != b.round() => {
                Err("a negative number raised to a power that is not whole")
            }
            Power => Ok(libm::pow(a, b)),
            Times => Ok(a * b),
            Divide | Modulo if b == 0.0 => Err("division by zero"),
            Divide => Ok(a / b),
            Modulo => {
                let rest = libm::fmod(a, b);
                Ok(if rest < 0.0 { rest + b.abs() } else { rest })
            }
            Plus => Ok(a + b),
            Minus => Ok(a - b),
            Equal => truth((a - b).abs() < EQUAL),
            NotEqual => truth((a - b).abs() >= EQUAL),
            Greater => truth(a > b),
            GreaterOrEqual => truth(a >= b),
            Less => truth(a < b),
            LessOrEqual => truth(a <= b),
            And => truth(a != 0.0 && b != 0.0),
            Or => truth(a != 0.0 || b != 0.0),
            Xor => truth((a != 0.0) != (b != 0.0)),
        }
    }
}

/// Reads one real value.
pub(crate) fn read_value(cursor: &mut Cursor, parameters: &Parameters) -> Result<f64, Diagnostic> {
    Reader { cursor, parameters, depth: 0 }.value()
}

/// Reads the index of a parameter, its `#` taken already, and refuses one that a program may not use.
pub(crate) fn read_index(
    cursor: &mut Cursor,
    parameters: &Parameters,
    start: usize,
) -> Result<u32, Diagnostic> {
    Reader { cursor, parameters, depth: 0 }.index(start)
}

struct Reader<'c, 't> {
    cursor: &'c mut Cursor<'t>,
    parameters: &'c Parameters,
    depth: u32,
}

impl Reader<'_, '_> {
    fn value(&mut self) -> Result<f64, Diagnostic> {
        self.depth += 1;
        if self.depth > DEPTH {
            return Err(self.cursor.error_here(
                "expression-too-deep",
                format!("more than {DEPTH} brackets, signs or # inside each other"),
                "compute part of it into a parameter on a line before, as in #1=[...]",
            ));
        }
        let start = self.cursor.mark();
        let value = match self.cursor.peek() {
            Some('[') => self.bracket(),
            Some('#') => {
                self.cursor.take();
                self.index(start).map(|index| self.parameters.get(index))
            }
            Some('+') => {
                self.cursor.take();
                self.value()
            }
            Some('-') => {
                self.cursor.take();
                self.value().map(|value| -value)
            }
            Some(c) if c.is_ascii_alphabetic() => self.function(),
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            _ => Err(missing_value(self.cursor.here())),
        }?;
        self.depth -= 1;
        let spot = self.cursor.spot(start);
        finite(value, spot)
    }

    /// Digits with at most one point.
    fn number(&mut self) -> Result<f64, Diagnostic> {
        let start = self.cursor.mark();
        let mut digits = String::new();
        while let Some(c) = self.cursor.peek().filter(|c| c.is_ascii_digit() || *c == '.') {
            digits.push(c);
            self.cursor.take();
        }
        digits.parse().map_err(|_| {
            let spot = self.cursor.spot(start);
            let help = "a number has digits and at most one decimal point, as in 12, .5 or -3.25";
            Diagnostic::error("bad-number", spot, format!("\"{digits}\" is not a number"), help)
        })
    }

    fn index(&mut self, start: usize) -> Result<u32, Diagnostic> {
        if self.cursor.peek() == Some('<') {
            self.cursor.take_rest();
            let spot = self.cursor.spot(start);
            return Err(Diagnostic::error(
                "not-available",
                spot,
                "named parameters are not available yet",
                format!("use a numbered parameter, #1 to #{LAST_FREE}"),
            ));
        }
        let index = self.value()?;
        let spot = self.cursor.spot(start);
        if (index - index.round()).abs() > 1e-6 || !(1.0..f64::from(LAST) + 0.5).contains(&index.round()) {
            let message = format!("there is no parameter number {}", short(index));
            let help = format!("use a whole number from 1 to {LAST_FREE}");
            return Err(Diagnostic::error("bad-parameter", spot, message, help));
        }
        let index = index.round() as u32;
        if index > LAST_FREE {
            let message = format!("parameter #{index} belongs to the control and is not available yet");
            let help = format!("programs may use #1 to #{LAST_FREE}");
            return Err(Diagnostic::error("not-available", spot, message, help));
        }
        Ok(index)
    }

    /// `[ a op b op c ]`
    fn bracket(&mut self) -> Result<f64, Diagnostic> {
        let start = self.cursor.mark();
        if !self.cursor.take_if('[') {
            let help = "put the argument in brackets, as in SQRT[2] or ATAN[1]/[2]";
            return Err(self.cursor.error_here(
                "missing-bracket",
                "an opening bracket is missing here",
                help,
            ));
        }
        let mut operands = vec![self.value()?];
        let mut operators: Vec<Operator> = Vec::new();
        loop {
            if self.cursor.take_if(']') {
                break;
            }
            let at = self.cursor.mark();
            let Some(operator) = self.cursor.take_name(&OPERATORS) else {
                return Err(self.no_operator(start));
            };
            while operators.last().is_some_and(|last| last.precedence() >= operator.precedence()) {
                let spot = self.cursor.spot(at);
                reduce(&mut operands, &mut operators, spot)?;
            }
            operators.push(operator);
            operands.push(self.value()?);
        }
        let spot = self.cursor.spot(start);
        while !operators.is_empty() {
            reduce(&mut operands, &mut operators, spot)?;
        }
        Ok(operands[0])
    }

    fn no_operator(&mut self, start: usize) -> Diagnostic {
        if self.cursor.peek().is_none() {
            let spot = self.cursor.spot(start);
            let help = "close every [ with a ]";
            return Diagnostic::error("missing-bracket", spot, "the closing bracket is missing", help);
        }
        self.cursor.error_here(
            "unknown-operator",
            "an operator or ] was expected here",
            "operators: + - * / ** MOD EQ NE GT GE LT LE AND OR XOR",
        )
    }

    fn function(&mut self) -> Result<f64, Diagnostic> {
        let start = self.cursor.mark();
        let name = self.cursor.take_letters();
        let name_spot = self.cursor.spot(start);
        if name == "atan" {
            return self.arc_tangent();
        }
        let function: fn(f64) -> f64 = match name.as_str() {
            "abs" => f64::abs,
            "acos" => |x| libm::acos(x) * (180.0 / PI),
            "asin" => |x| libm::asin(x) * (180.0 / PI),
            "cos" => |x| libm::cos(x * (PI / 180.0)),
            "exp" => libm::exp,
            "fix" => f64::floor,
            "fup" => f64::ceil,
            "ln" => libm::log,
            "round" => f64::round,
            "sin" => |x| libm::sin(x * (PI / 180.0)),
            "sqrt" => f64::sqrt,
            "tan" => |x| libm::tan(x * (PI / 180.0)),
            _ if self.cursor.peek() != Some('[') => return Err(missing_value(name_spot)),
            _ => {
                return Err(Diagnostic::error(
                    "unknown-function",
                    name_spot,
                    format!("there is no function {}", name.to_ascii_uppercase()),
                    "functions: ABS ACOS ASIN ATAN[]/[] COS EXP FIX FUP LN ROUND SIN SQRT TAN",
                ));
            }
        };
        let argument = self.bracket()?;
        let refused = match name.as_str() {
            "acos" | "asin" if argument.abs() > 1.0 => Some("its argument must lie between -1 and 1"),
            "ln" if argument <= 0.0 => Some("its argument must be positive"),
            "sqrt" if argument < 0.0 => Some("its argument must not be negative"),
            _ => None,
        };
        let Some(rule) = refused else { return Ok(function(argument)) };
        let spot = self.cursor.spot(start);
        let message = format!("{} of {} has no value", name.to_ascii_uppercase(), short(argument));
        Err(Diagnostic::error("arithmetic", spot, message, rule))
    }

    /// `ATAN[y]/[x]`, -180 … 180 degrees.
    fn arc_tangent(&mut self) -> Result<f64, Diagnostic> {
        let y = self.bracket()?;
        if !self.cursor.take_if('/') {
            let help = "ATAN takes two arguments, as in ATAN[1]/[2]";
            return Err(self.cursor.error_here("missing-value", "the / of ATAN is missing here", help));
        }
        let x = self.bracket()?;
        Ok(libm::atan2(y, x) * (180.0 / PI))
    }
}

fn missing_value(spot: Spot) -> Diagnostic {
    let help = "write a number, a parameter (#1), an expression ([...]) or a function (SQRT[...])";
    Diagnostic::error("missing-value", spot, "a value is missing here", help)
}

/// Applies the last operator to the last two operands.
fn reduce(operands: &mut Vec<f64>, operators: &mut Vec<Operator>, spot: Spot) -> Result<(), Diagnostic> {
    let (Some(operator), Some(b), Some(a)) = (operators.pop(), operands.pop(), operands.pop()) else {
        unreachable!("every operator stands between two operands");
    };
    let value = operator.apply(a, b).map_err(|reason| {
        Diagnostic::error("arithmetic", spot, reason, "check the values the expression is given")
    })?;
    operands.push(finite(value, spot)?);
    Ok(())
}

fn finite(value: f64, spot: Spot) -> Result<f64, Diagnostic> {
    if value.is_finite() {
        return Ok(value);
    }
    let help = "check the values the expression is given";
    Err(Diagnostic::error("arithmetic", spot, "the value is too large for a number", help))
}
