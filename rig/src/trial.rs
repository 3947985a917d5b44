//! The stand for trial passes: machine code for passes whose window of spindle angle is given, and the
//! machine that runs it. In: S in 1/min, ΔX in mm, ΔC in degrees, lead in mm, length of the thread in turns.
//! Out: the items of a program, and what the observer of the truth saw of it.
//!
//! A part program says what to cut, and its windows follow from the limits of the machine. A trial says the
//! window itself, as experiments do.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | S, F | 1/min, mm/rev | programmed speed, signed lead of Z |
//! | R | – | actual over programmed speed that the ramps of Z are laid out for: the design override |
//! | q = 6 S R | deg/s | spindle angle per second at that speed (M1) |
//! | T | s | duration of a ramp of Z: `Ramp::fastest(R F S/60)` (M21) |
//!
//! ```text
//! X:  approach over ΔC (M2), rest, retract over ΔC
//! Z:  run-in over q T (M13), lead (M14), brake over q T (M15)
//! approach and run-in end at the same angle; retract and brake begin at the same angle
//! ```

use machine::Machine;
use motion::{Limits, Ramp};
use protocol::{Axis, AxisLaw, Code, Feed, Item, Position, SpindleMode, SpindleSpeed, ThreadPass, WayOut};
use sim_plant::{PlantError, Scenario};

use crate::{
    Rig,
    observe::{Observation, Observer, PassReport, Record},
};

/// One pass, X moving to depth while the spindle turns by a given angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trial {
    /// S: programmed speed, 1/min, positive.
    pub s_rpm: f64,
    /// +1 for M3, −1 for M4.
    pub direction: f64,
    /// ΔX: signed stroke of X, mm; 0 for none.
    pub delta_x_mm: f64,
    /// ΔC: angle over which the stroke is made, degrees, positive.
    pub delta_c_deg: f64,
    /// Signed advance of Z per revolution, mm; 0 leaves Z at rest.
    pub lead_mm: f64,
    /// How far the spindle turns between run-in and run-out, revolutions, not negative.
    pub turns: f64,
}

impl Default for Trial {
    /// The pass of the published experiment: 300 1/min, 5 mm in one turn; then six turns of a thread with a
    /// lead of 5 mm, into which the approach has long died away.
    fn default() -> Self {
        Trial { s_rpm: 300.0, direction: 1.0, delta_x_mm: 5.0, delta_c_deg: 360.0, lead_mm: -5.0, turns: 6.0 }
    }
}

/// Why there is no machine code for a trial.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TrialError {
    /// The machine lacks an axis.
    #[error("a trial pass needs an axis {axis}: add [axis.{name}] to the machine file", name = axis.name())]
    NoAxis {
        /// Which.
        axis: Axis,
    },
    /// A number of the trial is out of range.
    #[error("a trial pass cannot have {name} = {value}")]
    Value {
        /// The field of [`Trial`].
        name: &'static str,
        /// What it was given.
        value: f64,
    },
    /// The way does not fit into the travel of an axis.
    #[error(
        "a trial pass would need {needed_mm:.3} mm of {axis}, which has {travel_mm:.3} mm: reduce the stroke, the lead \
         or the number of turns"
    )]
    Travel {
        /// Which axis.
        axis: Axis,
        /// Length of the way, mm.
        needed_mm: f64,
        /// Length of the travel, mm.
        travel_mm: f64,
    },
    /// Beyond the limits of an axis.
    #[error(
        "{axis} can follow a trial pass only up to {most_pct:.1} % of its spindle speed: lower the speed or the stroke, \
         or give it a wider angle"
    )]
    TooFast {
        /// Which axis.
        axis: Axis,
        /// Share of the spindle speed that it could follow, per cent.
        most_pct: f64,
    },
}

