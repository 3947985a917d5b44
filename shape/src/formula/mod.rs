//! A formula as a short program in reverse Polish order: what machine code carries of an expression.
//!
//! Variables are numbered: 0 is x (or t), 1 is y. In memory, on the wire and in files an operation is one
//! byte, and a constant eight bytes more:
//!
//! | byte | operation |
//! |---|---|
//! | 0 | none: the program is over |
//! | 1 | the next constant |
//! | 2, 3 | variable 0, 1 |
//! | 4 … 8 | sum, difference, product, quotient, change of sign |
//! | 16 … 27 | functions, in the order of [`Function::ALL`] |
//! | 128 … 255 | power with the exponent −64 … 63 |

mod stored;

use serde::{Deserialize, Serialize};

use crate::number::{Function, Number};

const VARIABLE: u8 = 2;
const FUNCTION: u8 = 16;
const POWER: u8 = 128;
/// Exponent 0.
const POWER_0: i32 = 192;

/// One step of a formula.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Op {
    /// Pushes a number.
    Constant(f64),
    /// Pushes a variable.
    Variable(u8),
    /// Replaces the two topmost by their sum,
    Add,
    /// difference,
    Sub,
    /// product,
    Mul,
    /// quotient.
    Div,
    /// Changes the sign of the topmost.
    Neg,
    /// Raises it to a whole power, [`Formula::EXPONENTS`].
    Powi(i32),
    /// Applies a function to it.
    Apply(Function),
}

/// Why operations are no formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FormulaError {
    /// More operations than [`Formula::OPS`], or more constants than [`Formula::CONSTANTS`].
    TooLong,
    /// More than [`Formula::DEPTH`] values at once.
    TooDeep,
    /// An operation lacks its arguments, or more than one value is left.
    Incomplete,
    /// A constant that is not finite, a variable beyond the second, an exponent beyond its range, or a byte
    /// that is no operation.
    OutOfRange,
}

impl core::fmt::Display for FormulaError {
    fn fmt(&self, out: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            FormulaError::TooLong => {
                write!(out, "more than {} operations or {} constants", Formula::OPS, Formula::CONSTANTS)
            }
            FormulaError::TooDeep => write!(out, "more than {} values at once", Formula::DEPTH),
            FormulaError::Incomplete => out.write_str("operations and values do not fit together"),
            FormulaError::OutOfRange => {
                out.write_str("a constant, variable, exponent or operation out of range")
            }
        }
    }
}

/// A formula of at most two variables. There is none that cannot be evaluated.
///
/// ```
/// use shape::{Formula, Op, Series};
/// let square = Formula::new(&[Op::Variable(0), Op::Powi(2)]).expect("it is complete");
/// assert_eq!(square.eval([3.0, 0.0]), 9.0);
/// assert_eq!(square.eval([Series::variable(3.0); 2]).0, [9.0, 6.0, 1.0, 0.0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "stored::Stored", into = "stored::Stored")]
pub struct Formula {
    codes: [u8; Formula::OPS],
    constants: [f64; Formula::CONSTANTS],
}

impl Default for Formula {
    /// The constant 0.
    fn default() -> Formula {
        let mut formula = Formula::EMPTY;
        formula.codes[0] = 1;
        formula
    }
}

impl Formula {
    /// Most operations.
    pub const OPS: usize = 96;
    /// Most constants among them.
    pub const CONSTANTS: usize = 32;
    /// Most values at once.
    pub const DEPTH: usize = 16;
    /// Exponents of [`Op::Powi`].
    pub const EXPONENTS: core::ops::RangeInclusive<i32> = -64..=63;

    const EMPTY: Formula = Formula { codes: [0; Formula::OPS], constants: [0.0; Formula::CONSTANTS] };

    /// A formula of operations that leave exactly one value.
    ///
    /// # Errors
    /// [`FormulaError`].
    pub fn new(ops: &[Op]) -> Result<Formula, FormulaError> {
        let mut formula = Formula::EMPTY;
        let (mut constants, mut depth) = (0, 0_usize);
        for (index, op) in ops.iter().enumerate() {
            let code = formula.codes.get_mut(index).ok_or(FormulaError::TooLong)?;
            *code = code_of(op).ok_or(FormulaError::OutOfRange)?;
            if let Op::Constant(value) = *op {
                *formula.constants.get_mut(constants).ok_or(FormulaError::TooLong)? = value;
                constants += 1;
            }
            depth = depth.checked_sub(arguments(op)).ok_or(FormulaError::Incomplete)? + 1;
            if depth > Formula::DEPTH {
                return Err(FormulaError::TooDeep);
            }
        }
        if depth == 1 { Ok(formula) } else { Err(FormulaError::Incomplete) }
    }

