//! The figure of cutting: force and torque of every pass over the time since the tool went in.

use rig::observe::{CuttingReport, Summary};
use serde_json::json;

use super::{by_pass::by_pass, curves::Curves};
use crate::paint::{Figure, stacked};

/// Force and torque over the time of each pass.
pub(super) fn figure(summary: &Summary, curves: &Curves) -> Figure {
    let force = by_pass(curves, ("x", "y"), true, |index| &curves.cutting.of_pass(index)[0]);
    let torque = by_pass(curves, ("x", "y2"), false, |index| &curves.cutting.of_pass(index)[1]);
    let layout = stacked("time since the tool went in (s)", "cutting force (N)", "spindle motor (N·m)");
    let worst = |of: fn(&CuttingReport) -> f64| {
        summary.passes.iter().filter_map(|pass| pass.cutting.as_ref()).map(of).fold(0.0, f64::max)
    };
    let (force_n, torque_nm) = (worst(|cut| cut.force_max_n), worst(|cut| cut.torque_max_nm));
    Figure {
        title: "Cutting force and spindle torque of every pass".into(),
        caption: "Above the tangential force at the tool, below what the motor of the spindle gives: its friction, the \
                  cut, and the change of speed. The force comes on while the tool enters at the face. Good: passes of \
                  equal chip area lie on each other, the torque stays well below the limit of the motor, and a spring \
                  pass takes next to nothing."
            .into(),
        alt: format!(
            "Cutting force and torque of the spindle motor over time, one curve a pass. The cut takes at most \
             {force_n:.0} N and {torque_nm:.1} N·m."
        ),
        plot: json!({ "data": force.chain(torque).collect::<Vec<_>>(), "layout": layout }),
        aspect: 0.6,
    }
}
