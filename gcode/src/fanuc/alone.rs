//! One line, or one value, by itself.

use super::expression::Values;
use super::line::Line;
use super::reading::Reading;
use super::variables::Variables;
use crate::block::Block;
use crate::options::{Dialect, Options};
use crate::problem::Problem;
use crate::state::State;
use crate::text::{Cursor, Depth};

/// Reads one line at the start of a program, see [`crate::alone::line`].
///
/// # Errors
/// What is wrong with it.
pub(crate) fn line_alone(text: &[u8], state: &State, options: &Options) -> Result<Block, Box<Problem>> {
    let (mut line, mut variables) = (
        Line::new(options.decimal_point, options.dialect == Dialect::FanucMill),
        Variables::new(&options.parameters),
    );
    let (skips, deepest) = (options.skips, options.limits.expression_depth);
    let mut reading = Reading { text, variables: &mut variables, state, skips, deepest };
    reading.statement(0, 1, &mut line)?;
    Ok(line.block)
}

/// Computes one value, see [`crate::alone::value`].
///
/// # Errors
/// It is missing, or cannot be computed.
pub(crate) fn value_alone(
    cursor: &mut Cursor,
    state: &State,
    options: &Options,
) -> Result<Option<f64>, Box<Problem>> {
    let variables = Variables::new(&options.parameters);
    let deepest = options.limits.expression_depth;
    Values { variables: &variables, state, depth: Depth::new(deepest) }.value(cursor)
}
