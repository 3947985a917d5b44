//! Values: numbers, parameters, functions, expressions in brackets. In: a cursor and the state of the
//! program. Out: an f64, always finite; angles in degrees.
//!
//! Operators of one rank go from left to right, also `**` and comparisons. Highest first: `**` · `*` `/`
//! `MOD` · `+` `-` · `EQ` `NE` `GT` `GE` `LT` `LE` · `AND` `OR` `XOR`. A sign belongs to the value after it,
//! so that `-2**2` is 4.

use super::notes::{Notes, Operation};
use super::operator;
use super::told;
use crate::problem::{Problem, Span, short};
use crate::state::State;
use crate::state::memory::LAST;
use crate::text::{Cursor, Depth, Operator, degrees, number, whole};

type Value = Result<f64, Box<Problem>>;

/// Reads the values of one line.
pub(crate) struct Values<'a> {
    pub(crate) state: &'a State,
    pub(crate) depth: Depth,
    /// The name of a parameter is put together here.
    pub(crate) name: &'a mut String,
    /// Notes what is done.
    pub(super) notes: &'a mut Notes,
}

impl Values<'_> {
    /// Reads one value.
    ///
    /// # Errors
    /// It is missing, or cannot be computed.
    #[inline]
    pub(crate) fn value(&mut self, cursor: &mut Cursor) -> Value {
        match cursor.peek() {
            Some(b'0'..=b'9' | b'.') => self.number(false, cursor),
            Some(b'-') => {
                cursor.skip();
                match cursor.peek() {
                    Some(b'0'..=b'9' | b'.') => self.number(true, cursor),
                    _ => {
                        let value = self.nested(cursor, Values::value)?;
                        self.notes.note(Operation::Negate);
                        Ok(-value)
                    }
                }
            }
            Some(first) => self.other_value(first, cursor),
            None => Err(missing_value(cursor)),
        }
    }

    #[inline]
    fn number(&mut self, negative: bool, cursor: &mut Cursor) -> Value {
        let value = number(cursor)?;
        let value = if negative { -value } else { value };
        self.notes.note(Operation::Value(value));
        Ok(value)
    }

    fn other_value(&mut self, first: u8, cursor: &mut Cursor) -> Value {
        match first {
            b'[' => self.bracket(cursor),
            b'#' => {
                let start = cursor.mark();
                cursor.skip();
                self.parameter(start, cursor)
            }
            b'+' => {
                cursor.skip();
                self.nested(cursor, Values::value)
            }
            b'a'..=b'z' => self.function(cursor),
            _ => Err(missing_value(cursor)),
        }
    }

    /// Reads `what` one level deeper.
    fn nested(&mut self, cursor: &mut Cursor, what: fn(&mut Self, &mut Cursor) -> Value) -> Value {
        self.depth.enter(cursor, "parameter")?;
        let value = what(self, cursor);
        self.depth.leave();
        value
    }

    /// The value of a parameter, its `#` taken already.
    fn parameter(&mut self, start: u32, cursor: &mut Cursor) -> Value {
        if cursor.peek() == Some(b'<') {
            self.read_name(start, cursor)?;
            match self.state.memory.find(self.name) {
                Some(name) => self.notes.note(Operation::Named(name)),
                None => self.notes.spoil(),
            }
            return self.named().ok_or_else(|| self.never_set(cursor.span(start)));
        }
        let index = self.index(start, cursor)?;
        self.notes.note(Operation::Indirect);
        if !readable(index, self.state) {
            let code = self.state.compensation.code();
            let message = format!("#{index} does not tell a position of the contour while {code} is on");
            return Err(cursor.error_from(start, "compensation-on", message, "end it with G40 first"));
        }
        Ok(numbered(index, self.state))
    }

    /// The number of a parameter, its `#` taken already.
    ///
    /// # Errors
    /// There is no parameter of this number.
    pub(crate) fn index(&mut self, start: u32, cursor: &mut Cursor) -> Result<u32, Box<Problem>> {
        let index = match cursor.peek() {
            Some(b'0'..=b'9') => self.number(false, cursor)?,
            _ => self.nested(cursor, Values::value)?,
        };
        parameter_number(index).ok_or_else(|| {
            let message = format!("there is no parameter number {}", short(index));
            let help = format!("use a whole number from 1 to {LAST}");
            cursor.error_from(start, "bad-parameter", message, help)
        })
    }

    /// Reads `<name>` into `name`: lower case, without blanks.
    ///
    /// # Errors
    /// The name is empty or not closed.
    pub(crate) fn read_name(&mut self, start: u32, cursor: &mut Cursor) -> Result<(), Box<Problem>> {
        read_name(self.name, start, cursor)
    }

    /// The value of the parameter whose name was read.
    fn named(&self) -> Option<f64> {
        named(self.name, self.state)
    }

    #[cold]
    fn never_set(&self, span: Span) -> Box<Problem> {
        let message = format!("the parameter #<{}> was never set", self.name);
        let help = match self.name.starts_with('_') {
            true => "set it on an earlier line, or check how it is spelled",
            false => {
                "set it on an earlier line in the same subroutine (names that begin with _ belong to the program)"
            }
        };
        Problem::error("unknown-name", crate::problem::Blame::Span(span), message, help)
    }

    /// `[ a op b op c ]`.
    ///
    /// # Errors
    /// A bracket or an operator is missing, or the value cannot be computed.
    pub(crate) fn bracket(&mut self, cursor: &mut Cursor) -> Value {
        let start = cursor.mark();
        if !cursor.take_if(b'[') {
            let help = "put the argument in brackets, as in SQRT[2] or ATAN[1]/[2]";
            return Err(cursor.error_here("missing-bracket", "an opening bracket is missing here", help));
        }
        let value = self.nested(cursor, |values, cursor| values.chain(0, cursor).map(|(value, _)| value))?;
        if cursor.take_if(b']') {
            return Ok(value);
        }
        if cursor.peek().is_none() {
            let help = "close every [ with a ]";
            return Err(cursor.error_from(start, "missing-bracket", "the closing bracket is missing", help));
        }
        let help = "operators: + - * / ** MOD EQ NE GT GE LT LE AND OR XOR";
        Err(cursor.error_here("unknown-operator", "an operator or ] was expected here", help))
    }

    /// A value and what operators of at least `rank` make of it; with the operator that comes after.
    fn chain(&mut self, rank: u8, cursor: &mut Cursor) -> Result<(f64, Option<Operator>), Box<Problem>> {
        let start = cursor.mark();
        let mut value = self.value(cursor)?;
        let mut next = operator::take(cursor);
        while let Some(sign) = next.filter(|next| operator::rank(*next) >= rank) {
            let (right, behind) = self.chain(operator::rank(sign) + 1, cursor)?;
            value =
                operator::apply(sign, value, right).map_err(|reason| arithmetic(cursor, start, reason))?;
            if !value.is_finite() {
                return Err(arithmetic(cursor, start, "the value is too large for a number"));
            }
            self.notes.note(Operation::Operator(sign));
            next = behind;
        }
        Ok((value, next))
    }

    fn function(&mut self, cursor: &mut Cursor) -> Value {
        let start = cursor.mark();
        let Some(function) = cursor.take_name(&FUNCTIONS) else { return Err(unknown_function(cursor)) };
        match function {
            Function::Atan => self.arc_tangent(cursor),
            Function::Exists => self.exists(cursor),
            Function::Real(name, function) => {
                let argument = self.bracket(cursor)?;
                let value = function(argument);
                if value.is_finite() {
                    self.notes.note(Operation::Function(function));
                    return Ok(value);
                }
                let reason = format!("{name} of {} has no value", short(argument));
                Err(arithmetic(cursor, start, &reason))
            }
        }
    }

    /// `ATAN[y]/[x]`, -180 to 180 degrees.
    fn arc_tangent(&mut self, cursor: &mut Cursor) -> Value {
        let y = self.bracket(cursor)?;
        if !cursor.take_if(b'/') {
            let help = "ATAN takes two arguments, as in ATAN[1]/[2]";
            return Err(cursor.error_here("missing-value", "the / of ATAN is missing here", help));
        }
        let x = self.bracket(cursor)?;
        self.notes.note(Operation::ArcTangent);
        Ok(degrees::arc_tangent(y, x))
    }

    /// `EXISTS[#<name>]`: 1 if the parameter is set, else 0. `EXISTS[#n]`: 1 if there is a parameter of this
    /// number.
    fn exists(&mut self, cursor: &mut Cursor) -> Value {
        let start = cursor.mark();
        if !cursor.take_if(b'[') || !cursor.take_if(b'#') {
            let help = "EXISTS takes a parameter, as in EXISTS[#<depth>]";
            return Err(cursor.error_here("missing-value", "a parameter is missing here", help));
        }
        let exists = if cursor.peek() == Some(b'<') {
            self.read_name(start, cursor)?;
            self.named().is_some()
        } else {
            let index = self.nested(cursor, Values::value)?;
            whole(index).is_some_and(|index| (1..=i64::from(LAST)).contains(&index))
        };
        self.notes.spoil();
        if !cursor.take_if(b']') {
            let help = "close every [ with a ]";
            return Err(cursor.error_here("missing-bracket", "the closing bracket is missing", help));
        }
        Ok(f64::from(exists))
    }
}

