//! What is known of a run before it begins, for whoever looks at its cycles. In: the setup of the run. Out:
//! limits of torque, N·m, origins, mm, names of tools, the plan.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

use ::panel::{MachineSeen, Point, ProgramSeen};
use interpreter::{Language, ZeroNote};
use machine::Machine;
use process::shell::Pace;
use protocol::{Axis, MachineState, MachineStatus, PerAxis};
use rig::observe::{Observer, Record};

use super::{
    homing::{Asked, Homing, InHand},
    jog::fastest_jog,
    origins::Origins,
    plan::Plan,
    view,
};
use crate::{program::Program, run::Setup};

/// Longest text of a program that is shown, bytes.
pub(super) const MOST_TEXT: u64 = 512 << 10;

/// A run that is shown: one that begins, or one that was recorded.
pub(super) struct Shown<'a> {
    pub(super) machine: &'a Machine,
    pub(super) program: &'a Program,
    /// Its program, and how that is read.
    pub(super) path: &'a Path,
    pub(super) language: &'a Language,
    pub(super) folder: &'a Path,
    pub(super) pace: Pace,
}

impl<'a> Shown<'a> {
    /// One that begins.
    pub(super) fn begins(setup: &'a Setup) -> Shown<'a> {
        let Setup { machine, program, folder, pace, .. } = setup;
        Shown {
            machine,
            program,
            path: &folder.program,
            language: &folder.language,
            folder: &folder.path,
            pace: *pace,
        }
    }
}

/// What is known before.
#[derive(Debug, Default)]
pub(crate) struct Known {
    pub(super) plan: Plan,
    pub(super) homing: Homing,
    /// All steps of the program.
    pub(super) steps: u64,
    pub(super) cycle_s: f64,
    pub(super) torque_limit_nm: PerAxis<f64>,
    /// Torque, N·m, and power, kW, of the motor of the spindle.
    spindle_peak: [f64; 2],
    pub(super) tool_names: BTreeMap<u32, String>,
    origins: Origins,
    /// So many notes of the zero were in force at the last look.
    in_force: usize,
    /// By hand: how far the tool is drawn beside where it is, X and Z, mm.
    moved_by_hand: Option<[f64; 2]>,
    /// Passes of which the program does not say how deep they go below the crest.
    guessed: BTreeSet<u32>,
    /// Whether the machine waits for a start, and in which cycle it went on last: what was said before that
    /// is done.
    waits: bool,
    pub(super) went_on: u64,
}

impl Known {
    /// Of a run, and the way that its tool will go.
    pub(super) fn of(run: &Shown) -> (Known, Vec<Point>) {
        let Shown { machine, program, path, language, .. } = *run;
        let items = program.items(path, language, machine);
        let items = items.into_iter().flatten().map_while(Result::ok);
        let origins = Origins::of(program);
        let passes = program.check.iter().flat_map(|check| &check.passes);
        let guessed = passes.filter(|note| note.depth_mm.is_none());
        let drawn = |place: &mut _, pass, steps| moved(place, origins.moved(pass, steps));
        let (plan, way) = Plan::of(items, machine, program.time_s, drawn);
        let mut torque_limit_nm = PerAxis::default();
        machine.axes().for_each(|(axis, config)| torque_limit_nm[axis.index()] = config.torque_limit_nm);
        let named =
            machine.tools.iter().map(|(number, tool)| Some((number.parse().ok()?, tool.name.clone())));
        let known = Known {
            plan,
            homing: Homing::of(machine),
            steps: program.steps,
            cycle_s: machine.general.cycle_s,
            torque_limit_nm,
            spindle_peak: sim_plant::spindle_peak(machine).unwrap_or_default(),
            tool_names: named.flatten().collect(),
            origins,
            in_force: 0,
            moved_by_hand: None,
            guessed: guessed.map(|note| note.pass).collect(),
            waits: false,
            went_on: 0,
        };
        (known, way)
    }

    /// One control cycle; `given` is what is in hand of what somebody gives by hand.
    pub(super) fn cycle(&mut self, record: &Record, given: Option<InHand>) {
        let waits = record.machine.state().waits_for_start();
        if std::mem::replace(&mut self.waits, waits) && !waits {
            self.went_on = record.truth.cycle.0;
        }
        match (given, self.plan.by_hand) {
            (Some(given), _) => self.homing.by_hand(record, given),
            // A session that is made again.
            (None, true) => {
                let asked = self.plan.references(record.machine.taken);
                self.homing.cycle(record, Asked::ByHand(asked));
            }
            (None, false) => self.homing.cycle(record, Asked::Program),
        }
    }

    /// How deep the pass goes below the crest, mm; 0 where the program does not say where that is.
    pub(super) fn depth_mm(&self, machine: &MachineStatus) -> f64 {
        if self.guessed.contains(&machine.pass) { 0.0 } else { machine.depth_mm }
    }

