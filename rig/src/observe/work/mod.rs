//! Measures the traces of a program: contours, surfaces, seams. In: their formulas, and one [`Record`] each
//! control cycle. Out: for every one that was cut, how far the commanded and the true tool or beam were from
//! it, and its feed.
//!
//! The interpolator says of every setpoint which trace it cuts, so approaches and retracts are known as what
//! they are. A setpoint is due [`SETPOINT_LEAD`] ticks after the one that made it; a control cycle is cut if
//! the setpoints before and after it are. Pieces of one seam, as of one through points, are traces of the
//! same line that go over into each other: they get one report.

mod gauge;
mod outline;
mod pace;
mod report;
mod seam;
mod surface;

use std::{collections::VecDeque, sync::Arc};

use machine::Machine;
use protocol::{Axis, Code, FORMULAS, Item, PerAxis, Position, Shape, Work, frame::SETPOINT_LEAD};
use shape::{Correction, Formula};

use self::gauge::{Gauge, Seen};
use super::{Record, limits::Shares};
use pace::{Pace, distance};
pub use report::{AxisUsed, DeviationReport, FeedReport, TraceReport, WorkKind};

/// Reports that are kept: those of the largest deviation. Every trace is measured.
const MOST: usize = 200;

/// A trace of the program, with the formulas that hold where it stands.
#[derive(Clone, Debug)]
struct Planned {
    line: u32,
    trace: Work,
    formulas: Arc<[Formula; FORMULAS]>,
}

/// Watches for traces.
#[derive(Clone, Debug)]
pub(super) struct Works {
    machine: Machine,
    planned: Vec<Planned>,
    /// When setpoints are due, and which traces they cut.
    nodes: VecDeque<(u64, u32)>,
    cut: Option<Box<Cut>>,
    reports: Vec<TraceReport>,
    left_out: u64,
    now: Traced,
}

/// What was measured in one control cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Traced {
    /// Number of the trace; 0 if none is cut.
    pub trace: u32,
    /// By commanded positions.
    pub commanded: TracedPoint,
    /// By true positions of the slides.
    pub slide: TracedPoint,
}

/// A tool or a beam in one control cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TracedPoint {
    /// Deviation, mm.
    pub deviation_mm: f64,
    /// Angle between the direction of a seam and the beam, degrees.
    pub angle_deg: f64,
    /// Feed along its path, mm/min.
    pub feed_mm_min: f64,
}

impl Works {
    /// The traces of a program.
    pub(super) fn of(machine: &Machine, items: &[Item]) -> Works {
        let mut formulas = Arc::new([Formula::default(); FORMULAS]);
        let mut planned = Vec::new();
        for Item { line, code } in items {
            match code {
                Code::Formula { slot, formula } => {
                    if let Some(room) = Arc::make_mut(&mut formulas).get_mut(usize::from(*slot)) {
                        *room = *formula;
                    }
                }
                Code::Work(trace) => {
                    planned.push(Planned { line: *line, trace: *trace, formulas: Arc::clone(&formulas) });
                }
                _ => {}
            }
        }
        Works {
            machine: machine.clone(),
            planned,
            nodes: VecDeque::new(),
            cut: None,
            reports: Vec::new(),
            left_out: 0,
            now: Traced::default(),
        }
    }

    /// Takes one control cycle; `used` are shares of the limits, at a tick.
    pub(super) fn cycle(&mut self, record: &Record, is_tick: bool, used: Option<&PerAxis<Shares>>) {
        self.now = Traced::default();
        if self.planned.is_empty() {
            return;
        }
        let number = self.number(record, is_tick);
        if number != 0 && self.cut.as_ref().is_none_or(|cut| cut.number != number) {
            self.begin(number, record);
        }
        let Some(cut) = &mut self.cut else { return };
        if number == 0 {
            cut.lift();
        } else {
            self.now = cut.cycle(record, used);
        }
    }

    /// What was measured in the cycle taken last.
    pub(super) fn now(&self) -> Traced {
        self.now
    }

    /// Ends the observation: the reports, and how many traces with less deviation are left without one.
    pub(super) fn finish(mut self) -> (Vec<TraceReport>, u64) {
        self.close();
        (self.reports, self.left_out)
    }

    /// Another trace is cut: the next piece of the same seam, or something new.
    fn begin(&mut self, number: u32, record: &Record) {
        let planned = self.planned.get(number as usize - 1).cloned();
        let next = planned.and_then(|planned| {
            let gauge = Gauge::of(&planned.trace, &planned.formulas, &self.machine)?;
            Some((planned, gauge))
        });
        match (&mut self.cut, &next) {
            (Some(cut), Some((planned, gauge))) if cut.goes_on(number, planned) => cut.go_on(number, gauge),
            _ => {
                self.close();
                self.cut = next.map(|(planned, gauge)| {
                    Box::new(Cut::new(number, &planned, gauge, self.machine.general.cycle_s, record))
                });
            }
        }
    }