/// A whole program: for each trial the spindle at its speed, the axes at its start, and its pass; then the
/// end. Passes are numbered from 1, lines as well. A trial begins at the home of the machine, or as near to
/// it as its way allows.
///
/// # Errors
/// [`TrialError`] if a number of a trial is out of range, or the machine cannot follow it at the programmed
/// speed.
pub fn program(machine: &Machine, trials: &[Trial]) -> Result<Vec<Item>, TrialError> {
    let mut codes = Vec::with_capacity(3 * trials.len() + 2);
    for (trial, number) in trials.iter().zip(1..) {
        let pass = trial.pass(machine, number)?;
        let mode = if trial.direction > 0.0 { SpindleMode::Clockwise } else { SpindleMode::Counterclockwise };
        let mut target = machine.home();
        machine.axes().for_each(|(axis, _)| target[axis.index()] = pass.axis(axis).start);
        codes.push(Code::Spindle { mode, speed: SpindleSpeed::Rpm(trial.s_rpm) });
        codes.push(Code::Line { target, feed: Feed::Rapid });
        codes.push(Code::Pass(pass));
    }
    codes.push(Code::Spindle { mode: SpindleMode::Stop, speed: SpindleSpeed::Rpm(0.0) });
    codes.push(Code::End);
    Ok((1..).zip(codes).map(|(line, code)| Item { line, code }).collect())
}

/// Runs a program on a machine to its end; `see` is shown every control cycle.
///
/// # Errors
/// [`PlantError`] if the truth about the plant cannot be.
pub fn run(
    machine: &Machine,
    items: &[Item],
    scenario: &Scenario,
    seed: u64,
    see: &mut impl FnMut(&Record),
) -> Result<Observation, PlantError> {
    run_for(u64::MAX, machine, items, scenario, seed, see)
}

/// As [`run`], but for `cycles` control cycles at most: an axis that swings is never in position, and its
/// program never ends.
///
/// # Errors
/// As [`run`].
pub fn run_for(
    cycles: u64,
    machine: &Machine,
    items: &[Item],
    scenario: &Scenario,
    seed: u64,
    see: &mut impl FnMut(&Record),
) -> Result<Observation, PlantError> {
    let mut rig = Rig::new(machine, items.iter().copied(), scenario.clone(), seed)?;
    let mut observer = Observer::new(machine, items);
    for _ in 0..cycles {
        let goes_on = rig.cycle(None, |record| {
            observer.cycle(record);
            see(record);
        });
        if !goes_on {
            break;
        }
    }
    Ok(observer.finish())
}

/// The override at which a pass was cut, per cent: where the knob stood, or the most that the machine allows
/// or can follow. For a knob that stood still.
pub fn in_force_pct(machine: &Machine, pass: &PassReport) -> f64 {
    pass.override_max_pct.min(machine.spindle.override_max_pct).min(pass.max_feasible_override_pct)
}

