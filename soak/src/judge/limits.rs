//! The limits of the axes, in every cycle and every state of a regulator that lives. In: what each says of
//! itself, and the true speed of the spindle. Out: the first step of a commanded position beyond V T, or
//! change of a commanded speed beyond A T.
//!
//! In a pass an axis follows the spindle. What a ripple or a load does to its speed between two cycles, times
//! the lead, comes on top: an axis that did not follow would cut a flank.

use machine::{AxisConfig, Machine};
use protocol::{Axis, AxisState, AxisStatus, PerAxis, Position, ThreadPass};
use rig::observe::Record;

use super::{Broken, Known, excuse};

/// Positions are whole counts of 1e-9 mm, laws are integrated.
const MORE: f64 = 1.02;
const ROUNDING: f64 = 1e-6;
/// Beyond its travel an axis is by no more than this, mm.
const BESIDE_MM: f64 = 0.001;
/// A way out takes over a state that may be at its limits already.
const LEAVING: f64 = 1.15;
/// The loop of a spindle swings over by this.
const SWING: f64 = 1.06;
/// The observer of a spindle that runs away is ahead of it by this.
const LEADS: f64 = 1.1;
/// The observer that leads a stroke is slow: it swings over by this.
const OVERSHOOT: f64 = 2.0;
/// And the fast one of a lead, by this.
const LAGS: f64 = 1.4;
/// What the spindle has done is followed within this, s.
const FOLLOWED_S: f64 = 0.1;

/// The statuses of the cycle before.
#[derive(Clone, Debug, Default)]
pub(crate) struct Limits {
    before: Vec<AxisStatus>,
    /// What the drives add to their positions: where an axis that stands is led goes with it as soon as its
    /// regulator has seen it.
    offsets: PerAxis<Position>,
    rpm: Option<f64>,
    /// Largest change of the spindle's speed in a cycle, 1/min, fading away.
    uneven: f64,
    /// What share of its acceleration each axis had when it began to leave.
    taken: Vec<f64>,
}

impl Limits {
    pub(crate) fn cycle(&mut self, known: &Known, record: &Record) -> Option<Broken> {
        let (machine, axes) = (known.machine, record.axes);
        let cycle_s = machine.general.cycle_s;
        let rpm = record.truth.spindle_rpm;
        let change_rpm = (rpm - self.rpm.replace(rpm).unwrap_or(rpm)).abs();
        self.uneven = (self.uneven * (1.0 - cycle_s / FOLLOWED_S)).max(change_rpm);
        let mut found = None;
        self.taken.resize(axes.len(), 0.0);
        for (((axis, now), before), taken) in axes.iter().zip(&self.before).zip(&mut self.taken) {
            // Before an axis follows anything, and after it was latched, commanded is where it is measured.
            let free = |status: &AxisStatus| matches!(status.state(), AxisState::Idle | AxisState::Fault);
            let Some(config) = machine.axis.get(axis) else { continue };
            if let Some(broken) = outside(*axis, config, now) {
                found.get_or_insert(broken);
            }
            // Statuses that are missing: what lies between them is as far as the axis may go meanwhile.
            let gap = now.cycle.0.saturating_sub(before.cycle.0) as f64;
            if gap == 0.0 || free(now) || free(before) {
                continue;
            }
            let offset = record.truth.measurement.references[axis.index()].home_offset;
            let step = went_mm(now, before, offset, &mut self.offsets[axis.index()]).abs();
            let change = (now.velocity_mm_s - before.velocity_mm_s).abs();
            let pass = if now.state().is_in_pass() { known.passes.get(&now.pass) } else { None };
            let had = before.acceleration_mm_s2.abs() / config.limits().a;
            *taken = match (before.state(), pass) {
                // Still on its law, or not: where a spindle runs away, that takes it as far as this.
                (AxisState::Leaving, Some((pass, _))) => {
                    taken.max(had.min(runs_away(machine, pass, rpm).powi(2)))
                }
                (AxisState::Leaving, None) => *taken,
                _ => had,
            };
            if step <= gap * at_least(config.limits().v, cycle_s)
                && change <= gap * at_least(config.limits().a, cycle_s)
            {
                continue;
            }
            let moving = Moving { rpm, uneven: self.uneven, taken: *taken, now };
            let (most, fastest) = moving.allowed(known, *axis, config, pass.map(|(pass, _)| pass));
            let (most, fastest) = (gap * most, gap * fastest);
            let state = now.state().name();
            if step.is_nan() || step > most {
                found.get_or_insert(Broken::new(
                    "position-step",
                    now.cycle.0,
                    format!(
                        "{axis} ({state}): {:.6} to {:.6} mm, {most:.6} allowed",
                        before.commanded_mm, now.commanded_mm
                    ),
                ));
            }
            if change.is_nan() || change > fastest {
                found.get_or_insert(Broken::new(
                    "speed-change",
                    now.cycle.0,
                    format!(
                        "{axis} ({state}): {:.4} to {:.4} mm/s, {fastest:.4} allowed",
                        before.velocity_mm_s, now.velocity_mm_s
                    ),
                ));
            }
        }
        self.before.clear();
        self.before.extend(axes.iter().map(|(_, status)| *status));
        found
    }
}