/// Whether `#index` has a value: the compensation hides where the contour is.
pub(super) fn readable(index: u32, state: &State) -> bool {
    !((5420..=5428).contains(&index) && state.compensation.is_on())
}

/// The number of a parameter, if there is one of this number.
#[inline]
pub(super) fn parameter_number(value: f64) -> Option<u32> {
    whole(value).filter(|number| (1..=i64::from(LAST)).contains(number)).map(|number| number as u32)
}

/// The value of `#index`.
pub(crate) fn numbered(index: u32, state: &State) -> f64 {
    let told = if index < 5000 { None } else { told::numbered(index, state) };
    told.unwrap_or_else(|| state.memory.numbered(index))
}

/// The value of `#<name>`: one that the program has set, or one that tells the state.
pub(crate) fn named(name: &str, state: &State) -> Option<f64> {
    let set = state.memory.named(name);
    if set.is_none() && name.starts_with('_') { told::named(name, state) } else { set }
}

/// Reads `<name>` into `name`: lower case, without blanks.
///
/// # Errors
/// The name is empty, not closed or no text.
pub(crate) fn read_name(name: &mut String, start: u32, cursor: &mut Cursor) -> Result<(), Box<Problem>> {
    name.clear();
    cursor.take_if(b'<');
    let Some(bytes) = cursor.take_until(b'>') else {
        cursor.take_rest();
        let help = "names stand in < >, as in #<depth>";
        return Err(cursor.error_from(
            start,
            "missing-bracket",
            "the closing > of the name is missing",
            help,
        ));
    };
    let blank = |byte: &u8| matches!(byte, b' ' | b'\t');
    if bytes.iter().any(|byte| !byte.is_ascii_graphic() && !blank(byte)) {
        let help = "names are made of letters, digits and signs such as _ and -";
        return Err(cursor.error_from(start, "bad-character", "this cannot be a name", help));
    }
    for byte in bytes.iter().filter(|byte| !blank(byte)) {
        name.push(char::from(byte.to_ascii_lowercase()));
    }
    if name.is_empty() {
        let help = "put letters between < and >, as in #<depth>";
        return Err(cursor.error_from(start, "missing-value", "the name is empty", help));
    }
    Ok(())
}

