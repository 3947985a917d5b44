//! One way in which a row of the table of faults comes about: what happens at seeded places of a program,
//! when that is there to be seen, and who reacts. Out: the slowest reaction.

use machine::Machine;
use protocol::{Fault, Span, Within};
use testing::Seed;

use super::course::{Course, Job, Moment, Stage};
use crate::stand::compiled;

/// In how many places a case is brought about.
pub(super) const PLACES: usize = 24;
/// No reaction takes longer, control cycles: half a minute, and some turns of a slow spindle.
const PATIENCE: u64 = 80_000;

/// From the course of a run, that of the same run without the event, and the cycle of the event: the first
/// cycle in which it is there to be seen.
type Seen = Box<dyn Fn(&Course, &Course, usize) -> Option<usize> + Send + Sync>;
/// From a cycle of the run, and the same cycle without the event: whether who must react does.
type Reacts = Box<dyn Fn(&Moment, &Moment) -> bool + Send + Sync>;
/// What happens in a cycle, as in a scenario file.
type Happens = Box<dyn Fn(&mut Seed, u64) -> String + Send + Sync>;

/// A case.
pub(super) struct Case {
    pub(super) fault: Fault,
    /// Which of the bounds of its row.
    pub(super) bound: usize,
    program: String,
    machine: Machine,
    stages: &'static [Stage],
    /// The stage goes on for so many cycles behind a place; no place lies behind this cycle.
    lasts: usize,
    until: u64,
    /// Z speaks another version of the protocol.
    stranger: bool,
    happens: Happens,
    seen: Seen,
    reacts: Reacts,
}

impl Case {
    /// In these stages of a program on the small lathe: something happens.
    pub(super) fn new(
        (fault, bound): (Fault, usize),
        program: &str,
        stages: &'static [Stage],
        happens: impl Fn(&mut Seed, u64) -> String + Send + Sync + 'static,
    ) -> Case {
        Case {
            fault,
            bound,
            program: program.to_owned(),
            machine: Machine::plain(),
            stages,
            lasts: 0,
            until: u64::MAX,
            stranger: false,
            happens: Box::new(happens),
            seen: Box::new(|_, _, at| Some(at)),
            reacts: Box::new(move |now, _| now.all_tell(fault)),
        }
    }

    /// On a machine that is otherwise.
    pub(super) fn on(mut self, change: impl Fn(&mut Machine)) -> Case {
        change(&mut self.machine);
        self
    }

    pub(super) fn lasting(self, lasts: usize) -> Case {
        Case { lasts, ..self }
    }

    pub(super) fn before(self, until: u64) -> Case {
        Case { until, ..self }
    }

    pub(super) fn by_a_stranger(self) -> Case {
        Case { stranger: true, ..self }
    }

    /// When it is there to be seen, unless in the cycle of the event.
    pub(super) fn seen(
        self,
        seen: impl Fn(&Course, &Course, usize) -> Option<usize> + Send + Sync + 'static,
    ) -> Case {
        Case { seen: Box::new(seen), ..self }
    }

    /// Who reacts, unless every axis has to.
    pub(super) fn reacts(self, reacts: impl Fn(&Moment, &Moment) -> bool + Send + Sync + 'static) -> Case {
        Case { reacts: Box::new(reacts), ..self }
    }

    /// An axis has to tell the fault.
    pub(super) fn told_by(self, axis: usize) -> Case {
        let fault = self.fault;
        self.reacts(move |now, _| now.tells(axis, fault))
    }

    /// The interpolator has to tell it.
    pub(super) fn told_above(self) -> Case {
        let fault = self.fault;
        self.reacts(move |now, _| now.machine_tells(fault))
    }

