//! What lines do to the receiver of their calls: whether they lead anywhere, and which call was refused.

use crate::canon::{Call, Job, Place, Pose, Sink};
use crate::files::ToolTable;
use crate::problem::Problem;

/// A way that leads nowhere, program units or degrees: a loop may move to and fro by less for ever.
const NOWHERE: f64 = 0.1;

/// How long the program has stayed where it is.
#[derive(Debug, Default)]
pub(crate) struct Stay {
    /// Where it is.
    at: Option<Pose>,
    /// Lines since it came there.
    pub(crate) lines: u64,
    /// The first and the last of them in the text, of a file.
    of: Option<(u16, u32, u32)>,
}

impl Stay {
    /// Takes a line that was executed.
    pub(crate) fn line(&mut self, place: Place) {
        self.lines += 1;
        if self.lines.is_power_of_two() {
            // What led into the loop is none of its lines.
            self.of = None;
        }
        self.of = match self.of {
            Some((file, first, last)) if file == place.file => {
                Some((file, first.min(place.line), last.max(place.line)))
            }
            _ => Some((place.file, place.line, place.line)),
        };
    }

    /// The loop that the lines are, if they are of one file.
    pub(crate) fn between(&self) -> (u32, u32) {
        self.of.map_or((0, 0), |(_, first, last)| (first, last))
    }

    fn go(&mut self, to: &Pose) {
        let near = |at: &Pose| at.iter().zip(to).all(|(at, to)| (to - at).abs() < NOWHERE);
        if !self.at.as_ref().is_some_and(near) {
            *self = Stay { at: Some(*to), ..Stay::default() };
        }
    }

    fn leave(&mut self) {
        *self = Stay::default();
    }
}

/// The receiver of the calls, watched.
pub(crate) struct Watch<'a> {
    sink: &'a mut dyn Sink,
    pub(crate) stay: Stay,
    /// Where the call that was refused comes from.
    pub(crate) refused: Option<Place>,
}

impl<'a> Watch<'a> {
    pub(crate) fn new(sink: &'a mut dyn Sink, stay: Stay) -> Watch<'a> {
        Watch { sink, stay, refused: None }
    }
}

impl Sink for Watch<'_> {
    fn call(&mut self, place: Place, call: Call<'_>) -> Result<(), Box<Problem>> {
        match &call {
            Call::StraightTraverse(to) | Call::StraightFeed(to) | Call::StraightProbe(_, to) => {
                self.stay.go(to)
            }
            Call::ArcFeed(_) | Call::NurbsFeed(_) | Call::RigidTap(..) | Call::ThreadCycle(_) => {
                self.stay.leave()
            }
            _ => {}
        }
        let done = self.sink.call(place, call);
        if done.is_err() {
            self.refused = Some(place);
        }
        done
    }

    fn assumes(&mut self, place: Place, call: Call<'_>) {
        self.sink.assumes(place, call);
    }

    fn skips_to(&mut self, place: Place, to: &Pose) {
        self.stay.go(to);
        self.sink.skips_to(place, to);
    }

    fn job(&mut self, place: Place, job: &Job, tools: &ToolTable) -> Result<Option<Pose>, Box<Problem>> {
        self.stay.leave();
        self.sink.job(place, job, tools).inspect_err(|_| self.refused = Some(place))
    }
}
