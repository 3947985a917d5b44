//! The text of a formula to a [`Formula`].
//!
//! In: a text such as `0.02*x^2 + 8*sin(x/15)*cos(y/20)` and the names of its variables, the first of which
//! is variable 0 of the formula. Out: the formula, its constants computed; or a [`Misread`] with the place
//! and a remedy.
//!
//! | file | from | to |
//! |---|---|---|
//! | `scan` | text | words with their places; refuses what is not a formula |
//! | `grammar` | words | operations, in the order that precedence gives them |
//! | `constant` | operations | fewer operations: constants computed, powers as products or by exp and ln |
//!
//! * `+ - * / ^`, brackets, decimals with or without exponent. Capital letters are the small ones.
//! * `^` goes before a sign and from right to left, as on paper: `-x^2` is −(x²), `2^3^2` is 2⁹.
//! * A whole exponent from −64 to 63 takes any base, 0.5 a base that is not negative. All others are
//!   `exp(exponent * ln(base))`, and the base must be positive where the path goes.
//! * `pi` or `π`, `e`; `sqrt exp ln sin cos tan asin acos atan sinh cosh tanh`, angles in rad.
//! * A function without a tangent at every place (abs, floor, min, …) is refused by name.

mod constant;
mod grammar;
mod scan;

use std::fmt::{Display, Formatter};
use std::ops::Range;

use shape::{Formula, FormulaError};

/// Longest text, bytes.
const LONGEST: usize = 1000;

/// Why a text is not a formula.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Misread {
    /// The place to blame, bytes of the text; empty where something is missing.
    pub span: Range<usize>,
    /// What is wrong.
    pub message: String,
    /// What to do about it.
    pub help: String,
}

impl Misread {
    fn new(span: Range<usize>, message: impl Into<String>, help: impl Into<String>) -> Misread {
        Misread { span, message: message.into(), help: help.into() }
    }
}

impl Display for Misread {
    fn fmt(&self, out: &mut Formatter<'_>) -> std::fmt::Result {
        write!(out, "{}; {}", self.message, self.help)
    }
}

impl std::error::Error for Misread {}

/// Reads a formula of `variables`, at most two names.
///
/// ```
/// use interpreter::formula;
/// let wave = formula::parse("8*sin(x/15)*cos(y/20)", &["x", "y"]).expect("it is a formula");
/// assert_eq!(wave.eval([0.0, 3.0]), 0.0);
/// let wrong = formula::parse("2*sin(t) + 3t", &["t"]).expect_err("an operation is missing");
/// assert_eq!((wrong.span, wrong.help.as_str()), (12..13, "write 3*t"));
/// ```
///
/// # Errors
/// [`Misread`].
pub fn parse(text: &str, variables: &[&str]) -> Result<Formula, Misread> {
    if text.len() > LONGEST {
        let message = format!("the formula has {} characters, {LONGEST} are allowed", text.len());
        return Err(Misread::new(0..text.len(), message, "write it shorter"));
    }
    let words = scan::scan(text, variables)?;
    let operations = grammar::operations(&words)?;
    Formula::new(&operations).map_err(|error| {
        let help = match error {
            FormulaError::TooDeep => "fewer brackets in brackets; or a sum with its longest part first",
            _ => "write it shorter, or the job in two parts",
        };
        Misread::new(0..text.len(), format!("the formula has {error}"), help)
    })
}
