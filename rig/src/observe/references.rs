//! Reference runs: what each of them found. In: the record of every control cycle. Out: a [`ReferenceReport`]
//! of each that made the position of its axis true, mm.

use machine::{Machine, Method};
use protocol::{Axis, AxisStatus, MachineState, MachineStatus, PerAxis, Truth};
use serde::{Deserialize, Serialize};

/// A reference run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReferenceReport {
    /// The axis.
    pub axis: Axis,
    /// What it is referenced to.
    pub method: Method,
    /// Where switch or index are, as the axis counts behind the run, mm; degrees of a rotary axis.
    pub position_mm: f64,
    /// By how much its position was wrong before: what was added to it.
    pub shift_mm: f64,
    /// Control cycle in which it was true first.
    pub cycle: u64,
    /// So many control cycles the run had taken then, its holds counted.
    pub cycles: u64,
}

impl ReferenceReport {
    /// For people: `X by switch and index at 110.000 mm: position shifted by -0.7370 mm, in 4.2 s`.
    pub fn told(&self, cycle_s: f64) -> String {
        let ReferenceReport { axis, position_mm, shift_mm, cycles, .. } = self;
        let (unit, by) = (if axis.is_rotary() { "°" } else { "mm" }, self.method.in_words());
        let (name, time_s) = (axis.name().to_ascii_uppercase(), *cycles as f64 * cycle_s);
        format!(
            "{name} by {by} at {position_mm:.3} {unit}: position shifted by {shift_mm:+.4} {unit}, in {time_s:.1} s"
        )
    }
}

/// Watches the reference runs of a machine.
#[derive(Clone)]
pub(super) struct References {
    /// What each axis that has one is referenced to, and where, and its turn.
    known: Vec<(Axis, Method, [f64; 2])>,
    /// Of each axis: whether its run was still to be made in the cycle before, and since when it may be in
    /// hand.
    open: PerAxis<bool>,
    since: PerAxis<u64>,
    seen: Vec<ReferenceReport>,
}

impl References {
    pub(super) fn of(machine: &Machine) -> References {
        let known = machine.reference_runs().into_iter().map(|(axis, reference)| {
            (axis, reference.method, [reference.position_mm, machine.axis[&axis].screw_lead_mm])
        });
        References {
            known: known.collect(),
            open: PerAxis::default(),
            since: PerAxis::default(),
            seen: Vec::new(),
        }
    }

    /// Takes one control cycle.
    pub(super) fn cycle(&mut self, truth: &Truth, axes: &[(Axis, AxisStatus)], machine: &MachineStatus) {
        let References { known, open, since, seen } = self;
        let cycle = truth.cycle.0;
        let waits = matches!(machine.state(), MachineState::Starting | MachineState::ByHand);
        for (axis, method, [at_mm, lead_mm]) in known {
            let i = axis.index();
            let is_open = machine.is_unreferenced(*axis);
            if open[i] && !is_open {
                let marks = &truth.measurement.references[i];
                let turns = (marks.indexed_at.mm() - *at_mm) / *lead_mm;
                seen.push(ReferenceReport {
                    axis: *axis,
                    method: *method,
                    // An index alone is the one that is nearest; which that is only the run knows.
                    position_mm: *at_mm
                        + if *method == Method::Index { turns.round() * *lead_mm } else { 0.0 },
                    shift_mm: marks.home_offset.mm(),
                    cycle,
                    cycles: cycle - since[i],
                });
            }
            open[i] = is_open;
            // In its run nothing moves but the axis, and nothing is waited for.
            let others_move = axes.iter().any(|(other, status)| other != axis && status.velocity_mm_s != 0.0);
            if waits || others_move || !is_open {
                since[i] = cycle;
            }
        }
    }

    /// The runs in the order of their ends.
    pub(super) fn finish(self) -> Vec<ReferenceReport> {
        self.seen
    }
}
