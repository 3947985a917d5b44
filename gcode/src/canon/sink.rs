//! The receiver of calls.

use super::call::Call;
use super::job::Job;
use super::place::Place;
use super::pose::Pose;
use crate::files::ToolTable;
use crate::problem::Problem;

/// Where calls go.
pub trait Sink {
    /// Takes one call.
    ///
    /// # Errors
    /// What the receiver cannot do; the interpreter adds file, line and caret.
    fn call(&mut self, place: Place, call: Call<'_>) -> Result<(), Box<Problem>>;

    /// What a block that was refused would have done, as far as the blocks behind it count on it. Nothing of
    /// it is to be executed, and nothing that is wrong with it told.
    fn assumes(&mut self, _place: Place, _call: Call<'_>) {}

    /// After a block that was refused the program is taken to be at `to`, the end of the move that it was to
    /// make, in the units and coordinates in force. Nothing moves there.
    fn skips_to(&mut self, _place: Place, _to: &Pose) {}

    /// Takes a job: work described by a formula, in the coordinates in force; `tools` are for those who know
    /// what it needs. The answer is where the tool is after it, in the units and coordinates in force;
    /// `None`: the programmed point stays what it was. A receiver that knows no jobs gets a comment for each
    /// line.
    ///
    /// # Errors
    /// As for [`Sink::call`].
    fn job(&mut self, place: Place, job: &Job, _tools: &ToolTable) -> Result<Option<Pose>, Box<Problem>> {
        job.comments(|line, text| self.call(Place { line, ..place }, Call::Comment(text)))?;
        Ok(None)
    }
}