    /// Ends the trace in hand. What is worth a look is kept first, then what has the larger deviation.
    fn close(&mut self) {
        self.reports.extend(self.cut.take().map(|cut| cut.report()));
        if self.reports.len() > MOST {
            let places = 0..self.reports.len();
            let least = places.min_by(|a, b| {
                let [(a_odd, a_um), (b_odd, b_um)] = [*a, *b].map(|place| weight(&self.reports[place]));
                a_odd.cmp(&b_odd).then(a_um.total_cmp(&b_um))
            });
            self.reports.remove(least.unwrap_or(0));
            self.left_out += 1;
        }
    }

    /// The trace that is cut in this cycle; 0 if none.
    fn number(&mut self, record: &Record, is_tick: bool) -> u32 {
        let now = record.truth.cycle.0;
        if is_tick {
            let due = now + SETPOINT_LEAD * self.machine.cycles_per_tick();
            self.nodes.push_back((due, record.machine.work));
        }
        while self.nodes.get(1).is_some_and(|(due, _)| *due <= now) {
            self.nodes.pop_front();
        }
        match (self.nodes.front(), self.nodes.get(1)) {
            (Some((due, number)), _) if *due == now => *number,
            (Some((due, before)), Some((_, after))) if *due < now && self.is_one(*before, *after) => *before,
            _ => 0,
        }
    }

    /// Whether a trace, or a piece of a seam and the next one, is cut from one setpoint to the next.
    fn is_one(&self, before: u32, after: u32) -> bool {
        let seam = |number: u32| {
            let planned = self.planned.get(number.checked_sub(1)? as usize)?;
            matches!(planned.trace.shape, Shape::Seam(_)).then_some(planned.line)
        };
        let next = before.checked_add(1) == Some(after);
        before == after || next && seam(before).is_some() && seam(before) == seam(after)
    }
}

/// How much there is to see in a report: cycles without a figure, a feed that is low for no reason; then the
/// deviation, µm.
fn weight(report: &TraceReport) -> (bool, f64) {
    let odd = report.is_wrong() || report.unmeasured_cycles > 0 || report.feed.unexplained_s > 0.0;
    (odd, report.slide.max_abs_um())
}

/// A trace being cut, or several that are one seam.
#[derive(Clone, Debug)]
struct Cut {
    /// Of the first, and of the one that is cut now.
    first: u32,
    number: u32,
    /// Whether the tool has left the part since.
    lifted: bool,
    line: u32,
    trace: Work,
    cycle_s: f64,
    /// Of the commanded and of the true positions.
    points: [Point; 2],
    pace: Pace,
    begin_cycle: u64,
    end_cycle: u64,
    cycles: u64,
    unmeasured: u64,
    used: PerAxis<Shares>,
    axes: Vec<Axis>,
}

/// One of the two points that are measured.
#[derive(Clone, Debug)]
struct Point {
    gauge: Gauge,
    before: Option<[f64; 3]>,
    squares: f64,
    report: DeviationReport,
    reach: [[f64; 2]; 3],
}

impl Cut {
    fn new(number: u32, planned: &Planned, gauge: Gauge, cycle_s: f64, record: &Record) -> Cut {
        let Planned { line, trace, .. } = planned;
        let nothing =
            DeviationReport { low_um: f64::INFINITY, high_um: f64::NEG_INFINITY, ..Default::default() };
        let point = Point {
            gauge,
            before: None,
            squares: 0.0,
            report: nothing,
            reach: [[f64::INFINITY, f64::NEG_INFINITY]; 3],
        };
        let now = record.truth.cycle.0;
        Cut {
            first: number,
            number,
            lifted: false,
            line: *line,
            trace: *trace,
            cycle_s,
            points: [point.clone(), point],
            pace: Pace::new(cycle_s, trace.chord_of_steps()),
            begin_cycle: now,
            end_cycle: now,
            cycles: 0,
            unmeasured: 0,
            used: Default::default(),
            axes: record.axes.iter().map(|(axis, _)| *axis).collect(),
        }
    }

    /// Whether another trace is the next piece of the seam in hand.
    fn goes_on(&self, number: u32, planned: &Planned) -> bool {
        let seams = [&self.trace, &planned.trace].map(|trace| matches!(trace.shape, Shape::Seam(_)));
        !self.lifted
            && self.number.checked_add(1) == Some(number)
            && planned.line == self.line
            && seams == [true; 2]
    }

    /// From here on along the next piece.
    fn go_on(&mut self, number: u32, gauge: &Gauge) {
        self.number = number;
        self.points.iter_mut().for_each(|point| point.gauge = gauge.clone());
    }

