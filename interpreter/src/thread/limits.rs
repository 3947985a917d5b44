//! What the axes of a cut can do. In: the machine, the leads of a path. Out: limits of an axis and of a path.

use machine::Machine;
use motion::Limits;
use protocol::Axis;

/// Limits of an axis as the machine file states them.
pub(super) fn axis_limits(machine: &Machine, axis: Axis) -> Limits {
    machine.axis.get(&axis).expect("a checked machine has X and Z").limits()
}

pub(super) fn travel(machine: &Machine, axis: Axis) -> [f64; 2] {
    machine.axis.get(&axis).expect("a checked machine has X and Z").travel_mm
}

/// Limits of the path in the direction of its leads across and along: what both axes can do together.
pub(super) fn path_limits([rise, lead]: [f64; 2], lift: Limits, along: Limits) -> Limits {
    let (rise, lead) = (rise.abs(), lead.abs());
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