    /// The formula as bytes and constants; behind them, zeros.
    #[must_use]
    pub fn encode(&self) -> ([u8; Formula::OPS], [f64; Formula::CONSTANTS]) {
        (self.codes, self.constants)
    }

    /// The formula that [`Formula::encode`] makes these of.
    ///
    /// # Errors
    /// [`FormulaError`], also if something stands behind the end.
    pub fn decode(codes: &[u8], constants: &[f64]) -> Result<Formula, FormulaError> {
        let end = codes.iter().position(|code| *code == 0).unwrap_or(codes.len());
        let (program, rest) = codes.split_at(end);
        let mut constants = constants.iter().copied();
        let mut ops = [Op::Add; Formula::OPS];
        let room = ops.get_mut(..end).ok_or(FormulaError::TooLong)?;
        for (op, code) in room.iter_mut().zip(program) {
            *op = op_of(*code, &mut constants).ok_or(FormulaError::OutOfRange)?;
        }
        let clean = rest.iter().all(|code| *code == 0) && constants.all(|value| value.to_bits() == 0);
        if clean { Formula::new(room) } else { Err(FormulaError::Incomplete) }
    }

    /// The operations.
    pub fn ops(&self) -> impl Iterator<Item = Op> {
        let mut constants = self.constants.iter().copied();
        self.codes.iter().map_while(move |code| op_of(*code, &mut constants))
    }

    /// The value; not finite outside the domain of its functions.
    #[must_use]
    pub fn eval<T: Number>(&self, variables: [T; 2]) -> T {
        let mut stack = [T::constant(0.0); Formula::DEPTH];
        let mut top = 0;
        for op in self.ops() {
            // `new` has counted: there are always as many values as an operation takes, and room for what it
            // leaves.
            top = top + 1 - arguments(&op);
            let last = top - 1;
            match op {
                Op::Constant(value) => stack[last] = T::constant(value),
                Op::Variable(index) => stack[last] = variables[usize::from(index)],
                Op::Neg => stack[last] = -stack[last],
                Op::Powi(exponent) => stack[last] = stack[last].powi(exponent),
                Op::Apply(function) => stack[last] = stack[last].apply(function),
                Op::Add => stack[last] = stack[last] + stack[top],
                Op::Sub => stack[last] = stack[last] - stack[top],
                Op::Mul => stack[last] = stack[last] * stack[top],
                Op::Div => stack[last] = stack[last] / stack[top],
            }
        }
        stack[0]
    }
}

/// How many values an operation takes.
fn arguments(op: &Op) -> usize {
    match op {
        Op::Constant(_) | Op::Variable(_) => 0,
        Op::Neg | Op::Powi(_) | Op::Apply(_) => 1,
        Op::Add | Op::Sub | Op::Mul | Op::Div => 2,
    }
}

/// The byte of an operation; `None` if it is out of range.
fn code_of(op: &Op) -> Option<u8> {
    match *op {
        Op::Constant(value) => value.is_finite().then_some(1),
        Op::Variable(index) => (index < 2).then(|| VARIABLE + index),
        Op::Add => Some(4),
        Op::Sub => Some(5),
        Op::Mul => Some(6),
        Op::Div => Some(7),
        Op::Neg => Some(8),
        Op::Powi(exponent) if Formula::EXPONENTS.contains(&exponent) => u8::try_from(POWER_0 + exponent).ok(),
        Op::Powi(_) => None,
        Op::Apply(function) => {
            let place = Function::ALL.iter().position(|one| *one == function)?;
            Some(FUNCTION + u8::try_from(place).ok()?)
        }
    }
}

/// The operation of a byte; `None` if there is none, or no constant for it.
fn op_of(code: u8, constants: &mut impl Iterator<Item = f64>) -> Option<Op> {
    match code {
        1 => constants.next().map(Op::Constant),
        2 | 3 => Some(Op::Variable(code - VARIABLE)),
        4 => Some(Op::Add),
        5 => Some(Op::Sub),
        6 => Some(Op::Mul),
        7 => Some(Op::Div),
        8 => Some(Op::Neg),
        POWER.. => Some(Op::Powi(i32::from(code) - POWER_0)),
        _ => Function::ALL.get(usize::from(code.checked_sub(FUNCTION)?)).copied().map(Op::Apply),
    }
}
