//! The part that a mill leaves, as heights over X and Y: stock less what the tools swept. In: rows of the
//! trace, mm. Out: a picture that can be turned.
//!
//! | module | in | out |
//! |---|---|---|
//! | [`job`] | a job file | its tool |
//! | [`way`] | rows | the true way of the tools, thinned |
//! | [`heights`] | the way, tools, the stock | heights, the tool that cut them, the deviation there |
//! | [`solid`] | heights | what the page holds |

mod heights;
mod job;
mod solid;
#[cfg(test)]
mod tests;
mod way;

use maud::Markup;
use rig::observe::Summary;

pub(super) use way::Way;

/// The part as a picture, if anything was cut.
pub(super) fn part(summary: &Summary, way: &Way, program: Option<&str>) -> Option<Markup> {
    let heights = heights::Heights::of(summary, way, program.and_then(job::tool))?;
    Some(solid::markup(&heights))
}