    fn cycle(&mut self, record: &Record, used: Option<&PerAxis<Shares>>) -> Traced {
        let now = record.truth.cycle.0;
        self.lifted = false;
        (self.cycles, self.end_cycle) = (self.cycles + 1, now);
        let mut places = [PerAxis::default(), record.truth.axes.map(|axis| axis.slide_mm)];
        for (axis, status) in record.axes {
            places[0][axis.index()] = status.commanded_mm;
        }
        let mut steps = [None; 2];
        let mut seen = [None; 2];
        for (i, point) in self.points.iter_mut().enumerate() {
            seen[i] = point.gauge.see(&places[i]);
            steps[i] = point.take(seen[i], now as f64 * self.cycle_s);
        }
        let [Some(commanded), Some(slide)] = seen else {
            self.unmeasured += 1;
            return Traced { trace: self.first, ..Traced::default() };
        };
        self.take_pace(record, used, &commanded, steps);
        let row = |seen: Seen, step: Option<f64>| TracedPoint {
            deviation_mm: seen.deviation_mm,
            angle_deg: seen.angle_deg,
            feed_mm_min: 60.0 * step.unwrap_or(0.0) / self.cycle_s,
        };
        Traced { trace: self.first, commanded: row(commanded, steps[0]), slide: row(slide, steps[1]) }
    }

    fn take_pace(
        &mut self,
        record: &Record,
        used: Option<&PerAxis<Shares>>,
        commanded: &Seen,
        steps: [Option<f64>; 2],
    ) {
        if let Some(used) = used {
            for (most, used) in self.used.iter_mut().zip(used) {
                *most = std::array::from_fn(|i| most[i].max(used[i]));
            }
            let most = used.iter().flatten().copied().fold(0.0, f64::max);
            self.pace.tick(commanded.tip, most);
        }
        if let [Some(commanded), Some(slide)] = steps {
            let asked = self.trace.feed_mm_min / 60.0 * record.machine.feed_override_pct / 100.0;
            self.pace.cycle(commanded, slide, asked);
        }
    }

    /// The tool leaves the part for a while.
    fn lift(&mut self) {
        self.lifted = true;
        self.pace.lift();
        for point in &mut self.points {
            point.gauge.lift();
            point.before = None;
        }
    }

    fn report(self) -> TraceReport {
        let measured = (self.cycles - self.unmeasured).max(1) as f64;
        let [(commanded, reach_mm), (slide, _)] = self.points.map(|point| {
            let report = DeviationReport { rms_um: (point.squares / measured).sqrt(), ..point.report };
            let measures = report.low_um <= report.high_um;
            if measures { (report, point.reach) } else { Default::default() }
        });
        let (feed, way_mm) = self.pace.report(self.trace.feed_mm_min);
        let used = |axis: &Axis| {
            let [velocity_pct, acceleration_pct, jerk_pct, jerk_rate_pct] =
                self.used[axis.index()].map(|share| 100.0 * share);
            (*axis, AxisUsed { velocity_pct, acceleration_pct, jerk_pct, jerk_rate_pct })
        };
        let (kind, has_origin) = match self.trace.shape {
            Shape::Contour(..) => (WorkKind::Contour, true),
            Shape::Surface(_) => (WorkKind::Surface, true),
            Shape::Seam(_) => (WorkKind::Seam, false),
        };
        TraceReport {
            trace: self.first,
            line: self.line,
            kind,
            origin_mm: if has_origin { self.trace.origin.map(Position::mm) } else { [0.0; 3] },
            t_s: self.begin_cycle as f64 * self.cycle_s,
            begin_cycle: self.begin_cycle,
            end_cycle: self.end_cycle,
            cut_cycles: self.cycles,
            unmeasured_cycles: self.unmeasured,
            way_mm,
            reach_mm,
            most_um: (self.trace.correction == Correction::Exact).then_some(1e3 * self.trace.chord_mm),
            commanded,
            slide,
            feed,
            limits_used: self.axes.iter().map(used).collect(),
        }
    }
}

impl Point {
    /// Takes what was seen, and gives the way since the cycle before.
    fn take(&mut self, seen: Option<Seen>, t_s: f64) -> Option<f64> {
        let before = self.before;
        self.before = seen.map(|seen| seen.tip);
        let Seen { deviation_mm, angle_deg, tip } = seen?;
        let um = 1e3 * deviation_mm;
        self.squares += um * um;
        for (reach, at) in self.reach.iter_mut().zip(tip) {
            *reach = [reach[0].min(at), reach[1].max(at)];
        }
        let report = &mut self.report;
        if um.abs() > report.max_abs_um() {
            (report.worst_mm, report.worst_t_s) = (tip, t_s);
        }
        (report.low_um, report.high_um) = (report.low_um.min(um), report.high_um.max(um));
        report.angle_max_deg = report.angle_max_deg.max(angle_deg);
        before.map(|before| distance(tip, before))
    }
}
