//! The law of a tap: in along the helix, through the reversal of the spindle, and out again. In: a [`Tap`] in
//! mm and 1/min, the machine. Out: a pass that returns, angles in degrees since the index; or why there is
//! none.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | S, F | 1/min, mm/rev | programmed speed, lead |
//! | R | – | actual over programmed speed that the run-in is laid out for: the highest override, or the factor of the way out if that is more |
//! | ΔC | deg | window of the run-in, as of a thread (`thread/plan.rs`) |
//! | L, L_m | mm | from the start to the depth, and to the end of the travel |
//!
//! ```text
//! run-in   −ΔC/2 … ΔC/2 about the angle at which the helix goes through the start          (M14, phase rule)
//! depth    360 L/F;  the spindle turns round there
//! brake    360 L_m/F − ΔC/2: a spindle that does not obey takes the tool along its helix as far as Z goes
//! S R_max  at most what comes to rest between run-in and depth                                      (M211)
//! ```
//! The way out is the way in: the law is one of the angle. So passes of one start point follow one helix, and
//! a tap that pecks finds its thread again.

use gcode::Problem;
use gcode::canon::Units;
use gcode::problem::{Blame, short};
use machine::{LONGEST_ON_A_LATHE_S, Machine};
use motion::Ramp;
use protocol::{Axis, AxisLaw, PerAxis, Position, ThreadPass, WayOut};

use crate::reach::{missing, within_travel};
use crate::thread::{VELOCITY_RESERVE, highest_of_tap};

/// Highest and lowest factor of the way out.
const RETURNS: [f64; 2] = [0.1, 10.0];

/// A tap, as the program means it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tap {
    /// S: programmed spindle speed, 1/min, positive.
    pub(crate) s_rpm: f64,
    /// +1 clockwise, -1 counterclockwise, on the way in.
    pub(crate) direction: f64,
    /// Of the program.
    pub(crate) units: Units,
    /// Where the tool rests before and after it: Z, mm.
    pub(crate) from_mm: f64,
    /// Depth: Z, mm.
    pub(crate) to_mm: f64,
    /// Advance per revolution, mm, positive.
    pub(crate) lead_mm: f64,
    /// Speed of the way out, as a multiple of S.
    pub(crate) return_ratio: f64,
    /// How long the spindle stands at the depth, s.
    pub(crate) dwell_s: f64,
    /// What makes the tool leave ([`WayOut::leaves`]).
    pub(crate) leaves: u32,
}

/// What a user wants to know about a tap before it is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TapNote {
    /// How far in front of the depth the spindle begins to brake, at programmed speed, mm.
    pub brakes_mm: f64,
    /// Highest speed from which the spindle comes to rest in time, at most that of the machine, 1/min.
    pub top_rpm: f64,
    /// Speed of the way out, as a multiple of S.
    pub return_ratio: f64,
    /// From the index until the tool is back, at programmed speed, s.
    pub seconds: f64,
}

/// A tap that is laid out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Planned {
    pub(crate) pass: ThreadPass,
    pub(crate) note: TapNote,
    /// From where on Z is on the helix, mm; way of the run-in, mm.
    pub(crate) on_helix_mm: f64,
    pub(crate) run_in_mm: f64,
}

impl Tap {
    fn lead_mm(&self) -> f64 {
        self.lead_mm.copysign(self.to_mm - self.from_mm)
    }
}

/// Lays out a tap on a machine whose axes rest at `rest` but for Z.
///
/// # Errors
/// Says what is too fast, too short or out of travel, and the highest speed that would do.
pub(crate) fn plan(tap: &Tap, rest: &PerAxis<Position>, machine: &Machine) -> Result<Planned, Box<Problem>> {
    can_tap(machine)?;
    within_travel(machine, Axis::Z, tap.from_mm, Blame::Block)?;
    within_travel(machine, Axis::Z, tap.to_mm, Blame::Word('Z'))?;
    let (law, ratio) = law(tap, machine).map_err(|why| why.problem(tap, machine))?;
    let mut pass = ThreadPass {
        s_rpm: tap.s_rpm,
        direction: tap.direction,
        lead_mm: law.lead_mm,
        thread_end_deg: middle(&law) + 360.0 * (tap.to_mm - tap.from_mm) / law.lead_mm,
        max_ratio: ratio,
        return_ratio: tap.return_ratio,
        dwell_s: tap.dwell_s,
        out: WayOut {
            axis: Axis::Z.index() as u32,
            leaves: tap.leaves | WayOut::RETURNS,
            clear: law.start,
            free: Position::from_mm(tap.from_mm + law.lead_mm * law.run_in_dc_deg / 720.0),
        },
        ..ThreadPass::default()
    };
    for (axis, _) in machine.axes() {
        let at = rest[axis.index()];
        pass.axes[axis.index()] = match axis {
            Axis::Z => law,
            _ => AxisLaw { start: at, end: at, lead_mm: 0.0, ..law },
        };
    }
    pass.check().map_err(|refused| extreme(&refused.to_string()))?;
    let run_in_mm = law.lead_mm.abs() * law.run_in_dc_deg / 720.0;
    Ok(Planned {
        note: TapNote {
            brakes_mm: law.lead_mm.abs() * machine.tap_stop_deg(tap.s_rpm) / 360.0,
            top_rpm: top_rpm(tap, &law, machine).min(machine.spindle.max_rpm),
            return_ratio: tap.return_ratio,
            seconds: machine.tap_s(&pass),
        },
        on_helix_mm: pass.out.free.mm(),
        run_in_mm,
        pass,
    })
}

