//! The law of one pass: from geometry and limits to windows of spindle angle. In: a [`Cut`] in mm and 1/min,
//! the machine. Out: a [`ThreadPass`], angles in degrees since the index; or the reason why there is none.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | S, F | 1/min, mm/rev | programmed speed, lead along the thread axis (signed) |
//! | R | – | actual over programmed speed that the windows are laid out for, ≥ 1; more where it is varied |
//! | q = 6 S R | deg/s | spindle angle per second at that speed (M1) |
//! | T | s | duration of a ramp or stroke at that speed |
//! | ΔC = q T | deg | its window |
//! | c | deg | angle from where the helix goes through the start point; C = c + 360 k |
//!
//! ```text
//! run-in  T from Ramp::fastest(R V) (M21);  window  -ΔC/2 … ΔC/2:  z = F c/360 after it  (M14, phase rule)
//! approach   T from Stroke::shortest (M7);     ends with the run-in, with its way back from beyond (M132)
//! brake      T as the run-in;                  within: centred on c_end = 360 L/F, so that it ends at L
//! retract    T as the approach;                begins before the brake by the delay of flank.rs
//! both       take FEWEST_COUNTS of the encoder at least, which binds at a few 1/min
//! beyond     the retract begins at c_end, the brake after the delay
//! k  the least number of turns that puts every window the machine's margin after the index;
//!    a start angle is added
//! ```

use machine::{Machine, RunOut};
use motion::{Limits, Ramp, Stroke};
use protocol::{Axis, AxisLaw, Position, ThreadPass, WayOut};

use super::cut::Cut;
use super::flank::{largest, least_delay};
use super::refusal::Refusal;

/// Share of an axis' speed that a thread leaves free at 100 % override, for the ripple of the spindle (M8).
const VELOCITY_RESERVE: f64 = 0.02;

/// Counts of the spindle encoder that a stroke takes at least: made within a few, it would be a jump.
const FEWEST_COUNTS: f64 = 100.0;

/// A pass and what a user wants to know about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// The pass; its number and start are 0.
    pub pass: ThreadPass,
    /// Where full depth begins and where it ends along the thread, mm.
    pub full_depth_mm: [f64; 2],
    /// Way along the thread while the lead is reached, and while it is left, mm.
    pub delta_mm: [f64; 2],
}

/// What the tool keeps away from the crest before Z may brake, a share of the depth, and of the way out.
const FREE_SHARE: f64 = 0.05;
/// No groove is deeper than so many leads.
const DEEPEST_LEADS: f64 = 1.3;

/// Share of its speed that a stroke has at least, however fast its axis follows a tapered helix.
const LEAST_STROKE: f64 = 0.05;

/// A window of spindle angle.
#[derive(Clone, Copy, Debug)]
struct Span {
    c: f64,
    dc: f64,
}

impl Span {
    fn end(self) -> f64 {
        self.c + self.dc
    }
}

/// The parts of a pass, angles from the start point of the helix.
#[derive(Clone, Copy, Debug)]
struct Windows {
    approach: Span,
    /// What of the approach is its way back from beyond, mm and degrees.
    unload: (f64, f64),
    run_in: Span,
    brake: Span,
    retract: Span,
    /// Full depth on the helix begins here.
    locked: f64,
    /// Full depth ends here.
    thread_end: f64,
}

/// What the windows are laid out with.
struct Design {
    /// q = 6 S R, deg/s.
    q: f64,
    /// Ramps along the path at that speed.
    run_in: Ramp,
    brake: Ramp,
    /// What strokes may use.
    approach_limits: Limits,
    retract_limits: Limits,
    /// Narrowest window of a stroke, degrees.
    least_stroke_deg: f64,
    /// Share of the limits that a law may use.
    share: f64,
}

