//! Answers that come late, at every cycle around each border of a pass: nobody gets what is measured while
//! the process of plant and regulators stands, or a regulator alone stands and answers later what has
//! waited for it. All of them are counted. Two in a row are bridged, before the observer of all presses; at
//! the third the thread is left on its helix; at the twelfth the drives trip. Then, too, the cause has its
//! name, the machine comes to rest, no axis has gone deeper than the pass, and a tool that stays in its
//! groove is told.

use std::collections::{BTreeMap, BTreeSet};

use protocol::{Axis, Module, PerAxis, Position};
use rig::observe::{Observation, Outcome, Record, TOOL_IN_THREAD};

use super::{Job, POLICIES, SHORT, SHORT_FACE, Seen, way::Way, with};

/// For so many cycles plant and regulators stand, 0.5 to 50 ms, and so many a regulator alone.
const ALL_STAND: [u64; 9] = [1, 2, 3, 4, 8, 11, 12, 20, 100];
const ONE_STANDS: [u64; 6] = [2, 3, 4, 8, 11, 12];
/// So many are bridged.
const BRIDGED: u64 = 2;
/// So many trip the drives.
const TRIPS: u64 = 12;
/// A regulator does not believe the first measurement that is so many cycles ahead: one more answer is late.
const FAR_AHEAD: u64 = 50;
/// Of what has waited a regulator that goes on makes good so many cycles in each.
const MADE_GOOD: u64 = 3;
/// An axis on its way to depth stops no farther behind it, mm.
const DEEPER_MM: f64 = 0.001;
/// A tool that leaves stays so near to its helix, µm.
const BESIDE_UM: f64 = 1.0;
/// An axis rests that is slower, mm/s; a spindle, 1/min.
const RESTS_MM_S: f64 = 0.1;
const RESTS_RPM: f64 = 5.0;

/// Who stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Who {
    RealTime,
    Regulator(Axis),
}

/// So many cycles from one on.
#[derive(Clone, Copy, Debug)]
struct Stall {
    who: Who,
    at: u64,
    cycles: u64,
}

impl Stall {
    /// The interpolator has what was measured in the first cycle, since that was published before.
    fn scenario(&self, job: &Job) -> String {
        let Stall { who, at, cycles } = *self;
        let event = |at: u64, what: String| format!("[[event]]\nat = {{ cycle = {at} }}\n{what}\n");
        let lost = |channel: &str, count: u64| {
            format!("packet = {{ channel = \"{channel}\", count = {count}, drop = true }}")
        };
        let per_tick = job.machine.cycles_per_tick();
        let ticks = (at + 1..at + cycles).filter(|cycle| cycle.is_multiple_of(per_tick)).count() as u64;
        let above =
            if ticks > 0 { event(at + 1, lost("measurement/interpolator", ticks)) } else { String::new() };
        match who {
            Who::RealTime => event(at, lost("measurement", cycles)) + &above,
            Who::Regulator(axis) => {
                let for_s = cycles as f64 * job.machine.general.cycle_s;
                let process = Module::Regulator(axis).name();
                event(at, format!("freeze = {{ process = \"{process}\", for_s = {for_s} }}"))
            }
        }
    }

    /// Answers that are late, one by one.
    fn late(&self, job: &Job) -> u64 {
        match self.who {
            Who::RealTime => {
                (self.cycles + u64::from(self.cycles >= FAR_AHEAD)) * job.machine.axes().count() as u64
            }
            Who::Regulator(_) => self.cycles + (self.cycles - 1) / MADE_GOOD,
        }
    }

    fn is_bridged(&self, job: &Job, way: Way) {
        let what = format!("{self:?}");
        let Seen { observation, moves, end_mm, cut, late, .. } = way.finished(&what, |_| None);
        assert_eq!(late, self.late(job), "{what}");
        let Observation { outcome, faults, passes, .. } = observation;
        if outcome == Outcome::Faulted {
            // The frame that arms the pass was lost with the measurement.
            assert!(faults.iter().all(|fault| fault.code == "pass-called-off"), "{what}: {faults:?}");
            assert!(matches!(self.who, Who::RealTime) && cut.is_empty(), "{what}: {cut:?}");
            return;
        }
        assert_eq!((outcome, moves, &end_mm), (Outcome::Completed, job.moves, &job.end_mm), "{what}");
        assert!(cut.iter().all(|cut| cut.to_its_end) && cut.len() == job.phases_um.len(), "{what}: {cut:?}");
        for (pass, phase_um) in passes.iter().zip(&job.phases_um) {
            let apart_um = pass.phase_um - phase_um;
            assert!(pass.same_index && apart_um.abs() <= 1.5, "{what}: beside its groove by {apart_um} µm");
            assert!(pass.helix_max_abs_um < 3.0, "{what}: {} µm", pass.helix_max_abs_um);
        }
    }

