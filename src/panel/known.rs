//! What is known of a run before it begins, for whoever looks at its cycles. In: the setup of the run. Out:
//! limits of torque, N·m, origins, mm, names of tools, the plan.

use std::{collections::BTreeMap, path::Path};

use ::panel::{MachineSeen, Point, ProgramSeen};
use interpreter::Language;
use machine::Machine;
use process::shell::Pace;
use protocol::{MachineState, MachineStatus, PerAxis};
use rig::observe::{Observer, Record};

use super::{
    hand::fastest_jog,
    homing::{Asked, Homing, InHand},
    plan::Plan,
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
    /// X and Z of the machine where those of the program are 0, by tool, and by pass.
    origins_mm: [BTreeMap<u32, [f64; 2]>; 2],
}

impl Known {
    /// Of a run, and the way that its tool will go.
    pub(super) fn of(run: &Shown) -> (Known, Vec<Point>) {
        let Shown { machine, program, path, language, .. } = *run;
        let items = program.items(path, language, machine);
        let items = items.into_iter().flatten().map_while(Result::ok);
        let (plan, way) = Plan::of(items, machine, program.time_s);
        let mut torque_limit_nm = PerAxis::default();
        machine.axes().for_each(|(axis, config)| torque_limit_nm[axis.index()] = config.torque_limit_nm);
        let check = program.check.as_ref();
        let by_tool = check.map(|check| check.origins_mm.clone()).unwrap_or_default();
        let by_pass = check.iter().flat_map(|check| &check.passes).map(|note| (note.pass, note.origin_mm));
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
            origins_mm: [by_tool, by_pass.collect()],
        };
        (known, way)
    }

    /// One control cycle; `given` is what is in hand of what somebody gives by hand.
    pub(super) fn cycle(&mut self, record: &Record, given: Option<InHand>) {
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

    /// What the motor of the spindle can at a speed, N·m: its torque, or what its power leaves of that.
    pub(super) fn spindle_limit_nm(&self, rpm: f64) -> f64 {
        let [torque_nm, power_kw] = self.spindle_peak;
        let speed = rpm.abs() * std::f64::consts::TAU / 60.0;
        torque_nm.min(1e3 * power_kw / speed.max(1e-3))
    }

    /// X and Z of the machine at which those of the program are 0, where that is known: in a pass, else with
    /// the tool in hand.
    pub(super) fn origin_mm(&self, machine: &MachineStatus) -> Option<[f64; 2]> {
        let [by_tool, by_pass] = &self.origins_mm;
        let of_pass = by_pass.get(&machine.pass).filter(|_| machine.state() == MachineState::Threading);
        of_pass.or_else(|| by_tool.get(&machine.tool)).copied()
    }
}

/// What stays the same during a run.
pub(super) fn stays(run: &Shown, observer: &Observer) -> (ProgramSeen, MachineSeen) {
    let Shown { machine, program, path, folder, .. } = *run;
    let text = intake::text(path, MOST_TEXT).ok();
    let notes = program.check.as_ref();
    let origin_mm = notes.and_then(|check| {
        let of_pass = check.passes.first().map(|note| note.origin_mm);
        of_pass.or_else(|| check.origins_mm.values().next().copied())
    });
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
