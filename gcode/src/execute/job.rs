//! Jobs. In: a job, the state. Out: the job for the receiver of calls, and the programmed point after it.

use super::{Done, Output};
use crate::canon::Job;
use crate::problem::{Blame, Problem};
use crate::state::State;

/// Hands a job to the receiver, and takes over where the tool is then.
///
/// # Errors
/// A state in which there can be no job, or what the receiver refuses.
pub(crate) fn job(job: &Job, state: &mut State, out: &mut Output) -> Done {
    let refuse = |message: &str, help: &str| Err(Problem::error("job", Blame::Line(job.line), message, help));
    if state.compensation.is_on() {
        return refuse("a job while G41 or G42 is on", "switch it off with G40 first: a job names its tool");
    }
    if state.recorder.is_on() {
        return refuse("a job within a contour of G70, G71 or G72", "write it after the contour");
    }
    state.axes.position = out.job(job, &state.tools.table)?.unwrap_or(state.axes.position);
    state.axes.moved();
    Ok(())
}