    /// What the motor of the spindle can at a speed, N·m: its torque, or what its power leaves of that.
    pub(super) fn spindle_limit_nm(&self, rpm: f64) -> f64 {
        let [torque_nm, power_kw] = self.spindle_peak;
        let speed = rpm.abs() * std::f64::consts::TAU / 60.0;
        torque_nm.min(1e3 * power_kw / speed.max(1e-3))
    }

    /// X and Z of the machine at which those of the program are 0, where that is known: in the pass or the
    /// block in hand.
    pub(super) fn origin_mm(&self, machine: &MachineStatus) -> Option<[f64; 2]> {
        self.origins.at(pass_in_hand(machine), self.before(machine))
    }

    /// How far the tool is drawn beside where it is, X and Z, mm: so that the part lies in one place,
    /// whichever tool is at work there.
    pub(super) fn moved_mm(&self, machine: &MachineStatus) -> [f64; 2] {
        let known = || self.origins.moved(pass_in_hand(machine), self.before(machine));
        self.moved_by_hand.or_else(known).unwrap_or_default()
    }

    /// By hand: the tool is drawn so far beside where it is, X and Z, mm.
    pub(super) fn is_drawn_by_hand(&mut self, moved_mm: [f64; 2]) {
        self.moved_by_hand = Some(moved_mm);
    }

    /// What the program has said of its zero so far, if that is more, or less, than at the last look.
    pub(super) fn zero_now(&mut self, machine: &MachineStatus) -> Option<&[ZeroNote]> {
        let notes = self.origins.so_far(self.before(machine));
        (std::mem::replace(&mut self.in_force, notes.len()) != notes.len()).then_some(notes)
    }

    /// Steps of progress that are over when the block in hand begins.
    fn before(&self, machine: &MachineStatus) -> u64 {
        self.plan.before(machine.taken, machine.line)
    }

    /// Where the tool is drawn, by what is measured: where an axis truly is, nobody at a machine sees.
    pub(super) fn place(&self, record: &Record) -> Point {
        let (mut place, machine) = (PerAxis::default(), record.machine);
        for (axis, status) in record.axes {
            place[axis.index()] = status.commanded_mm - status.servo_error_mm;
        }
        moved(&mut place, Some(self.moved_mm(machine)));
        let at = record.axes.iter().map(|(axis, _)| place[axis.index()] as f32);
        (at.collect(), view::kind(record))
    }
}

/// Moves a place in X and Z, mm.
fn moved(place: &mut PerAxis<f64>, by_mm: Option<[f64; 2]>) {
    let [x, z] = by_mm.unwrap_or_default();
    place[Axis::X.index()] += x;
    place[Axis::Z.index()] += z;
}

/// The pass that is in hand.
fn pass_in_hand(machine: &MachineStatus) -> Option<u32> {
    (machine.state() == MachineState::Threading).then_some(machine.pass)
}

/// What stays the same during a run.
pub(super) fn stays(run: &Shown, observer: &Observer) -> (ProgramSeen, MachineSeen) {
    let Shown { machine, program, path, folder, .. } = *run;
    let text = intake::text(path, MOST_TEXT).ok();
    let origin_mm = Origins::of(program).first();
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let program = ProgramSeen {
        name,
        text,
        passes: program.passes(),
        time_s: program.time_s,
        folder: folder.display().to_string(),
    };
    let stock = observer.stock().and_then(|stock| serde_json::to_value(stock).ok());
    (program, MachineSeen { stock, origin_mm, ..machine_seen(machine, run.pace) })
}

/// What is always seen of a machine.
pub(super) fn machine_seen(machine: &Machine, pace: Pace) -> MachineSeen {
    let axes: Vec<_> = machine.axes().collect();
    MachineSeen {
        name: machine.general.name.clone(),
        kinematics: machine.general.kinematics.name().into(),
        axes: axes.iter().map(|(axis, _)| axis.name().to_ascii_uppercase()).collect(),
        travel: axes.iter().map(|(_, config)| config.travel_mm).collect(),
        cycle_s: machine.general.cycle_s,
        max_rpm: machine.spindle.max_rpm,
        pace: pace.to_string(),
        stock: None,
        origin_mm: None,
        flanks_deg: flanks_deg(machine),
        fastest_jog: axes.iter().map(|(_, config)| fastest_jog(config)).collect(),
    }
}

/// Angle between the flanks of tools, degrees, by number; at 0 that of the machine file.
fn flanks_deg(machine: &Machine) -> BTreeMap<u32, f64> {
    let of = machine.tools.iter().filter_map(|(number, tool)| Some((number.parse().ok()?, tool.angle_deg?)));
    std::iter::once((0, 2.0 * machine.threading.flank_half_angle_deg)).chain(of).collect()
}