    /// What became of the tool, and how deep it was.
    fn ends(&self, job: &Job, way: Way) -> Ended {
        let what = format!("{self:?}");
        let mut end = End::default();
        let Observation { outcome, faults, warnings, passes, .. } =
            way.seen_by(|record| end.see(job, record));
        assert_eq!(end.late, self.late(job), "{what}");
        assert_eq!(outcome, Outcome::Faulted, "{what}");
        let named = ["measurement-gap", "regulator-silent", "late-answers"];
        let told = faults.iter().find(|fault| fault.source == "interpolator");
        assert!(told.is_some_and(|fault| named.contains(&fault.code.as_str())), "{what}: {faults:?}");
        assert!(end.moved_mm < RESTS_MM_S * job.machine.general.cycle_s, "{what}: {} mm", end.moved_mm);
        assert!(end.rpm.abs() < RESTS_RPM, "{what}: {} 1/min", end.rpm);
        assert!(end.deeper_mm < DEEPER_MM, "{what}: {} mm too deep", end.deeper_mm);
        let told = warnings.iter().any(|warning| warning.code == TOOL_IN_THREAD);
        assert!(told || !end.in_groove, "{what}: {warnings:?}");
        let beside_um = passes.iter().map(|pass| pass.helix_max_abs_um).fold(0.0, f64::max);
        if self.cycles < TRIPS {
            assert!(!end.in_groove, "{what}: the tool stays in its groove; {faults:?}");
            assert!(beside_um < BESIDE_UM, "{what}: {beside_um} µm beside its helix");
        }
        Ended { cases: 1, stays: u32::from(end.in_groove), deeper_mm: end.deeper_mm, beside_um }
    }
}

/// What became of tools.
#[derive(Default)]
struct Ended {
    cases: u32,
    stays: u32,
    deeper_mm: f64,
    beside_um: f64,
}

impl Ended {
    fn add(&mut self, other: &Ended) {
        self.cases += other.cases;
        self.stays += other.stays;
        self.deeper_mm = self.deeper_mm.max(other.deeper_mm);
        self.beside_um = self.beside_um.max(other.beside_um);
    }
}

/// The end of a run in which the drives have tripped.
#[derive(Default)]
struct End {
    late: u64,
    motors_mm: PerAxis<f64>,
    /// In the last cycle.
    moved_mm: f64,
    rpm: f64,
    in_groove: bool,
    /// The deepest of the whole run, beyond the deepest of the pass.
    deeper_mm: f64,
}

impl End {
    fn see(&mut self, job: &Job, record: &Record) {
        let motors_mm = record.truth.axes.map(|axis| axis.motor_mm);
        let moved = motors_mm.iter().zip(&self.motors_mm).map(|(now, before)| (now - before).abs());
        self.moved_mm = moved.fold(0.0, f64::max);
        (self.motors_mm, self.rpm, self.late) =
            (motors_mm, record.truth.spindle_rpm, record.truth.late_answers);
        let pass = job.passes().next().expect("a thread");
        let (along, tool_mm) = (pass.along(), motors_mm[pass.out.axis as usize]);
        let law = pass.axis(along);
        let face_mm = law.start.mm() + pass.law(along).at(law.locked_deg()).s;
        let inside = (motors_mm[along.index()] - face_mm) * law.lead_mm >= 0.0;
        self.in_groove = inside && !pass.out.is_free(Position::from_mm(tool_mm));
        let lifts = pass.axis(if along == Axis::Z { Axis::X } else { Axis::Z });
        let depth_mm = lifts.start.mm() + lifts.stroke_mm;
        let into = (depth_mm - pass.out.clear.mm()).signum();
        self.deeper_mm = self.deeper_mm.max((tool_mm - depth_mm) * into);
    }
}

fn at_each_border(program: &str) {
    let job = Job::new(program, with(POLICIES[1]));
    let around = |border: &u64| border.saturating_sub(6)..border + 3;
    let cycles: BTreeSet<u64> = job.borders.iter().flat_map(around).collect();
    let whos: [(Who, &[u64]); 3] = [
        (Who::RealTime, &ALL_STAND),
        (Who::Regulator(Axis::X), &ONE_STANDS),
        (Who::Regulator(Axis::Z), &ONE_STANDS),
    ];
    let (mut way, mut bridged, mut ended) = (job.begin(), 0, BTreeMap::<_, Ended>::new());
    // The drives are on by then, and what is late last is counted before the end.
    for at in cycles.into_iter().filter(|at| *at > 40 && at + 200 < job.cycles) {
        way.to(at);
        let stalls = whos.iter().flat_map(|(who, long)| long.iter().map(|cycles| (*who, *cycles)));
        for stall in stalls.map(|(who, cycles)| Stall { who, at, cycles }) {
            let way = way.clone().playing(&stall.scenario(&job));
            if stall.cycles <= BRIDGED {
                stall.is_bridged(&job, way);
                bridged += 1;
            } else {
                ended.entry((stall.cycles, stall.who)).or_default().add(&stall.ends(&job, way));
            }
        }
    }
    println!("{bridged} are bridged");
    for ((cycles, who), Ended { cases, stays, deeper_mm, beside_um }) in &ended {
        println!(
            "{who:?} {cycles} cycles: {cases}, the tool stays in {stays}; {:.2} µm too deep, {beside_um:.2} µm beside",
            1e3 * deeper_mm
        );
    }
    assert!(ended.iter().any(|((cycles, _), ended)| *cycles >= TRIPS && ended.stays > 0), "none stays");
}

#[test]
fn late_answers_at_every_cycle_around_each_border_of_a_pass() {
    at_each_border(SHORT);
}

#[test]
fn late_answers_at_every_cycle_around_each_border_of_a_pass_on_a_face() {
    at_each_border(SHORT_FACE);
}