/// Refuses a machine that has nothing to tap with.
fn can_tap(machine: &Machine) -> Result<(), Box<Problem>> {
    if machine.spindle.is_none() {
        return Err(missing("rigid tapping", "a machine that taps has a [spindle] with an encoder"));
    }
    if machine.general.interpolator_cycle_s > LONGEST_ON_A_LATHE_S {
        let help = format!(
            "machine.interpolator_cycle_s is {}: at most {LONGEST_ON_A_LATHE_S} lets it tap",
            machine.general.interpolator_cycle_s
        );
        return Err(missing("rigid tapping", &help));
    }
    Ok(())
}

/// Why a tap has no law.
enum Refusal {
    /// Z would have to be faster than it can, mm/s, at so many times S.
    TooFast { needs_mm_s: f64, limit_mm_s: f64, ratio: f64 },
    /// The run-in is longer than the tap, or ends beyond the travel, mm.
    TooShort { run_in_mm: f64 },
    /// The spindle needs more turns to stop than there are; the highest speed for which they do.
    NoStop { needs: f64, has: f64 },
    /// The way out would be faster than the spindle.
    Return,
}

/// The law of Z, and the highest ratio.
fn law(tap: &Tap, machine: &Machine) -> Result<(AxisLaw, f64), Refusal> {
    let Some(axis) = machine.axis.get(&Axis::Z) else {
        return Err(Refusal::TooFast { needs_mm_s: 0.0, limit_mm_s: 0.0, ratio: 1.0 });
    };
    let (limits, lead_mm) = (axis.limits(), tap.lead_mm());
    if tap.s_rpm * tap.return_ratio > machine.spindle.max_rpm {
        return Err(Refusal::Return);
    }
    let share = machine.threading.limit_share_pct / 100.0;
    let v = lead_mm.abs() * tap.s_rpm / 60.0;
    let limit_mm_s = limits.v * (1.0 - VELOCITY_RESERVE);
    let least = tap.return_ratio.max(1.0);
    if v * least > limit_mm_s {
        return Err(Refusal::TooFast { needs_mm_s: v * least, limit_mm_s, ratio: least });
    }
    let wanted = (machine.threading.design_override_pct / 100.0).max(least);
    let ratio = wanted.min(limits.v * share / v).max(least);
    let q = 6.0 * tap.s_rpm * ratio;
    let ramp = Ramp::fastest(ratio * v, &limits.share(share));
    let run_in_dc_deg = q * ramp.duration();
    let margin = q * machine.index_margin_cycles() * machine.general.cycle_s;
    let turn = 360.0 * ((margin + 0.5 * run_in_dc_deg) / 360.0).ceil();
    let end_mm = if lead_mm > 0.0 { axis.travel_mm[1] } else { axis.travel_mm[0] };
    let last_deg = turn + 360.0 * (end_mm - tap.from_mm) / lead_mm - 1e-6;
    let mut law = AxisLaw {
        start: Position::from_mm(tap.from_mm),
        end: Position::from_mm(tap.from_mm),
        lead_mm,
        run_in_c0_deg: turn - 0.5 * run_in_dc_deg,
        run_in_dc_deg,
        run_in_lambda: ramp.lambda(),
        brake_c_deg: last_deg - 0.5 * run_in_dc_deg,
        brake_dc_deg: run_in_dc_deg,
        brake_lambda: ramp.lambda(),
        ..AxisLaw::default()
    };
    (law.retract_c_deg, law.retract_dc_deg) = (law.brake_c_deg, law.brake_dc_deg);
    let depth_deg = turn + 360.0 * (tap.to_mm - tap.from_mm) / lead_mm;
    if depth_deg <= law.run_in_c0_deg + run_in_dc_deg || law.brake_c_deg < depth_deg {
        return Err(Refusal::TooShort { run_in_mm: lead_mm.abs() * run_in_dc_deg / 720.0 });
    }
    let top = top_rpm(tap, &law, machine);
    if top < tap.s_rpm {
        let has = (depth_deg - law.run_in_c0_deg) / 360.0;
        return Err(Refusal::NoStop { needs: machine.tap_stop_deg(tap.s_rpm) / 360.0, has });
    }
    let axes = limits.share(share).top_ratio(&law.law(tap.s_rpm).peak()).max(1.0);
    Ok((law, axes.min(top / tap.s_rpm)))
}

