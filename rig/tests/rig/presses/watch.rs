//! The observer from outside. In: every cycle of a run. Out: what was moved and cut, and where the tool was
//! when it left; a cycle that breaks a rule is a panic.

use protocol::{Axis, AxisState, AxisStatus, MachineState, ThreadPass};
use rig::observe::Record;

use super::Job;

/// The tool is nowhere else in its groove, mm.
const GROOVE_MM: f64 = 0.005;
/// Turns that a tool which leaves is still at depth: it has lifted by less than this, mm.
const MOST_TURNS: f64 = 1.5;
const AT_DEPTH_MM: f64 = 0.1;
/// A brake behind the end of a pass is so near to it, mm.
const BEYOND_MM: f64 = 1e-3;

/// A pass that has begun, and how it ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cutting {
    pub(super) number: u32,
    /// Every axis came to rest at its end.
    pub(super) to_its_end: bool,
}

/// A pass in hand.
#[derive(Clone, Copy)]
struct InPass {
    pass: ThreadPass,
    /// True angle of its index, degrees.
    index_deg: f64,
    /// Angle and depth at which the axes began to leave, degrees and mm.
    left: Option<(f64, f64)>,
    moved: bool,
}

#[derive(Clone)]
pub(super) struct Watch<'a> {
    job: &'a Job,
    last_mm: Vec<f64>,
    last_mm_s: Vec<f64>,
    /// In which cycle each axis has said so.
    said: Vec<u64>,
    states: Vec<u32>,
    index: (u64, f64),
    in_pass: Option<InPass>,
    over: bool,
    pub(super) end_mm: Vec<f64>,
    pub(super) moves: u64,
    pub(super) borders: Vec<u64>,
    pub(super) cut: Vec<Cutting>,
    /// Answers that were late.
    pub(super) late: u64,
    /// Most turns at depth and in the groove on the way out, and largest error in it, mm.
    pub(super) turns_at_depth: f64,
    pub(super) most_turns: f64,
    pub(super) most_mm: f64,
}

fn is(status: &AxisStatus, state: AxisState) -> bool {
    status.state == state as u32
}

