//! Lines as code, for loops and subroutines, which read the same lines again and again.
//!
//! In: what the reader does while it reads a line. Out: the same done again, without the text. Values have no
//! branches: each number goes on a stack, each operator takes its operands off and puts its result back, each
//! word takes its value off. So one list of operations serves every turn, at a fraction of the cost of
//! reading.
//!
//! There are no errors here. What cannot be noted, or fails when it is done again (a division by zero, a name
//! that is not set), is left to the reader, which says what is wrong and where. So nothing but the reader
//! knows the language.

use super::expression::{numbered, parameter_number, readable};
use super::line::{Assignment, Target, add_g, add_m};
use super::operator;
use super::told;
use crate::block::Block;
use crate::problem::Span;
use crate::state::State;
use crate::state::memory::Name;
use crate::text::Operator;
use crate::text::degrees;

/// Lines with more operations are read every time, so that what is remembered stays small.
const LONGEST: usize = 256;

/// What is done with the stack.
#[derive(Clone, Copy)]
pub(crate) enum Operation {
    /// Puts a value on it.
    Value(f64),
    /// Puts a parameter on it; `Indirect` takes its number off.
    Numbered(u32),
    Indirect,
    Named(Name),
    /// Changes the sign.
    Negate,
    Operator(Operator),
    Function(fn(f64) -> f64),
    ArcTangent,
    /// Takes a value off: a word of the block.
    Word(u8, Span),
    G(Span),
    M(Span),
    /// Takes a value off for a parameter; `SetNumbered` also the number of the parameter.
    SetNumbered,
    SetNamed(Name),
}

/// The operations of the line that is being read.
#[derive(Default)]
pub(crate) struct Notes {
    operations: Vec<Operation>,
    on: bool,
}

impl Notes {
    /// Begins a line; it is noted if it is `on`.
    #[inline]
    pub(crate) fn begin(&mut self, on: bool) {
        self.on = on;
        self.operations.clear();
    }

    #[inline]
    pub(super) fn note(&mut self, operation: Operation) {
        if self.on {
            self.push(operation);
        }
    }

    fn push(&mut self, operation: Operation) {
        let constant = match (operation, self.operations.last_mut()) {
            (Operation::Indirect, Some(last)) => match *last {
                Operation::Value(value) => parameter_number(value).map(|index| (last, index)),
                _ => None,
            },
            _ => None,
        };
        match constant {
            Some((last, index)) => *last = Operation::Numbered(index),
            None => self.operations.push(operation),
        }
        self.on = self.operations.len() <= LONGEST;
    }

    /// The line does what no operation does.
    #[inline]
    pub(crate) fn spoil(&mut self) {
        self.on = false;
    }

    /// Forgets the label of an O word, which is noted elsewhere; one that is computed spoils the line.
    pub(crate) fn forget_label(&mut self) {
        self.on &= matches!(self.operations.as_slice(), [] | [Operation::Value(_)]);
        self.operations.clear();
    }

    /// Ends the line; its operations, if it can be done again.
    pub(crate) fn take(&mut self) -> Option<&[Operation]> {
        std::mem::replace(&mut self.on, false).then_some(self.operations.as_slice())
    }
}

/// Does operations: words go to `block`, parameters to set to `assignments`; the stack keeps values that
/// nothing took. `None`: the line has to be read.
pub(super) fn replay(
    operations: &[Operation],
    state: &State,
    block: &mut Block,
    stack: &mut Vec<f64>,
    assignments: &mut Vec<Assignment>,
) -> Option<()> {
    for operation in operations {
        match *operation {
            Operation::Value(value) => stack.push(value),
            Operation::Numbered(index) => stack.push(parameter(index, state)?),
            Operation::Indirect => {
                let index = stack.pop()?;
                stack.push(parameter(parameter_number(index)?, state)?);
            }
            Operation::Named(name) => stack.push(state.memory.at(name)?),
            Operation::Negate => {
                let value = stack.pop()?;
                stack.push(-value);
            }
            Operation::Operator(sign) => {
                let (right, left) = (stack.pop()?, stack.pop()?);
                stack.push(finite(operator::apply(sign, left, right).ok()?)?);
            }
            Operation::Function(function) => {
                let argument = stack.pop()?;
                stack.push(finite(function(argument))?);
            }
            Operation::ArcTangent => {
                let (x, y) = (stack.pop()?, stack.pop()?);
                stack.push(degrees::arc_tangent(y, x));
            }
            Operation::Word(letter, span) => block.add(char::from(letter), stack.pop()?, span).ok()?,
            Operation::G(span) => add_g(stack.pop()?, span, block).ok()?,
            Operation::M(span) => add_m(stack.pop()?, span, state, block).ok()?,
            Operation::SetNumbered => {
                let (value, index) = (stack.pop()?, parameter_number(stack.pop()?)?);
                if told::is_read_only(index, state) {
                    return None;
                }
                assignments.push((Target::Number(index), value));
            }
            Operation::SetNamed(name) => {
                // A global name that was never set may tell the state.
                state.memory.at(name).or((!name.is_global()).then_some(0.0))?;
                assignments.push((Target::Name(name), stack.pop()?));
            }
        }
    }
    Some(())
}

fn parameter(index: u32, state: &State) -> Option<f64> {
    readable(index, state).then(|| numbered(index, state))
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}
