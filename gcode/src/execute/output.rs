//! Where calls and warnings of a block go.

use super::compensation::Waiting;
use crate::canon::{Call, Job, Place, Pose, Sink};
use crate::files::ToolTable;
use crate::problem::Problem;

/// What executing functions return.
pub(crate) type Done = Result<(), Box<Problem>>;

/// The receiver of calls, the place they come from, the warnings of the block, and the calls that wait for
/// the next corner of a compensated contour.
pub(crate) struct Output<'a> {
    sink: &'a mut dyn Sink,
    /// Where the calls come from.
    pub(crate) place: Place,
    warnings: &'a mut Vec<Problem>,
    pub(super) waiting: &'a mut Waiting,
}

/// A receiver that is told what a refused block would have done.
struct Assuming<'a>(&'a mut dyn Sink);

impl Sink for Assuming<'_> {
    fn call(&mut self, place: Place, call: Call<'_>) -> Done {
        self.0.assumes(place, call);
        Ok(())
    }

    fn skips_to(&mut self, place: Place, to: &Pose) {
        self.0.skips_to(place, to);
    }
}

impl<'a> Output<'a> {
    /// Does something whose calls are only assumed, see [`Sink::assumes`], and whose warnings nobody hears.
    pub(crate) fn assume(&mut self, what: impl FnOnce(&mut Output<'_>)) {
        let (mut sink, mut warnings) = (Assuming(&mut *self.sink), Vec::new());
        what(&mut Output {
            sink: &mut sink,
            place: self.place,
            warnings: &mut warnings,
            waiting: &mut *self.waiting,
        });
    }

    pub(crate) fn new(
        sink: &'a mut dyn Sink,
        place: Place,
        warnings: &'a mut Vec<Problem>,
        waiting: &'a mut Waiting,
    ) -> Output<'a> {
        Output { sink, place, warnings, waiting }
    }

    /// Sends a call, or lets it wait after others.
    pub(crate) fn call(&mut self, call: Call<'_>) -> Done {
        if self.waiting.delays(&call) {
            self.waiting.push(self.place, call);
            return Ok(());
        }
        self.sink.call(self.place, call)
    }

    /// See [`Sink::skips_to`].
    pub(super) fn skips_to(&mut self, to: &Pose) {
        self.sink.skips_to(self.place, to);
    }

    /// Hands a job to the receiver; the answer is where the tool is after it, see [`Sink::job`].
    pub(crate) fn job(&mut self, job: &Job, tools: &ToolTable) -> Result<Option<Pose>, Box<Problem>> {
        self.sink.job(self.place, job, tools)
    }

    /// Sends all calls that wait. They keep the place of their blocks, but for N: that is what is read now.
    pub(crate) fn release(&mut self) -> Done {
        let Place { n, n_digits, .. } = self.place;
        for (place, call) in self.waiting.take().calls() {
            self.sink.call(Place { n, n_digits, ..place }, call)?;
        }
        Ok(())
    }

    /// Notes what is legal but probably wrong.
    #[allow(clippy::boxed_local)] // problems travel boxed
    pub(crate) fn warn(&mut self, problem: Box<Problem>) {
        self.warnings.push(*problem);
    }

    /// Notes what the reader of a line has warned of.
    #[inline]
    pub(crate) fn warn_all(&mut self, warnings: &mut Vec<Problem>) {
        if !warnings.is_empty() {
            self.warnings.append(warnings);
        }
    }
}
