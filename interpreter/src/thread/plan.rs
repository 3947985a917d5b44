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
use protocol::{AxisLaw, Changes, Position, ThreadPass};

use super::corners::{Rounds, Windows as Corners, stops_before};
use super::cut::{Cut, Point};
use super::flank::{largest, least_delay};
use super::limits::{axis_limits, path_limits, travel};
use super::refusal::Refusal;
use super::way_out::out;

/// Share of an axis' speed that a thread leaves free at 100 % override, for the ripple of the spindle (M8).
pub(crate) const VELOCITY_RESERVE: f64 = 0.02;

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

/// Share of its limits that the change of a lead may use: a cone goes on meanwhile.
const CORNER_SHARE: f64 = 0.8;

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
    corners: Corners,
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
    rounds: Rounds,
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
    let most = cut.most_lead();
    let leads = [cut.along.across(most), cut.along.of(most)];
    for (axis, lead, limit) in [(axes[0], leads[0], lift.v), (axes[1], leads[1], along.v)] {
        let v = lead * cut.s_rpm / 60.0;
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
    let on_helix = |c: f64| cut.starts_mm() + cut.lead_mm().signum() * cut.gone_mm(c);
    let half_way = |lead: Point, window: Span| cut.along.of(lead).abs() * window.dc / 720.0;
    Ok(Plan {
        pass,
        full_depth_mm: [on_helix(windows.locked), on_helix(windows.thread_end)],
        delta_mm: [half_way(cut.lead, windows.run_in), half_way(cut.at_its_end()[0], windows.brake)],
    })
}

impl Design {
    fn new(cut: &Cut, machine: &Machine, lift: Limits, along: Limits) -> Design {
        let share = machine.threading.limit_share_pct / 100.0;
        let (lift, along) = (lift.share(share), along.share(share));
        // On a tapered helix strokes of the axis that lifts add to its run-in and its braking: each gets its
        // part of the limits.
        let [end, _] = cut.at_its_end();
        let leads = [cut.lead, end].map(|lead| [cut.along.across(lead), cut.along.of(lead)]);
        let shared = |stroke_mm: f64, rise: f64| rise != 0.0 && stroke_mm != 0.0;
        // A lead that grows from the start does so within its run-in.
        let grows = cut.chain.bends().first().is_some_and(|bend| bend.c_deg == 0.0);
        let of_path = |stroke_mm, [rise, lead]: [f64; 2], part: f64| {
            let lift = if shared(stroke_mm, rise) { lift.share(0.5) } else { lift };
            path_limits([rise, lead], lift.share(part), along.share(part))
        };
        let in_limits = of_path(cut.approach_mm, leads[0], if grows { 0.5 } else { 1.0 });
        let out_limits = of_path(cut.retract_mm, leads[1], 1.0);
        let [v, brakes] = leads.map(|[rise, lead]| libm::hypot(rise, lead) * cut.s_rpm / 60.0);
        let most = cut.most_lead();
        let most_v = [cut.along.across(most), cut.along.of(most)].map(|lead| lead * cut.s_rpm / 60.0);
        let top = match cut.chain.bends() {
            [] => in_limits.v.min(out_limits.v) / v,
            _ => (lift.v / most_v[0]).min(along.v / most_v[1]),
        };
        let asked = cut.top_share * machine.threading.design_override_pct / 100.0;
        let ratio = asked.min(top).max(1.0);
        let stroke_limits = |stroke_mm, [rise, _]: [f64; 2]| {
            if !shared(stroke_mm, rise) {
                return lift;
            }
            let left = lift.v - ratio * rise.abs() * cut.s_rpm / 60.0;
            Limits { v: left.max(LEAST_STROKE * lift.v), ..lift.share(0.5) }
        };
        let least_stroke_deg = 360.0 * FEWEST_COUNTS / machine.spindle_counts();
        let turns_per_s = cut.s_rpm * ratio / 60.0;
        Design {
            q: 6.0 * cut.s_rpm * ratio,
            run_in: Ramp::fastest(ratio * v, &in_limits),
            brake: Ramp::fastest(ratio * brakes, &out_limits),
            approach_limits: stroke_limits(cut.approach_mm, leads[0]),
            retract_limits: stroke_limits(cut.retract_mm, leads[1]),
            least_stroke_deg,
            share,
            rounds: Rounds {
                q: 6.0 * cut.s_rpm * ratio,
                turns_per_s,
                limits: [lift, along].map(|limits| limits.share(CORNER_SHARE)),
                least_deg: least_stroke_deg,
            },
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
        let [end, _] = cut.at_its_end();
        let (rise, lead) = (cut.along.across(end), cut.along.of(end));
        let share = lead.abs() / libm::hypot(rise, lead);
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
    let c_end = cut.end_deg();
    let brake_dc = design.q * design.brake.duration();
    let mut corners = Corners::of(cut, &design.rounds, run_in_dc);
    let [lead, growth] = cut.at_its_end();
    let stop_dc = if growth == Point::default() {
        0.0
    } else {
        design.rounds.window(cut.along, Point::default(), growth)
    };
    let lag = delay.max(stop_dc);
    let brake_c = match machine.threading.run_out {
        RunOut::Within if stop_dc == 0.0 => c_end - 0.5 * brake_dc,
        RunOut::Within => {
            let [lead, growth] = [lead, growth].map(|value| cut.along.of(value) * cut.lead_mm().signum());
            c_end - 360.0 * stops_before(lead, growth, stop_dc, brake_dc) + 0.5 * stop_dc
        }
        RunOut::Beyond => c_end - exit + lag,
    };
    if stop_dc > 0.0 {
        corners.stop_growing(growth, brake_c, stop_dc);
    }
    let brake = Span { c: brake_c, dc: brake_dc };
    let thread_end = brake_c - lag;
    let retract = if cut.retract_mm == 0.0 { brake } else { Span { c: thread_end, dc: retract_dc } };
    if thread_end <= locked {
        let run_out_mm = match cut.chain.bends() {
            [] => cut.gone_mm(c_end - thread_end),
            _ => cut.gone_mm(c_end) - cut.gone_mm(thread_end),
        };
        let length_mm = (cut.to_mm - cut.starts_mm()).abs();
        return Err(Refusal::NoThread { run_in_mm: cut.gone_mm(locked), run_out_mm, length_mm });
    }
    corners.check(cut, locked, thread_end)?;
    Ok(Windows { approach, unload, run_in, brake, retract, locked, thread_end, corners })
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
    let Windows { approach, unload, run_in, brake, retract, thread_end, ref corners, .. } = *windows;
    let corners = corners.corners(turn);
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
        ..if cut.rises() { lead(cut.rise_mm()) } else { AxisLaw::default() }
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
        corners,
        ..ThreadPass::default()
    };
    let axes =
        [(cut.along.lifts(), x, cut.above_mm()), (cut.along.axis(), lead(cut.lead_mm()), cut.starts_mm())];
    for ((axis, mut law, from), limits) in axes.into_iter().zip(limits) {
        let changes = Changes::of(&corners, axis);
        law.steepest_mm = changes.steepest_mm(law.lead_mm, law.run_in_c0_deg + law.run_in_dc_deg);
        law.check().map_err(|refused| Refusal::Extreme { refused })?;
        let moves = law.changing(cut.s_rpm, &changes);
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