    /// What its row promises.
    fn promise(&self) -> &'static [Span] {
        match &self.fault.row().within[self.bound] {
            Within::Most { sum, .. } => sum,
            Within::Before(_) => panic!("{:?} happens before anything moves", self.fault),
        }
    }

    /// Brings it about in every place; the slowest reaction.
    ///
    /// # Errors
    /// Where nobody reacts, before it is there to be seen, or later than the row says.
    pub(super) fn slowest(&self) -> Result<Span, String> {
        let items = compiled(&self.machine, &format!("G18 G21 G90 G8 G94 G97\n{}", self.program));
        let job = |scenario: &str, stranger, cycles, enough: &dyn Fn(&Moment) -> bool| {
            Job { machine: &self.machine, items: &items, scenario, stranger }.run(cycles, enough)
        };
        let twin = job("", None, PATIENCE, &|_| false);
        let mut slowest = zero(self.promise()[0]);
        for (place, (stage, at)) in self.places(&twin).into_iter().enumerate() {
            let mut seed = Seed::of_case(place as u64);
            let scenario = (self.happens)(&mut seed, at);
            let quiet = |now: &Moment| &twin[(now.measurement.cycle.0 as usize).min(twin.len() - 1)];
            let enough = |now: &Moment| now.measurement.cycle.0 >= at && (self.reacts)(now, quiet(now));
            let course = job(&scenario, self.stranger.then_some(at), at + PATIENCE, &enough);
            let what = format!("{:?}, {stage:?} in cycle {at}:\n{scenario}", self.fault);
            let last = course.last().expect("a run has a cycle");
            let told = |code| Fault::from_code(code).map(Fault::code);
            let heard = (last.axes.map(|axis| told(axis.fault)), told(last.machine.fault));
            if !enough(last) {
                return Err(format!("{what}: nobody reacts; {heard:?} in cycle {}", course.len() - 1));
            }
            let Some(seen) = (self.seen)(&course, &twin, at as usize).filter(|seen| *seen < course.len())
            else {
                return Err(format!("{what}: nothing is to be seen, and {heard:?}"));
            };
            let measured = self.measured(&course, seen);
            // The speed commanded before the fault was told.
            let most = self.most(course[course.len() - 2].machine.spindle_rpm);
            if number(measured) > most + 1e-9 {
                return Err(format!("{what}: {measured}, {heard:?}"));
            }
            slowest = if number(measured) > number(slowest) { measured } else { slowest };
        }
        Ok(slowest)
    }

    /// Places of the undisturbed run, as many of every stage.
    fn places(&self, twin: &Course) -> Vec<(Stage, u64)> {
        let cycles = self.stages.iter().map(|stage| {
            let all = stage.cycles(twin);
            let lasts = |n: usize| all.get(n + self.lasts) == Some(&(all[n] + self.lasts as u64));
            let place = |n: usize| (all[n] < self.until && lasts(n)).then_some(all[n]);
            (*stage, (0..all.len()).filter_map(place).collect::<Vec<u64>>())
        });
        let cycles: Vec<(Stage, Vec<u64>)> = cycles.collect();
        let mut seed = Seed::of_case(u64::from(self.fault as u32));
        let mut place = |number: usize| {
            let (stage, all) = &cycles[number % cycles.len()];
            assert!(!all.is_empty(), "{:?}: {} has no {stage:?}", self.fault, self.program);
            (*stage, all[seed.below(all.len())])
        };
        (0..PLACES).map(&mut place).collect()
    }

    /// From the cycle in which it is to be seen to the last one, in the first unit of what is promised.
    fn measured(&self, course: &Course, seen: usize) -> Span {
        let end = course.len() - 1;
        let tick = self.machine.cycles_per_tick() as usize;
        match self.promise()[0] {
            Span::Cycles(_) => Span::Cycles((end - seen + 1) as u64),
            Span::Ticks(_) => Span::Ticks((end / tick + 1 - seen.div_ceil(tick)) as u64),
            Span::Seconds(_) => Span::Seconds((end - seen) as f64 * self.machine.general.cycle_s),
            Span::Turns(_) => Span::Turns((course[end].deg - course[seen].deg).abs() / 360.0),
        }
    }

    /// What is promised, in its first unit; turns at a speed, 1/min.
    fn most(&self, rpm: f64) -> f64 {
        let general = &self.machine.general;
        let seconds = |span: &Span| match *span {
            Span::Cycles(n) => n as f64 * general.cycle_s,
            Span::Ticks(n) => n as f64 * general.interpolator_cycle_s,
            Span::Seconds(s) => s,
            Span::Turns(turns) => turns * 60.0 / rpm.abs(),
        };
        let [first, others @ ..] = self.promise() else { return 0.0 };
        let others: f64 = others.iter().map(seconds).sum();
        number(*first) * if others == 0.0 { 1.0 } else { 1.0 + others / seconds(first) }
    }
}

/// Nothing, in the unit of a span.
fn zero(span: Span) -> Span {
    match span {
        Span::Cycles(_) => Span::Cycles(0),
        Span::Ticks(_) => Span::Ticks(0),
        Span::Seconds(_) => Span::Seconds(0.0),
        Span::Turns(_) => Span::Turns(0.0),
    }
}

/// A span in its unit.
pub(super) fn number(span: Span) -> f64 {
    match span {
        Span::Cycles(n) | Span::Ticks(n) => n as f64,
        Span::Seconds(number) | Span::Turns(number) => number,
    }
}