/// Lays out a cut on a machine.
///
/// # Errors
/// [`Refusal`] if the limits of the machine or the length of the thread leave no law.
///
/// # Panics
/// If the machine has no X or Z, the speed is not positive, or the cut has no lead along the thread.
pub fn plan(cut: &Cut, machine: &Machine) -> Result<Plan, Refusal> {
    assert!(cut.s_rpm > 0.0 && cut.lead_mm() != 0.0, "a cut has a speed and a lead");
    let axes = [cut.along.lifts(), cut.along.axis()];
    let [lift, along] = axes.map(|axis| axis_limits(machine, axis));
    for (axis, lead, limit) in [(axes[0], cut.rise_mm(), lift.v), (axes[1], cut.lead_mm(), along.v)] {
        let v = lead.abs() * cut.s_rpm / 60.0;
        let limit = limit * (1.0 - VELOCITY_RESERVE);
        if v > limit {
            return Err(Refusal::TooFast { axis, needs_mm_s: v, limit_mm_s: limit });
        }
    }
    let design = Design::new(cut, machine, lift, along);
    let windows = windows(cut, machine, &design)?;
    let earliest = windows.run_in.c.min(windows.approach.c);
    let margin = design.q * machine.index_margin_cycles() * machine.general.cycle_s;
    let turn = cut.start_deg + 360.0 * ((margin - earliest - cut.start_deg) / 360.0).ceil().max(0.0);
    let pass = pass(cut, machine, &windows, &design, turn, [lift, along])?;
    for axis in axes {
        let end = pass.axis(axis).end.mm();
        let [low, high] = travel(machine, axis);
        if !(low..=high).contains(&end) {
            return Err(Refusal::Travel { axis, at_mm: end });
        }
    }
    pass.check().map_err(|refused| Refusal::Extreme { refused })?;
    let on_helix = |c: f64| cut.starts_mm() + cut.lead_mm() * c / 360.0;
    let half_way = |window: Span| cut.lead_mm().abs() * window.dc / 720.0;
    Ok(Plan {
        pass,
        full_depth_mm: [on_helix(windows.locked), on_helix(windows.thread_end)],
        delta_mm: [half_way(windows.run_in), half_way(windows.brake)],
    })
}

impl Design {
    fn new(cut: &Cut, machine: &Machine, lift: Limits, along: Limits) -> Design {
        let share = machine.threading.limit_share_pct / 100.0;
        let (lift, along) = (lift.share(share), along.share(share));
        // On a tapered helix strokes of the axis that lifts add to its run-in and its braking: each gets its
        // part of the limits.
        let shared = |stroke_mm: f64| cut.rise_mm() != 0.0 && stroke_mm != 0.0;
        let of_path =
            |stroke_mm| path_limits(cut, if shared(stroke_mm) { lift.share(0.5) } else { lift }, along);
        let (in_limits, out_limits) = (of_path(cut.approach_mm), of_path(cut.retract_mm));
        let v = libm::hypot(cut.rise_mm(), cut.lead_mm()) * cut.s_rpm / 60.0;
        let top = in_limits.v.min(out_limits.v);
        let asked = cut.top_share * machine.threading.design_override_pct / 100.0;
        let ratio = asked.min(top / v).max(1.0);
        let stroke_limits = |stroke_mm| {
            if !shared(stroke_mm) {
                return lift;
            }
            let left = lift.v - ratio * cut.rise_mm().abs() * cut.s_rpm / 60.0;
            Limits { v: left.max(LEAST_STROKE * lift.v), ..lift.share(0.5) }
        };
        Design {
            q: 6.0 * cut.s_rpm * ratio,
            run_in: Ramp::fastest(ratio * v, &in_limits),
            brake: Ramp::fastest(ratio * v, &out_limits),
            approach_limits: stroke_limits(cut.approach_mm),
            retract_limits: stroke_limits(cut.retract_mm),
            least_stroke_deg: 360.0 * FEWEST_COUNTS / machine.spindle_counts(),
            share,
        }
    }

    /// The narrowest window of a stroke, degrees; 0 for none.
    fn stroke_deg(&self, stroke_mm: f64, limits: &Limits) -> f64 {
        if stroke_mm == 0.0 {
            return 0.0;
        }
        (self.q * Stroke::shortest(stroke_mm, limits)).max(self.least_stroke_deg)
    }

    /// The brake as the axis along the thread makes it, at the design speed.
    fn axial_brake(&self, cut: &Cut) -> Ramp {
        let share = cut.lead_mm().abs() / libm::hypot(cut.rise_mm(), cut.lead_mm());
        Ramp::new(self.brake.dv() * share, self.brake.duration(), self.brake.lambda())
    }
}

fn windows(cut: &Cut, machine: &Machine, design: &Design) -> Result<Windows, Refusal> {
    let run_in_dc = design.q * design.run_in.duration();
    let run_in = Span { c: -0.5 * run_in_dc, dc: run_in_dc };
    let unload = unload(cut, machine, design);
    let approach = approach(cut, design, unload, run_in.end())?;
    let locked = run_in.end().max(approach.end());

    let retract_dc = retract_window(cut, design)?;
    let exit = cut.exit.map_or(0.0, |taper| angle(cut, taper.length_mm));
    let delay = if cut.retract_mm == 0.0 {
        0.0
    } else {
        let retract = Stroke::new(cut.retract_mm, retract_dc / design.q);
        let tan_flank = libm::tan(machine.threading.flank_half_angle_deg.to_radians());
        let flank = least_delay(&design.axial_brake(cut), &retract, cut.clear_mm, tan_flank);
        exit.max(design.q * flank)
    };
    let length = cut.to_mm - cut.starts_mm();
    let c_end = 360.0 * length / cut.lead_mm();
    let brake_dc = design.q * design.brake.duration();
    let brake_c = match machine.threading.run_out {
        RunOut::Within => c_end - 0.5 * brake_dc,
        RunOut::Beyond => c_end - exit + delay,
    };
    let brake = Span { c: brake_c, dc: brake_dc };
    let thread_end = brake_c - delay;
    let retract = if cut.retract_mm == 0.0 { brake } else { Span { c: thread_end, dc: retract_dc } };
    if thread_end <= locked {
        let mm = |c: f64| c * cut.lead_mm().abs() / 360.0;
        return Err(Refusal::NoThread {
            run_in_mm: mm(locked),
            run_out_mm: mm(c_end - thread_end),
            length_mm: length.abs(),
        });
    }
    Ok(Windows { approach, unload, run_in, brake, retract, locked, thread_end })
}

