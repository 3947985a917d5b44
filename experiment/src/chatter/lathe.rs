//! Threads on the whole lathe with a tool that gives way, at an even and at a varied speed. In: a machine.
//! Out: for each pass how far the depth at the tool swings, µm; its course.

use machine::Machine;
use protocol::AxisState;

use super::{MODE, NAMED_RPM, strongest};
use crate::{ExperimentError, stand::Stand};

/// Between two points of the course, control cycles.
const EVERY: u64 = 4;

/// A thread that was cut.
pub(super) struct Thread {
    pub(super) varied: bool,
    /// Of each pass its depth, mm, the width of its chip, mm, and the swing of the depth at the tool, µm.
    pub(super) passes: Vec<[f64; 3]>,
    /// Turns into the pass, and how far the tool is beside its full depth, µm, of the pass that swings most.
    pub(super) course: Vec<(f64, f64)>,
}

/// The machine with a tool that gives way, in steel.
fn in_steel(machine: &Machine) -> Result<Machine, ExperimentError> {
    let mut machine = machine.clone();
    let text = format!(
        "[chatter]\nstiffness_n_mm = {:?}\nmode_hz = {:?}\ndamping = {:?}\n",
        MODE.stiffness_n_mm, MODE.hz, MODE.damping
    );
    let failed = |reason: String| ExperimentError::Machine(reason);
    let chatter: toml::Table = toml::from_str(&text).map_err(|error| failed(error.to_string()))?;
    machine.plant.extend(chatter);
    let cutting = machine.plant.entry("cutting").or_insert_with(|| toml::Table::new().into());
    let cutting = cutting.as_table_mut().ok_or_else(|| failed("[plant.cutting] is no table".into()))?;
    for (key, value) in [("specific_force_n_mm2", 2000.0), ("form_factor", 1.5), ("radial_share", 0.5)] {
        cutting.insert(key.into(), value.into());
    }
    Ok(machine)
}

/// M20 by 2 as a sharp tool cuts it, 110 mm long, at the speed that is named: a swing takes some tens of
/// turns to grow.
fn program(machine: &Machine, varied: bool) -> String {
    let how = match strongest(machine, NAMED_RPM).filter(|_| varied) {
        None => "off".into(),
        Some(variation) => format!("sine, {:.1}, {:.1}", 100.0 * variation.share, variation.revolutions),
    };
    format!(
        "G18 G21 G90 G8 G94 G97\n(speed_variation, {how})\nM3 S{NAMED_RPM}\nG0 X12 Z8\n\
         G76 P2 Z-110 I-2 J0.5 K1.9 R2\nG0 X14\nM5\nM2\n"
    )
}

/// Both threads.
pub(super) fn threads(stand: &Stand) -> Result<Vec<Thread>, ExperimentError> {
    let machine = in_steel(&stand.machine)?;
    stand.each(&[false, true], |varied| thread(&machine, *varied, stand.seed))
}

fn thread(machine: &Machine, varied: bool, seed: u64) -> Result<Thread, ExperimentError> {
    let failed = |reason: String| ExperimentError::Machine(format!("the thread was not cut: {reason}"));
    let check = interpreter::check("chatter.ngc", &program(machine, varied), machine);
    let (mut courses, mut cutting, mut begins) = (Vec::new(), false, 0.0);
    let seen = Stand::observed(machine, &check, seed, &failed, |record, _| {
        let cuts = record.axes.iter().all(|(_, status)| status.state() == AxisState::Locked);
        if cuts && !cutting {
            begins = record.truth.spindle_deg;
            courses.push(Vec::new());
        }
        cutting = cuts;
        if let (true, Some(course)) = (cuts && record.truth.cycle.0.is_multiple_of(EVERY), courses.last_mut())
        {
            let turns = (record.truth.spindle_deg - begins).abs() / 360.0;
            course.push((turns, 1e3 * record.truth.axes[protocol::Axis::X.index()].slide_mm));
        }
    })?;
    let tan = libm::tan(30_f64.to_radians());
    let mut before = 0.0;
    let depths = check.passes.iter().map(|note| note.depth_mm.unwrap_or(0.0));
    let passes: Vec<[f64; 3]> = depths
        .zip(&seen.passes)
        .map(|(depth, pass)| {
            let width = tan * (depth + std::mem::replace(&mut before, depth));
            [depth, width, pass.tool.x_max_um - pass.tool.x_min_um]
        })
        .collect();
    let most = (0..passes.len()).max_by(|a, b| passes[*a][2].total_cmp(&passes[*b][2])).unwrap_or(0);
    let mut course = courses.into_iter().nth(most).unwrap_or_default();
    let mean = course.iter().map(|(_, um)| um).sum::<f64>() / course.len().max(1) as f64;
    course.iter_mut().for_each(|(_, um)| *um -= mean);
    Ok(Thread { varied, passes, course })
}
