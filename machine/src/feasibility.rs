//! What the axes of a machine can do: reach a point, turn an arc, follow a pass. In: machine code that has been checked.
use protocol::{Arc, PerAxis, Position, ThreadPass};

use crate::{Kinematics, Machine};

impl Machine {
    /// Feasibility rule: whether every axis can follow a pass up to the ratio it claims (M7, M11), within its travel,
    /// to the end the law names. The pass has been checked.
    pub fn can_follow(&self, pass: &ThreadPass) -> bool {
        let lathe = self.general.kinematics == Kinematics::Lathe; // only a lathe cuts threads
        lathe
            && self.axes().all(|(axis, config)| {
                let law = pass.axis(axis);
                let (start, way) = (law.start.mm(), law.law(pass.s_rpm));
                let top = config.limits().top_ratio(&way.peak());
                let end = start + way.at(law.done_deg()).s;
                let travel = config.travel_mm[0]..=config.travel_mm[1];
                top >= pass.max_ratio * (1.0 - 1e-9)
                    && (end - law.end.mm()).abs() < 1e-6
                    && [start, start + law.stroke_mm, end].iter().all(|mm| travel.contains(mm))
            })
    }

    /// Whether a point lies within the travel of every axis.
    pub fn can_reach(&self, point: &PerAxis<Position>) -> bool {
        self.axes().all(|(axis, config)| {
            (config.travel_mm[0]..=config.travel_mm[1]).contains(&point[axis.index()].mm())
        })
    }

    /// Whether the whole of an arc lies within the travel of every axis; false for what is no arc from there.
    pub fn can_turn(&self, from: &PerAxis<Position>, arc: &Arc) -> bool {
        arc.bounds(from).is_ok_and(|corners| corners.iter().all(|corner| self.can_reach(corner)))
    }
}