/// How far an approach goes beyond its depth, and over which angle it comes back: in the air, so not on a
/// taper; a cone keeps the guide sliding anyway.
fn unload(cut: &Cut, machine: &Machine, design: &Design) -> (f64, f64) {
    let unload_mm = machine.axis.get(&cut.along.lifts()).map_or(0.0, |lift| lift.unload_mm);
    if unload_mm == 0.0 || cut.approach_mm == 0.0 || cut.entry.is_some() || cut.rise_mm() != 0.0 {
        return (0.0, 0.0);
    }
    (unload_mm.copysign(cut.approach_mm), design.stroke_deg(unload_mm, &design.approach_limits))
}

/// The window of the approach, ending with the run-in, or where its taper ends.
fn approach(cut: &Cut, design: &Design, unload: (f64, f64), run_in_end: f64) -> Result<Span, Refusal> {
    let stroke = cut.approach_mm.abs();
    let (unload_mm, unload_dc) = unload;
    let least = design.stroke_deg(stroke + unload_mm.abs(), &design.approach_limits) + unload_dc;
    let Some(taper) = cut.entry else { return Ok(Span { c: run_in_end - least, dc: least }) };
    // The last `height` of the stroke lies on the taper: the share of the window it takes, by symmetry of the
    // law.
    let share = time_of(taper.height_mm / stroke);
    let taper_dc = angle(cut, taper.length_mm);
    if taper_dc < least * share {
        return Err(Refusal::EntryTaper { least_mm: least * share * cut.lead_mm().abs() / 360.0 });
    }
    let dc = taper_dc / share;
    Ok(Span { c: run_in_end.max(taper_dc) - dc, dc })
}

/// The window of the retract, stretched so that its first part makes the taper at the end.
fn retract_window(cut: &Cut, design: &Design) -> Result<f64, Refusal> {
    let stroke = cut.retract_mm.abs();
    let least = design.stroke_deg(stroke, &design.retract_limits);
    let Some(taper) = cut.exit else { return Ok(least) };
    let share = time_of(taper.height_mm / stroke);
    let taper_dc = angle(cut, taper.length_mm);
    if taper_dc < least * share {
        return Err(Refusal::ExitTaper { least_mm: least * share * cut.lead_mm().abs() / 360.0 });
    }
    Ok(taper_dc / share)
}

/// Spindle angle in which the helix advances by a length in mm.
fn angle(cut: &Cut, length_mm: f64) -> f64 {
    360.0 * length_mm / cut.lead_mm().abs()
}

/// Share of its duration in which a stroke (M2) makes the given share of its way; 1 from the whole way on.
fn time_of(way: f64) -> f64 {
    let unit = Stroke::new(1.0, 1.0);
    largest(1.0, |share| unit.at(share).s <= way)
}

