//! The trial pass before and after: servo errors at five overrides. In: the machine as believed, and as
//! proposed. Out: rows, and the servo error over time. A pass that the machine does not make is a row that
//! says why.

use machine::{Kinematics, Machine};
use protocol::{Axis, AxisState};
use rig::{
    observe::{Outcome, PassReport, Record, ServoError},
    trial::{Trial, in_force_pct, program, run_for},
};
use serde::Serialize;
use sim_plant::Scenario;

/// Spindle overrides of the trial passes, per cent.
const OVERRIDES: [f64; 5] = [120.0, 100.0, 80.0, 60.0, 40.0];

/// Longest time on the machine for a pass, s: an axis that swings is never in position, and its pass never
/// begins.
const PATIENCE_S: f64 = 20.0;

/// How much farther off than before an axis may be in the thread without a word, and what counts at all, µm.
const WORSE: f64 = 1.5;
const WORTH_SAYING_UM: f64 = 0.5;

/// Servo error over time, s and µm.
type Curve = Vec<(f64, f64)>;

/// Servo errors of an axis in one trial pass.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Row {
    pub(super) axis: Axis,
    pub(super) override_pct: f64,
    /// The lowest that was in force: the machine clamps more than it allows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) in_force_pct: Option<f64>,
    pub(super) tuned: bool,
    #[serde(flatten)]
    pub(super) errors: Option<Errors>,
    /// Why there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) failed: Option<String>,
}

/// The servo errors themselves.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Errors {
    pub(super) approach_min_um: f64,
    pub(super) approach_max_um: f64,
    pub(super) end_um: f64,
    /// In the thread, from one turn after the axis was on the helix.
    pub(super) thread_max_abs_um: f64,
    /// The same from the moment it was there.
    pub(super) at_depth_max_abs_um: f64,
}

/// Trial passes before and after.
pub(super) struct Compared {
    pub(super) rows: Vec<Row>,
    /// Servo error of each axis at 100 %, before and after.
    pub(super) curves: Vec<(Axis, [Curve; 2])>,
}

impl Compared {
    /// Where the proposal leaves the thread worse than it was.
    pub(super) fn worse(&self) -> Option<String> {
        let at_depth = |row: &Row| row.errors.as_ref().map(|errors| errors.at_depth_max_abs_um);
        self.rows.iter().filter(|row| row.tuned).find_map(|after| {
            let same = |row: &&Row| !row.tuned && (row.axis, row.override_pct) == (after.axis, after.override_pct);
            let (was, is) = (at_depth(self.rows.iter().find(same)?)?, at_depth(after)?);
            (is > WORSE * was && is > WORTH_SAYING_UM).then(|| {
                format!(
                    "the proposal is worse than what was: {} at {} % is {is:.2} µm off at depth, {was:.2} µm before",
                    after.axis, after.override_pct
                )
            })
        })
    }

    /// What the machine failed at with the proposal.
    pub(super) fn failed_after(&self) -> Option<String> {
        let why = |row: &Row| Some(format!("at {} %: {}", row.override_pct, row.failed.as_ref()?));
        self.rows.iter().filter(|row| row.tuned).find_map(why)
    }
}

/// Runs the trial passes, and shows those of `tuned` that take part in them.
///
/// # Errors
/// Why none can be made, as on a mill.
pub(super) fn compared(
    before: &Machine,
    after: &Machine,
    tuned: &[Axis],
    seed: u64,
) -> Result<Compared, String> {
    if before.general.kinematics != Kinematics::Lathe {
        return Err("it is a threading pass, and only a lathe cuts threads".into());
    }
    let axes: Vec<Axis> = tuned.iter().copied().filter(|axis| matches!(axis, Axis::X | Axis::Z)).collect();
    if axes.is_empty() {
        return Err("only X and Z take part in it".into());
    }
    let curves = axes.iter().map(|axis| (*axis, [Vec::new(), Vec::new()])).collect();
    let mut compared = Compared { rows: Vec::new(), curves };
    for override_pct in OVERRIDES {
        for (machine, tuned) in [(before, false), (after, true)] {
            let (report, curves) = pass(machine, &axes, override_pct, seed)?;
            compared.rows.extend(axes.iter().map(|axis| row(machine, *axis, override_pct, tuned, &report)));
            if override_pct == 100.0 {
                for ((_, both), curve) in compared.curves.iter_mut().zip(curves) {
                    both[usize::from(tuned)] = curve;
                }
            }
        }
    }
    Ok(compared)
}

fn row(
    machine: &Machine,
    axis: Axis,
    override_pct: f64,
    tuned: bool,
    report: &Result<PassReport, String>,
) -> Row {
    let errors = |report: &PassReport| {
        let ServoError { approach_min_um, approach_max_um, end_um, thread_max_abs_um, settled_max_abs_um } =
            if axis == Axis::X { report.x } else { report.z };
        Errors {
            approach_min_um,
            approach_max_um,
            end_um,
            thread_max_abs_um: settled_max_abs_um,
            at_depth_max_abs_um: thread_max_abs_um,
        }
    };
    let in_force_pct = report.as_ref().ok().map(|report| in_force_pct(machine, report));
    Row {
        axis,
        override_pct,
        in_force_pct,
        tuned,
        errors: report.as_ref().ok().map(errors),
        failed: report.as_ref().err().cloned(),
    }
}

/// A trial pass, or why it was not made to its end; servo errors over the time since each axis began to move.
///
/// # Errors
/// Why the machine cannot be asked for one.
fn pass(
    machine: &Machine,
    axes: &[Axis],
    override_pct: f64,
    seed: u64,
) -> Result<(Result<PassReport, String>, Vec<Curve>), String> {
    let items = program(machine, &[Trial::default()]).map_err(|error| error.to_string())?;
    let mut curves = vec![Curve::new(); axes.len()];
    let mut begun = vec![None; axes.len()];
    let scenario = Scenario::spindle_override(override_pct);
    let mut see = |record: &Record| {
        for ((axis, curve), begun) in axes.iter().zip(&mut curves).zip(&mut begun) {
            let status = record.axes.iter().find(|(seen, _)| seen == axis).map(|(_, status)| status);
            let Some(status) = status.filter(|status| moves(status.state)) else { continue };
            let first = *begun.get_or_insert(status.cycle.0);
            let t_s = (status.cycle.0 - first) as f64 * machine.general.cycle_s;
            curve.push((t_s, 1e3 * status.servo_error_mm));
        }
    };
    let most = (PATIENCE_S / machine.general.cycle_s) as u64;
    let seen =
        run_for(most, machine, &items, &scenario, seed, &mut see).map_err(|error| error.to_string())?;
    let fault = seen.faults.first().map(|fault| format!("{}: {}", fault.source, fault.text));
    let pass = seen.passes.into_iter().next().filter(|_| seen.outcome == Outcome::Completed);
    Ok((pass.ok_or_else(|| fault.unwrap_or_else(|| "it was not made to its end".into())), curves))
}

/// Whether an axis approaches or is on its helix.
fn moves(state: u32) -> bool {
    state == AxisState::RunIn as u32 || state == AxisState::Locked as u32
}
