//! Arcs and helices. In: an arc of the program, what is in force, where the axes rest. Out: an arc of the
//! machine within the travel.

use gcode::Problem;
use gcode::canon::{self, Plane};
use gcode::problem::Blame;
use machine::Machine;
use protocol::{PerAxis, Position};

use crate::modal::Modal;
use crate::points::Points;
use crate::reach::{Done, missing, within_travel};

/// Refuses arcs in a plane that the machine does not have, or that is turned out of its axes, and threads
/// in another plane than that of a lathe.
pub(crate) fn check_plane(modal: &Modal, machine: &Machine) -> Done {
    let (first, second, _) = modal.plane.axes();
    let lacks = |coordinate: usize| {
        let axis = machine::kinematics::COORDINATES.get(coordinate);
        axis.is_some_and(|axis| !machine.axis.contains_key(axis))
    };
    if lacks(first) || lacks(second) {
        let help = "choose the plane of the lathe with G18";
        return Err(missing("an arc outside the plane of X and Z", help));
    }
    if modal.frame.rotation_deg != 0.0 && modal.plane != Plane::Xy {
        let what = "an arc across the plane of X and Y in a coordinate system turned about Z";
        return Err(missing(what, "turn it back with G10 L2 R0, or cut the arc in G17"));
    }
    if modal.synchronised.is_some() && modal.plane != Plane::Xz {
        return Err(missing("a thread along an arc outside the plane of X and Z", "choose it with G18"));
    }
    Ok(())
}

/// End and centre of an arc on the machine.
pub(crate) fn ends(arc: &canon::Arc, modal: &Modal) -> [gcode::Pose; 2] {
    let (first, second, across) = modal.plane.axes();
    let [a, b, c] = arc.rotary;
    [arc.end, arc.center].map(|[one, other]| {
        let mut point = [0.0, 0.0, 0.0, a, b, c];
        (point[first], point[second], point[across]) = (one, other, arc.along);
        modal.frame.machine(&point)
    })
}

/// The arc from where the axes rest, and the lowest and highest corner of its box.
pub(crate) fn on_machine(
    turns: i32,
    [end, center]: &[gcode::Pose; 2],
    plane: Plane,
    points: &Points,
) -> Result<(protocol::Arc, [PerAxis<Position>; 2]), Box<Problem>> {
    let (first, second, _) = plane.axes();
    let arc = protocol::Arc {
        plane: match plane {
            Plane::Xy => protocol::Plane::Xy,
            Plane::Xz => protocol::Plane::Zx,
            Plane::Yz => protocol::Plane::Yz,
        },
        target: points.axes(end),
        center: [center[first], center[second]].map(Position::from_mm),
        turns,
    };
    let corners = arc.bounds(&points.axes_at_rest()).map_err(|refused| {
        let help = "check the end point and the centre (I, J, K) or the radius (R)";
        let message = format!("the arc cannot be made: {refused}");
        Problem::error("bad-arc", Blame::Block, message, help)
    })?;
    Ok((arc, corners))
}

/// Refuses a box that is not within the travel.
pub(crate) fn check_travel(corners: &[PerAxis<Position>; 2], machine: &Machine) -> Done {
    for corner in corners {
        for (axis, _) in machine.axes() {
            within_travel(machine, axis, corner[axis.index()].mm(), Blame::Block)?;
        }
    }
    Ok(())
}