#[derive(Clone, Copy)]
enum Function {
    Real(&'static str, fn(f64) -> f64),
    Atan,
    Exists,
}

/// Those that are used most come first.
const FUNCTIONS: [(&str, Function); 14] = [
    ("sin", Function::Real("SIN", degrees::sine)),
    ("cos", Function::Real("COS", degrees::cosine)),
    ("sqrt", Function::Real("SQRT", f64::sqrt)),
    ("abs", Function::Real("ABS", f64::abs)),
    ("acos", Function::Real("ACOS", |x| degrees::from_radians(libm::acos(x)))),
    ("asin", Function::Real("ASIN", |x| degrees::from_radians(libm::asin(x)))),
    ("atan", Function::Atan),
    ("exists", Function::Exists),
    ("exp", Function::Real("EXP", libm::exp)),
    ("fix", Function::Real("FIX", f64::floor)),
    ("fup", Function::Real("FUP", f64::ceil)),
    ("ln", Function::Real("LN", libm::log)),
    ("round", Function::Real("ROUND", f64::round)),
    ("tan", Function::Real("TAN", degrees::tangent)),
];

#[cold]
fn unknown_function(cursor: &mut Cursor) -> Box<Problem> {
    let mut ahead = cursor.clone();
    let mut name = String::new();
    while let Some(letter @ b'a'..=b'z') = ahead.peek() {
        name.push(char::from(letter.to_ascii_uppercase()));
        ahead.skip();
    }
    if ahead.peek() != Some(b'[') {
        return missing_value(cursor);
    }
    let start = cursor.mark();
    let help = "functions: ABS ACOS ASIN ATAN[]/[] COS EXISTS EXP FIX FUP LN ROUND SIN SQRT TAN";
    ahead.error_from(start, "unknown-function", format!("there is no function {name}"), help)
}

#[cold]
fn missing_value(cursor: &mut Cursor) -> Box<Problem> {
    let help = "write a number, a parameter (#1), an expression ([...]) or a function (SQRT[...])";
    cursor.error_here("missing-value", "a value is missing here", help)
}

#[cold]
fn arithmetic(cursor: &Cursor, start: u32, reason: &str) -> Box<Problem> {
    cursor.error_from(start, "arithmetic", reason, "check the values the expression is given")
}
