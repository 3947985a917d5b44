//! A formula as a short program in reverse Polish order: what machine code carries of an expression.
//!
//! Variables are numbered: 0 is x (or t), 1 is y.

use serde::{Deserialize, Serialize};

use crate::number::{Function, Number};

/// One step of a formula.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
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
    /// Raises it to a whole power.
    Powi(i32),
    /// Applies a function to it.
    Apply(Function),
}

/// Why operations are no formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FormulaError {
    /// More operations than [`Formula::OPS`].
    TooLong,
    /// More than [`Formula::DEPTH`] values at once.
    TooDeep,
    /// An operation lacks its arguments, or more than one value is left.
    Incomplete,
    /// A constant that is not finite, or a variable beyond the second.
    OutOfRange,
}

/// A formula of at most two variables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Formula {
    ops: [Op; Formula::OPS],
    len: usize,
}

impl Default for Formula {
    /// The constant 0.
    fn default() -> Formula {
        Formula { ops: [Op::Constant(0.0); Formula::OPS], len: 1 }
    }
}

impl Formula {
    /// Most operations.
    pub const OPS: usize = 96;
    /// Most values at once.
    pub const DEPTH: usize = 16;

    /// A formula of operations that leave exactly one value.
    ///
    /// # Errors
    /// [`FormulaError`].
    pub fn new(ops: &[Op]) -> Result<Formula, FormulaError> {
        let mut formula = Formula::default();
        let room = formula.ops.get_mut(..ops.len()).ok_or(FormulaError::TooLong)?;
        room.copy_from_slice(ops);
        formula.len = ops.len();
        let mut depth = 0_usize;
        for op in ops {
            let (takes, good) = match *op {
                Op::Constant(value) => (0, value.is_finite()),
                Op::Variable(index) => (0, index < 2),
                Op::Neg | Op::Powi(_) | Op::Apply(_) => (1, true),
                Op::Add | Op::Sub | Op::Mul | Op::Div => (2, true),
            };
            if !good {
                return Err(FormulaError::OutOfRange);
            }
            depth = depth.checked_sub(takes).ok_or(FormulaError::Incomplete)? + 1;
            if depth > Formula::DEPTH {
                return Err(FormulaError::TooDeep);
            }
        }
        if depth == 1 { Ok(formula) } else { Err(FormulaError::Incomplete) }
    }

    /// The operations.
    #[must_use]
    pub fn ops(&self) -> &[Op] {
        &self.ops[..self.len]
    }

    /// The value; not finite outside the domain of its functions.
    #[must_use]
    pub fn eval<T: Number>(&self, variables: [T; 2]) -> T {
        let mut stack = [T::constant(0.0); Formula::DEPTH];
        let mut top = 0;
        for op in self.ops() {
            // `new` has counted: there are always as many values as an operation takes, and room for what it leaves.
            match *op {
                Op::Constant(value) => {
                    stack[top] = T::constant(value);
                    top += 1;
                }
                Op::Variable(index) => {
                    stack[top] = variables[usize::from(index)];
                    top += 1;
                }
                Op::Neg => stack[top - 1] = -stack[top - 1],
                Op::Powi(exponent) => stack[top - 1] = stack[top - 1].powi(exponent),
                Op::Apply(function) => stack[top - 1] = stack[top - 1].apply(function),
                Op::Add | Op::Sub | Op::Mul | Op::Div => {
                    let (a, b) = (stack[top - 2], stack[top - 1]);
                    top -= 1;
                    stack[top - 1] = match op {
                        Op::Add => a + b,
                        Op::Sub => a - b,
                        Op::Mul => a * b,
                        _ => a / b,
                    };
                }
            }
        }
        stack[0]
    }
}