/// The packet. `turn` is the angle from the index to the start point of the helix: whole turns and the start
/// angle.
fn pass(
    cut: &Cut,
    machine: &Machine,
    windows: &Windows,
    design: &Design,
    turn: f64,
    limits: [Limits; 2],
) -> Result<ThreadPass, Refusal> {
    let Windows { approach, unload, run_in, brake, retract, thread_end, .. } = *windows;
    let lead = |lead_mm: f64| AxisLaw {
        lead_mm,
        run_in_c0_deg: run_in.c + turn,
        run_in_dc_deg: run_in.dc,
        run_in_lambda: design.run_in.lambda(),
        brake_c_deg: brake.c + turn,
        brake_dc_deg: brake.dc,
        brake_lambda: design.brake.lambda(),
        retract_c_deg: brake.c + turn,
        retract_dc_deg: brake.dc,
        ..AxisLaw::default()
    };
    let mut x = AxisLaw {
        retract_mm: cut.retract_mm,
        retract_c_deg: retract.c + turn,
        retract_dc_deg: retract.dc,
        ..if cut.rise_mm() == 0.0 { AxisLaw::default() } else { lead(cut.rise_mm()) }
    };
    if cut.approach_mm != 0.0 {
        x.stroke_mm = cut.approach_mm;
        x.stroke_c0_deg = approach.c + turn;
        x.stroke_dc_deg = approach.dc;
        (x.unload_mm, x.unload_dc_deg) = unload;
    }
    let mut pass = ThreadPass {
        out: out(cut, machine),
        s_rpm: cut.s_rpm,
        direction: cut.direction,
        start_angle_deg: cut.start_deg,
        lead_mm: cut.lead_mm(),
        thread_end_deg: thread_end + turn,
        depth_mm: cut.depth_mm,
        max_ratio: f64::INFINITY,
        ..ThreadPass::default()
    };
    let axes =
        [(cut.along.lifts(), x, cut.above_mm()), (cut.along.axis(), lead(cut.lead_mm()), cut.starts_mm())];
    for ((axis, mut law, from), limits) in axes.into_iter().zip(limits) {
        law.check().map_err(|refused| Refusal::Extreme { refused })?;
        let moves = law.law(cut.s_rpm);
        law.start = Position::from_mm(from);
        law.end = Position(law.start.0 + Position::from_mm(moves.at(law.done_deg()).s).0);
        // A law laid out for its very limits may miss ratio 1 by a rounding.
        let ratio = limits.top_ratio(&moves.peak());
        if ratio < 1.0 - 1e-9 {
            return Err(Refusal::TooFast { axis, needs_mm_s: moves.peak().v, limit_mm_s: limits.v });
        }
        // What is promised leaves a margin for changes of the spindle's speed (M8).
        let promised = limits.share(design.share).top_ratio(&moves.peak());
        pass.max_ratio = pass.max_ratio.min(promised.max(1.0));
        pass.axes[axis.index()] = law;
    }
    Ok(pass)
}

/// The way out: to where the retract leads, else to where the approach came from, else to where the program
/// goes next, else off by the lift of the machine file.
fn out(cut: &Cut, machine: &Machine) -> WayOut {
    let surface = cut.above_mm() + cut.approach_mm;
    let slope = cut.rise_mm() / cut.lead_mm();
    let surfaces = [surface, surface + slope * (cut.to_mm - cut.starts_mm())];
    let lift = match (cut.retract_mm, cut.approach_mm) {
        (0.0, 0.0) if cut.lift_mm != 0.0 => cut.lift_mm,
        (0.0, 0.0) => machine.threading.lift_mm * cut.outwards,
        (0.0, approach_mm) => -approach_mm,
        (retract_mm, _) => retract_mm,
    };
    let outermost = |[one, other]: [f64; 2]| if lift > 0.0 { one.max(other) } else { one.min(other) };
    let clear = match (cut.retract_mm, cut.lift_mm) {
        (0.0, 0.0) => outermost(surfaces) + lift,
        _ => surfaces[1] + lift,
    };
    let [low, high] = travel(machine, cut.along.lifts());
    let clear = clear.clamp(low, high);
    let groove = if cut.clear_mm > 0.0 { cut.clear_mm } else { DEEPEST_LEADS * cut.lead_mm().abs() };
    let most = (clear - outermost(surfaces)).abs() * (1.0 - FREE_SHARE);
    let free = outermost(surfaces) + (groove * (1.0 + FREE_SHARE)).min(most).copysign(lift);
    WayOut {
        axis: cut.along.lifts().index() as u32,
        leaves: machine.threading.leaves(),
        clear: Position::from_mm(clear),
        free: Position::from_mm(free),
    }
}

/// Limits of an axis as the machine file states them.
fn axis_limits(machine: &Machine, axis: Axis) -> Limits {
    machine.axis.get(&axis).expect("a checked machine has X and Z").limits()
}

fn travel(machine: &Machine, axis: Axis) -> [f64; 2] {
    machine.axis.get(&axis).expect("a checked machine has X and Z").travel_mm
}

/// Limits of the path in the direction of the lead: what both axes can do together.
fn path_limits(cut: &Cut, lift: Limits, along: Limits) -> Limits {
    let (rise, lead) = (cut.rise_mm().abs(), cut.lead_mm().abs());
    let path = libm::hypot(rise, lead);
    let bound = |lift: f64, along: f64| {
        let of_lift = if rise == 0.0 { f64::INFINITY } else { lift * path / rise };
        of_lift.min(along * path / lead)
    };
    Limits {
        v: bound(lift.v, along.v),
        a: bound(lift.a, along.a),
        j: bound(lift.j, along.j),
        dj: bound(lift.dj, along.dj),
    }
}
