//! What a line does to the receiver of its calls: whether it moved, and which call was refused.

use crate::canon::{Call, Job, Place, Pose, Sink};
use crate::files::ToolTable;
use crate::problem::Problem;

/// The receiver of the calls, watched.
pub(crate) struct Watch<'a> {
    sink: &'a mut dyn Sink,
    /// A move was among the calls.
    pub(crate) moved: bool,
    /// Where the call that was refused comes from.
    pub(crate) refused: Option<Place>,
}

impl<'a> Watch<'a> {
    pub(crate) fn new(sink: &'a mut dyn Sink) -> Watch<'a> {
        Watch { sink, moved: false, refused: None }
    }
}

impl Sink for Watch<'_> {
    fn call(&mut self, place: Place, call: Call<'_>) -> Result<(), Box<Problem>> {
        self.moved |= matches!(
            call,
            Call::StraightTraverse(_)
                | Call::StraightFeed(_)
                | Call::ArcFeed(_)
                | Call::StraightProbe(..)
                | Call::RigidTap(..)
                | Call::ThreadCycle(_)
        );
        let done = self.sink.call(place, call);
        if done.is_err() {
            self.refused = Some(place);
        }
        done
    }

    fn job(&mut self, place: Place, job: &Job, tools: &ToolTable) -> Result<Option<Pose>, Box<Problem>> {
        self.moved = true;
        self.sink.job(place, job, tools).inspect_err(|_| self.refused = Some(place))
    }
}