impl Trial {
    /// The packet of this trial.
    ///
    /// # Errors
    /// As [`program`].
    pub fn pass(&self, machine: &Machine, number: u32) -> Result<ThreadPass, TrialError> {
        self.check()?;
        let design = machine.threading.design_override_pct / 100.0;
        let q = 6.0 * self.s_rpm * design;
        let z_limits = promised(machine, Axis::Z)?;
        let ramp = Ramp::fastest(design * self.lead_mm * self.s_rpm / 60.0, &z_limits);
        let (x_dc, z_dc) = (self.delta_c_deg, q * ramp.duration());
        let locked = q * machine.index_margin_cycles() * machine.general.cycle_s + x_dc.max(z_dc);
        let thread_end = locked + 360.0 * self.turns;

        let x = AxisLaw {
            stroke_mm: self.delta_x_mm,
            stroke_c0_deg: locked - x_dc,
            stroke_dc_deg: x_dc,
            retract_mm: -self.delta_x_mm,
            retract_c_deg: thread_end,
            retract_dc_deg: x_dc,
            ..AxisLaw::default()
        };
        let rest = AxisLaw { retract_c_deg: thread_end, retract_dc_deg: x_dc, ..AxisLaw::default() };
        let z = AxisLaw {
            lead_mm: self.lead_mm,
            run_in_c0_deg: locked - z_dc,
            run_in_dc_deg: z_dc,
            run_in_lambda: ramp.lambda(),
            brake_c_deg: thread_end,
            brake_dc_deg: z_dc,
            brake_lambda: ramp.lambda(),
            ..rest
        };
        let mut pass = ThreadPass {
            pass: number,
            s_rpm: self.s_rpm,
            direction: self.direction,
            // Phase rule: the helix goes through the start point in the middle of the run-in.
            start_angle_deg: (locked - 0.5 * z_dc).rem_euclid(360.0),
            lead_mm: self.lead_mm,
            thread_end_deg: thread_end,
            max_ratio: f64::INFINITY,
            ..ThreadPass::default()
        };
        for (axis, config) in machine.axes() {
            let mut law = match axis {
                Axis::X => x,
                Axis::Z => z,
                _ => rest,
            };
            let way = law.law(self.s_rpm);
            let end = way.at(law.done_deg()).s;
            law.start = start(axis, config.home_mm, config.travel_mm, law.stroke_mm, end)?;
            law.end = law.start.moved(end);
            let top = promised(machine, axis)?.top_ratio(&way.peak());
            if top < 1.0 {
                return Err(TrialError::TooFast { axis, most_pct: 100.0 * top });
            }
            pass.max_ratio = pass.max_ratio.min(top);
            pass.axes[axis.index()] = law;
        }
        pass.out = self.way_out(machine, &pass);
        Ok(pass)
    }

    /// X goes back to where it came from; one that rests lifts off.
    fn way_out(&self, machine: &Machine, pass: &ThreadPass) -> WayOut {
        let start = pass.axis(Axis::X).start;
        let (lift_mm, clear) = match self.delta_x_mm {
            0.0 => (machine.threading.lift_mm, start.moved(machine.threading.lift_mm)),
            delta_x_mm => (-delta_x_mm, start),
        };
        let leaves = machine.threading.leaves();
        WayOut { axis: Axis::X.index() as u32, leaves, clear, free: clear.moved(-0.05 * lift_mm) }
    }

    fn check(&self) -> Result<(), TrialError> {
        let good = [
            ("s_rpm", self.s_rpm, 1e-3..1e6),
            ("direction × direction", self.direction * self.direction, 1.0..1.0 + f64::EPSILON),
            ("delta_x_mm", self.delta_x_mm, -1e5..1e5),
            ("delta_c_deg", self.delta_c_deg, 1e-3..1e6),
            ("lead_mm", self.lead_mm, -1e3..1e3),
            ("turns", self.turns, 0.0..1e6),
        ];
        match good.into_iter().find(|(_, value, range)| !range.contains(value)) {
            Some((name, value, _)) => Err(TrialError::Value { name, value }),
            None => Ok(()),
        }
    }
}

/// What a law may use of the limits of an axis; the rest is for changes of the spindle's speed (M8).
fn promised(machine: &Machine, axis: Axis) -> Result<Limits, TrialError> {
    let limits = machine.axis.get(&axis).ok_or(TrialError::NoAxis { axis })?.limits();
    let share = machine.threading.limit_share_pct / 100.0;
    Ok(limits.share(share))
}

/// Where the axis begins: at home, or as near to it as a stroke and the whole way stay within its travel.
fn start(
    axis: Axis,
    home: f64,
    [low, high]: [f64; 2],
    stroke: f64,
    end: f64,
) -> Result<Position, TrialError> {
    let (least, most) = (stroke.min(end).min(0.0), stroke.max(end).max(0.0));
    if most - least > high - low {
        return Err(TrialError::Travel { axis, needed_mm: most - least, travel_mm: high - low });
    }
    // Not `clamp`: where the way just fits, rounding may put the upper bound below the lower one.
    Ok(Position::from_mm(home.min(high - most).max(low - least)))
}