impl<'a> Watch<'a> {
    pub(super) fn new(job: &'a Job) -> Watch<'a> {
        Watch {
            job,
            last_mm: vec![],
            last_mm_s: vec![],
            said: vec![],
            states: vec![],
            index: (0, 0.0),
            in_pass: None,
            over: false,
            end_mm: vec![],
            moves: 0,
            borders: vec![],
            cut: vec![],
            late: 0,
            turns_at_depth: 0.0,
            most_turns: 0.0,
            most_mm: 0.0,
        }
    }

    pub(super) fn cycle(&mut self, what: &str, record: &Record) {
        self.steps(what, record);
        self.pass(what, record);
        let mut states: Vec<u32> = record.axes.iter().map(|(_, status)| status.state).collect();
        states.push(record.machine.state);
        if states != self.states {
            self.borders.push(record.truth.cycle.0);
        }
        self.last_mm = record.axes.iter().map(|(_, status)| status.commanded_mm).collect();
        self.last_mm_s = record.axes.iter().map(|(_, status)| status.velocity_mm_s).collect();
        self.late = record.truth.late_answers;
        self.said = record.axes.iter().map(|(_, status)| status.cycle.0).collect();
        self.end_mm.clone_from(&self.last_mm);
        self.states = states;
        self.moves = record.machine.moves;
        self.over = record.machine.state == MachineState::Ended as u32;
    }

    /// What is commanded changes no faster than the axes can, and by nothing before a pass and after the end.
    fn steps(&self, what: &str, record: &Record) {
        let cycle_s = self.job.machine.general.cycle_s;
        for (i, (axis, status)) in record.axes.iter().enumerate() {
            let Some((before, before_s)) = self.last_mm.get(i).zip(self.last_mm_s.get(i)) else { continue };
            // An axis that is led by nobody says where it was measured.
            let led = |state: u32| state != AxisState::Idle as u32 && state != AxisState::Fault as u32;
            if !led(status.state) || !led(self.states[i]) {
                continue;
            }
            // A stop in timed motion begins in the middle of a ramp: it may use a little more.
            let spare = if is(status, AxisState::Leaving) && status.pass == 0 { 1.25 } else { 1.0 };
            let limits = self.job.machine.axis[axis].limits();
            // Who was late says the next thing after more than a cycle.
            let cycle_s = cycle_s * status.cycle.0.saturating_sub(self.said[i]) as f64;
            let (now, now_s) = (status.commanded_mm, status.velocity_mm_s);
            let (step, change) = ((now - before).abs(), (now_s - before_s).abs());
            let at =
                format_args!("{what}, cycle {}, {axis:?} in state {}", record.truth.cycle.0, status.state);
            assert!(step <= spare * limits.v * cycle_s * (1.0 + 1e-4) + 1e-6, "{at}: {before} → {now} mm");
            assert!(change <= spare * limits.a * cycle_s * 1.02 + 1e-6, "{at}: {before_s} → {now_s} mm/s");
            assert!(!self.over || step < 2e-9, "{at}: moves after the end by {step:e} mm");
            let may_move = !is(status, AxisState::Armed) && !is(status, AxisState::WaitingForC0);
            assert!(may_move || step < 2e-9, "{at}: moves before its pass");
        }
    }

    /// While the tool is in its groove it is on its helix, and it does not stay there for long once it
    /// leaves.
    fn pass(&mut self, what: &str, record: &Record) {
        let truth = record.truth;
        if truth.measurement.index_number != self.index.0 {
            self.index = (truth.measurement.index_number, 360.0 * (truth.spindle_deg / 360.0).round());
        }
        let in_pass = |(_, status): &&(Axis, AxisStatus)| status.pass != 0 && status.state().has_begun();
        let Some((_, first)) = record.axes.iter().find(in_pass) else {
            self.leave_pass(record);
            return;
        };
        let known = self.in_pass;
        let mut now = known.unwrap_or_else(|| InPass {
            pass: *self.job.pass(first.pass),
            index_deg: self.index.1,
            left: None,
            moved: false,
        });
        let c = now.pass.direction * (truth.spindle_deg - now.index_deg);
        let along = now.pass.along();
        let law = now.pass.axis(along);
        let motion = now.pass.law(along);
        let helix_mm = law.start.mm() + motion.at(c).s;
        let (tool, slide) = (&truth.axes[now.pass.out.axis as usize], &truth.axes[along.index()]);
        let out = &now.pass.out;
        // The part begins where the axis along the thread has reached its lead.
        let face_mm = law.start.mm() + motion.at(law.locked_deg()).s;
        let inside = (slide.motor_mm - face_mm) * law.lead_mm >= 0.0;
        let in_groove = inside && !out.is_free(protocol::Position::from_mm(tool.motor_mm));
        now.moved |= record.axes.iter().any(|(_, status)| status.velocity_mm_s != 0.0);
        if record.axes.iter().any(|(_, status)| is(status, AxisState::Leaving)) {
            now.left = now.left.or(Some((c, tool.motor_mm)));
        }
        let at = format_args!("{what}, cycle {}", truth.cycle.0);
        if in_groove {
            let error = (slide.motor_mm - helix_mm).abs();
            self.most_mm = self.most_mm.max(error);
            assert!(error <= GROOVE_MM, "{at}: {error} mm beside its groove");
            if let Some((since, depth_mm)) = now.left {
                let turns = (c - since) / 360.0;
                self.most_turns = self.most_turns.max(turns);
                let at_depth = (tool.motor_mm - depth_mm).abs() < AT_DEPTH_MM;
                if at_depth {
                    self.turns_at_depth = self.turns_at_depth.max(turns);
                }
                assert!(!at_depth || turns <= MOST_TURNS, "{at}: {turns} turns at depth");
            }
        }
        let [low, high] = [law.start.mm().min(law.end.mm()), law.start.mm().max(law.end.mm())];
        let (_, led) = record.axes.iter().find(|(axis, _)| *axis == along).expect("a lathe");
        let within = (low - BEYOND_MM..=high + BEYOND_MM).contains(&led.commanded_mm);
        assert!(is(led, AxisState::Fault) || within, "{at}: {along} at {}", led.commanded_mm);
        self.in_pass = Some(now);
    }

    fn leave_pass(&mut self, record: &Record) {
        let Some(before) = self.in_pass.take() else { return };
        let near = |axis: Axis, mm: f64| (mm - before.pass.axis(axis).end.mm()).abs() < 1e-6;
        let to_its_end = record.axes.iter().all(|(axis, status)| near(*axis, status.commanded_mm));
        if before.moved {
            self.cut.push(Cutting { number: before.pass.pass, to_its_end });
        }
    }
}