/// How far an axis is led on, mm: but for what its drive adds, once that has been taken up.
fn went_mm(now: &AxisStatus, before: &AxisStatus, offset: Position, taken_up: &mut Position) -> f64 {
    let went_mm = now.commanded_mm - before.commanded_mm;
    let with_it_mm = went_mm - offset.mm_from(*taken_up);
    if with_it_mm.abs() < went_mm.abs() {
        *taken_up = offset;
        return with_it_mm;
    }
    went_mm
}

/// What a limit allows in a cycle in every state, mostly enough.
fn at_least(limit: f64, cycle_s: f64) -> f64 {
    limit * cycle_s * MORE + ROUNDING
}

/// An axis that is led beyond its travel, or in timed motion faster than it may; or whose drive is told what
/// is no number.
fn outside(axis: Axis, config: &AxisConfig, now: &AxisStatus) -> Option<Broken> {
    let said = [now.commanded_mm, now.target_velocity_mm_s, now.velocity_offset_mm_s, now.torque_offset_nm];
    if said.iter().any(|value| !value.is_finite()) {
        return Some(Broken::new("not-a-number", now.cycle.0, format!("{axis}: {said:?}")));
    }
    // Commanded is measured there.
    if matches!(now.state(), AxisState::Idle | AxisState::Fault) {
        return None;
    }
    let [least, most] = config.travel_mm;
    if now.commanded_mm < least - BESIDE_MM || now.commanded_mm > most + BESIDE_MM {
        let text = format!("{axis} at {:.4} mm, from {least} to {most} allowed", now.commanded_mm);
        return Some(Broken::new("travel", now.cycle.0, text));
    }
    let timed = now.state() == AxisState::Streaming;
    let fastest = MORE * config.velocity_mm_s + ROUNDING;
    (timed && now.velocity_mm_s.abs() > fastest).then(|| {
        let text = format!("{axis} at {:.3} mm/s, {fastest:.3} allowed", now.velocity_mm_s);
        Broken::new("speed", now.cycle.0, text)
    })
}

/// What an axis follows in a cycle: the spindle, its largest change of speed, 1/min; what share of its
/// acceleration the axis had when it began to leave; its status.
struct Moving<'a> {
    rpm: f64,
    uneven: f64,
    taken: f64,
    now: &'a AxisStatus,
}

impl Moving<'_> {
    /// The largest step, mm, and change of speed, mm/s, of an axis from cycle to cycle.
    fn allowed(
        &self,
        known: &Known,
        axis: Axis,
        config: &AxisConfig,
        pass: Option<&ThreadPass>,
    ) -> (f64, f64) {
        let (machine, limits, now) = (known.machine, config.limits(), self.now);
        let cycle_s = machine.general.cycle_s;
        let leaves = now.state() == AxisState::Leaving;
        let more = if leaves { LEAVING * self.taken.max(1.0) } else { MORE };
        let Some(pass) = pass else {
            return (limits.v * cycle_s * more + ROUNDING, limits.a * cycle_s * more + ROUNDING);
        };
        // Its lead, what it strokes by the angle, and counts that are none.
        let law = pass.axis(axis);
        let steep = (LAGS * law.lead_mm.abs()).max(OVERSHOOT * excuse::steepest_mm(law));
        let counted = law.lead_mm.abs().max(0.5 * excuse::steepest_mm(law));
        let follows =
            steep / 60.0 * self.uneven + excuse::counted_mm_s(machine, known.events, now.cycle.0, counted);
        // A spindle that jams looks like one whose encoder fails, and is taken to turn on for some cycles.
        let jammed = known.events.iter().any(|event| excuse::jams(machine, event, now.cycle.0));
        let caught_up = if jammed { OVERSHOOT * excuse::steepest_mm(law) / 60.0 * pass.s_rpm } else { 0.0 };
        let follows = follows + caught_up;
        // As fast as the spindle is in truth, as long as that is what the pass was released for.
        let rpm = self.rpm.abs();
        let followed = if leaves { LEADS * rpm } else { rpm.min(SWING * released_rpm(machine, pass)) };
        let turned = law.lead_mm.abs() * followed / 60.0;
        // A law by the angle of a spindle that runs away is as much faster.
        let runs_away = runs_away(machine, pass, rpm);
        let most = limits.v.max(turned) * cycle_s * more + ROUNDING;
        (most, limits.a * runs_away * runs_away * cycle_s * more + ROUNDING + follows)
    }
}