/// Angle at which the helix goes through the start, degrees since the index.
fn middle(law: &AxisLaw) -> f64 {
    law.run_in_c0_deg + 0.5 * law.run_in_dc_deg
}

/// The highest speed for which a law leaves room to stop, 1/min (M211).
fn top_rpm(tap: &Tap, law: &AxisLaw, machine: &Machine) -> f64 {
    let depth_deg = 360.0 * (tap.to_mm - tap.from_mm) / law.lead_mm;
    machine.tap_top_rpm(depth_deg + 0.5 * law.run_in_dc_deg)
}

impl Refusal {
    fn problem(self, tap: &Tap, machine: &Machine) -> Box<Problem> {
        let (units, s) = (tap.units, short(tap.s_rpm));
        let possible = |s_rpm: f64| law(&Tap { s_rpm, ..*tap }, machine).is_ok();
        let slower = match highest_of_tap(tap.s_rpm, possible) {
            Some(rpm) => format!("the highest spindle speed that would do is S{}", short(rpm)),
            None => "no spindle speed would do".to_owned(),
        };
        let (message, help) = match self {
            Refusal::TooFast { needs_mm_s, limit_mm_s, ratio } => {
                let out = if ratio > 1.0 {
                    format!(" on the way out, {} times as fast", short(ratio))
                } else {
                    String::new()
                };
                let (needs, limit) = (units.length(needs_mm_s), short(limit_mm_s / units.mm()));
                (format!("at S{s} the tap needs {needs}/s of Z{out}, which can do {limit}"), slower)
            }
            Refusal::TooShort { run_in_mm } => {
                let (run_in, has) = (units.length(run_in_mm), units.length((tap.to_mm - tap.from_mm).abs()));
                let message = format!(
                    "at S{s} Z takes {run_in} on either side until it is on the helix, and {has} lie between start \
                     and depth"
                );
                (message, format!("{slower}; or start farther away, or away from the end of the travel"))
            }
            Refusal::NoStop { needs, has } => {
                let message = format!(
                    "at S{s} the spindle needs {needs:.1} turns to stop, and there are {has:.1} from the start to the \
                     depth"
                );
                (
                    message,
                    format!(
                        "{slower}; a start farther away, or a spindle with a steeper ramp_rpm_s, would help too"
                    ),
                )
            }
            Refusal::Return => {
                let message = format!(
                    "the way out, {} times S{s}, is faster than the spindle: {} 1/min (spindle.max_rpm)",
                    short(tap.return_ratio),
                    short(machine.spindle.max_rpm)
                );
                (message, "give a smaller factor of the way out, or a lower S".to_owned())
            }
        };
        Problem::error("tap-not-feasible", Blame::Block, message, help)
    }
}

/// Refuses a factor of the way out that no tap has; `letter` is its word.
///
/// # Errors
/// It does not lie between 0.1 and 10.
pub(crate) fn return_ratio(ratio: f64, letter: char) -> Result<f64, Box<Problem>> {
    let [low, high] = RETURNS;
    if (low..=high).contains(&ratio) {
        return Ok(ratio);
    }
    let message = format!("the way out cannot be {} times as fast as the way in", short(ratio));
    let help = format!("give a factor from {low} to {high}");
    Err(Problem::error("bad-value", Blame::Word(letter), message, help))
}

fn extreme(why: &str) -> Box<Problem> {
    let message = format!("the tap is beyond what a regulator takes: {why}");
    Problem::error(
        "tap-not-feasible",
        Blame::Block,
        message,
        "use a lead, a speed and a depth that a machine can have",
    )
}
