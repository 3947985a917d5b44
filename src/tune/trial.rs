//! The trial pass before and after: servo errors at five overrides. In: the machine as believed, and as proposed. Out: rows,
//! and the servo error over time.

use protocol::{Axis, AxisState, Machine, machine::Kinematics};
use rig::{
    observe::{Outcome, ServoError},
    trial::{Trial, program, run},
};
use serde::Serialize;
use sim_plant::Scenario;

/// Spindle overrides of the trial passes, per cent.
const OVERRIDES: [f64; 5] = [120.0, 100.0, 80.0, 60.0, 40.0];

/// Servo errors of X in one trial pass.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Row {
    pub(super) override_pct: f64,
    pub(super) tuned: bool,
    pub(super) approach_min_um: f64,
    pub(super) approach_max_um: f64,
    pub(super) end_um: f64,
    /// In the thread, from one turn after X came to depth.
    pub(super) thread_max_abs_um: f64,
    /// The same from the moment it came to depth.
    pub(super) at_depth_max_abs_um: f64,
}

/// Trial passes before and after.
pub(super) struct Compared {
    pub(super) rows: Vec<Row>,
    /// Servo error of X at 100 %, s and µm, before and after.
    pub(super) curves: [Vec<(f64, f64)>; 2],
}

/// Runs the trial passes.
///
/// # Errors
/// Why none can be made, as on a mill.
pub(super) fn compared(before: &Machine, after: &Machine, seed: u64) -> Result<Compared, String> {
    if before.machine.kinematics != Kinematics::Lathe {
        return Err("it is a threading pass, and only a lathe cuts threads".into());
    }
    let mut compared = Compared { rows: Vec::new(), curves: [Vec::new(), Vec::new()] };
    for override_pct in OVERRIDES {
        for (machine, tuned) in [(before, false), (after, true)] {
            let (error, curve) = pass(machine, override_pct, seed)?;
            compared.rows.push(Row {
                override_pct,
                tuned,
                approach_min_um: error.approach_min_um,
                approach_max_um: error.approach_max_um,
                end_um: error.end_um,
                thread_max_abs_um: error.settled_max_abs_um,
                at_depth_max_abs_um: error.thread_max_abs_um,
            });
            if override_pct == 100.0 {
                compared.curves[usize::from(tuned)] = curve;
            }
        }
    }
    Ok(compared)
}

/// Servo error of X in a trial pass, and over the time since its approach began.
fn pass(machine: &Machine, override_pct: f64, seed: u64) -> Result<(ServoError, Vec<(f64, f64)>), String> {
    let items = program(machine, &[Trial::default()]).map_err(|error| error.to_string())?;
    let mut curve = Vec::new();
    let mut begun = None;
    let scenario = Scenario::spindle_override(override_pct);
    let seen = run(machine, &items, &scenario, seed, &mut |record| {
        let x = record.axes.iter().find(|(axis, _)| *axis == Axis::X);
        let Some((_, status)) = x.filter(|(_, status)| moves(status.state)) else { return };
        let first = *begun.get_or_insert(status.cycle.0);
        let t_s = (status.cycle.0 - first) as f64 * machine.machine.cycle_s;
        curve.push((t_s, 1e3 * status.servo_error_mm));
    });
    let seen = seen.map_err(|error| error.to_string())?;
    match seen.passes.first() {
        Some(pass) if seen.outcome == Outcome::Completed => Ok((pass.x, curve)),
        _ => Err("the trial pass was not made to its end".into()),
    }
}

/// Whether an axis approaches or is on its helix.
fn moves(state: u32) -> bool {
    state == AxisState::RunIn as u32 || state == AxisState::Locked as u32
}