/// The highest speed that a pass was released for, 1/min.
fn released_rpm(machine: &Machine, pass: &ThreadPass) -> f64 {
    pass.max_ratio.min(machine.spindle.override_max_pct / 100.0) * pass.s_rpm
}

/// How many times as fast as that a spindle is.
fn runs_away(machine: &Machine, pass: &ThreadPass, rpm: f64) -> f64 {
    (rpm.abs() / released_rpm(machine, pass)).max(1.0)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use machine::Machine;
    use protocol::{Axis, AxisState, AxisStatus, Cycle, MachineStatus, Truth};
    use rig::observe::Record;

    use super::{Known, Limits};

    fn status(cycle: u64, commanded_mm: f64, velocity_mm_s: f64) -> AxisStatus {
        let state = AxisState::Streaming as u32;
        AxisStatus { cycle: Cycle(cycle), state, commanded_mm, velocity_mm_s, ..AxisStatus::default() }
    }

    /// What is found of X, status by status.
    fn found(statuses: &[AxisStatus]) -> Option<&'static str> {
        let machine = Machine::plain();
        let known = Known {
            machine: &machine,
            tan_flank: 0.0,
            passes: BTreeMap::new(),
            events: &[],
            reference: None,
        };
        let mut limits = Limits::default();
        let (truth, said) = (Truth::default(), MachineStatus::default());
        statuses.iter().find_map(|status| {
            let axes = [(Axis::X, *status)];
            let record = Record { truth: &truth, axes: &axes, machine: &said };
            Some(limits.cycle(&known, &record)?.invariant)
        })
    }

    #[test]
    fn an_axis_goes_no_farther_in_a_gap_than_it_may_in_so_many_cycles() {
        let machine = Machine::plain();
        let x = machine.axis[&Axis::X].limits();
        let (home, step) = (machine.axis[&Axis::X].home_mm, x.v * machine.general.cycle_s);
        let from = status(100, home, 0.9 * x.v);
        let to = |cycle: u64, steps: f64| status(cycle, home - steps * step, 0.9 * x.v);
        assert_eq!(found(&[from, to(101, 1.0)]), None);
        assert_eq!(found(&[from, to(101, 1.1)]), Some("position-step"));
        assert_eq!(found(&[from, to(105, 5.0)]), None);
        assert_eq!(found(&[from, to(105, 5.5)]), Some("position-step"));
        let faster = status(102, home, 0.9 * x.v - 2.2 * x.a * machine.general.cycle_s);
        assert_eq!(found(&[from, faster]), Some("speed-change"));
    }

    /// What is found of X that says so twice.
    fn stays(status: AxisStatus) -> Option<&'static str> {
        found(&[status, AxisStatus { cycle: Cycle(status.cycle.0 + 1), ..status }])
    }

    #[test]
    fn an_axis_stays_within_its_travel_and_its_speed_and_tells_its_drive_numbers() {
        let machine = Machine::plain();
        let x = &machine.axis[&Axis::X];
        assert_eq!(stays(status(1, x.travel_mm[0] - 0.000_9, 0.0)), None);
        assert_eq!(stays(status(1, x.travel_mm[0] - 0.001_1, 0.0)), Some("travel"));
        assert_eq!(stays(status(1, x.travel_mm[1] + 0.001_1, 0.0)), Some("travel"));
        assert_eq!(stays(status(1, x.home_mm, 1.03 * x.velocity_mm_s)), Some("speed"));
        let wild = AxisStatus { torque_offset_nm: f64::INFINITY, ..status(1, x.home_mm, 0.0) };
        assert_eq!(stays(wild), Some("not-a-number"));
    }
}
