//! The figures of the one pass that is shown in full, with the moments of a pass marked:
//! 0 armed, 1 index, 2 run-in begins, 3 material begins, 4 run-out begins, 5 at rest and free of the part.

use rig::observe::PassReport;
use serde_json::{Value, json};

use super::curves::{ShownCurves, moving_deg, thread_deg};
use crate::colours::WIDE;
use crate::paint::{BLUE, Figure, GREEN, GREY, ORANGE, curve, stacked};

/// The moments of a pass and the angles at which they come, degrees.
fn moments(pass: &PassReport, armed_deg: f64) -> [(&'static str, f64); 6] {
    let (begins, done) = moving_deg(pass);
    let (locked, leaves) = thread_deg(pass);
    [("0", armed_deg), ("1", 0.0), ("2", begins), ("3", locked), ("4", leaves), ("5", done)]
}

/// Upright lines at the moments, and their numbers on top.
fn mark(layout: &mut Value, moments: &[(&str, f64)]) {
    let upright = |(_, c): &(&str, f64)| {
        json!({ "type": "line", "xref": "x", "yref": "paper", "x0": c, "x1": c, "y0": 0, "y1": 1,
                "line": { "color": GREY, "width": 1, "dash": "dot" } })
    };
    let number = |(name, c): &(&str, f64)| {
        json!({ "xref": "x", "yref": "paper", "x": c, "y": 1.0, "yanchor": "bottom",
                "xanchor": if *name == "0" { "right" } else { "center" }, "text": format!("<b>{name}</b>"),
                "showarrow": false })
    };
    layout["shapes"] = moments.iter().map(upright).collect();
    layout["annotations"] = moments.iter().map(number).collect();
}

/// What the pass is called.
fn title(pass: &PassReport) -> String {
    let kind = if pass.tap.is_some() { "Tap" } else { "Pass" };
    format!("{kind} {}", pass.pass)
}

const MOMENTS: &str = "0 armed, the tool waits at its start point. 1 index: angles count from here. 2 run-in begins. 3 material \
                       begins: X at depth, Z on the helix (of a thread on a face each is the other). 4 run-out begins. 5 at rest, free of the part. Good: the thin \
                       line of the true position never leaves the wide line of the programmed law, and between 3 and 4 both \
                       are straight.";
const MOMENTS_OF_A_TAP: &str = "0 armed, the tool waits at its start point. 1 index: angles count from here. 2 run-in begins. 3 Z \
                                is on the helix. 4 and 5 at depth, where the spindle turns round: the angle goes back from \
                                there, and Z with it. Good: the way out lies on the way in, and from 3 to 4 both are straight.";

/// X and Z over the spindle angle.
pub(super) fn motion(pass: &PassReport, shown: &ShownCurves) -> Figure {
    let mut layout = stacked("spindle angle since the index (degrees)", "X, radius (mm)", "Z (mm)");
    mark(&mut layout, &moments(pass, shown.armed_deg));
    let mut data = Vec::new();
    for (index, y) in ["y", "y2"].into_iter().enumerate() {
        let mut programmed = curve(&shown.programmed[index], "programmed law", ORANGE, ("x", y));
        programmed["line"] = json!({ "color": WIDE, "width": 7 });
        let position = curve(&shown.position[index], "true position", BLUE, ("x", y));
        for mut drawn in [programmed, position] {
            drawn["showlegend"] = json!(index == 0);
            drawn["legendgroup"] = drawn["name"].clone();
            data.push(drawn);
        }
    }
    let (from, to) = thread_deg(pass);
    Figure {
        title: format!("{}: X and Z over the spindle angle", title(pass)),
        caption: if pass.tap.is_some() { MOMENTS_OF_A_TAP } else { MOMENTS }.into(),
        alt: format!(
            "Position of X and Z in pass {} over the spindle angle, with moments 0 to 5; thread from {from:.0} to \
             {to:.0} degrees.",
            pass.pass
        ),
        plot: json!({ "data": data, "layout": layout }),
        aspect: 0.6,
    }
}

/// The error that the controller sees, and that of the slide, which cuts.
pub(super) fn slide(pass: &PassReport, shown: &ShownCurves) -> Figure {
    let mut layout = stacked("spindle angle since the index (degrees)", "X (µm)", "Z (µm)");
    mark(&mut layout, &moments(pass, shown.armed_deg)[2..]);
    let (begins, done) = moving_deg(pass);
    let margin = 0.02 * (done - begins);
    layout["xaxis"]["range"] = json!([begins - margin, done + margin]);
    let mut data = Vec::new();
    for (index, y) in ["y", "y2"].into_iter().enumerate() {
        let servo = curve(&shown.servo[index], "servo error: commanded − measured", BLUE, ("x", y));
        let slide = curve(&shown.slide[index], "slide: commanded − true", ORANGE, ("x", y));
        for mut drawn in [slide, servo] {
            drawn["showlegend"] = json!(index == 0);
            drawn["legendgroup"] = drawn["name"].clone();
            data.push(drawn);
        }
    }
    let [x, z] = [&pass.x_slide, &pass.z_slide].map(|slide| slide.thread_max_abs_um);
    Figure {
        title: format!("{}: servo error, and what the slide makes of it", title(pass)),
        caption: format!(
            "The servo error is what the controller sees: at the motor, or at the scale of an axis that has one. The \
             slide stands behind backlash, error of the screw, and the elasticity on which acceleration, friction and \
             cutting force pull. A constant error along the thread shifts it, and in X of a thread along Z makes the diameter wrong by twice as \
             much; one that changes from pass to pass spoils it. In the thread of this pass at most {x:.2} µm in X and \
             {z:.2} µm in Z."
        ),
        alt: format!(
            "Servo error and slide error of X and Z in pass {} over the spindle angle. Slide in the thread: X {x:.2} µm, \
             Z {z:.2} µm.",
            pass.pass
        ),
        plot: json!({ "data": data, "layout": layout }),
        aspect: 0.6,
    }
}

/// Speed, acceleration and jerk of X and Z in per cent of their limits.
pub(super) fn limits(pass: &PassReport, shown: &ShownCurves) -> Figure {
    let mut layout = stacked("spindle angle since the index (degrees)", "X (% of limit)", "Z (% of limit)");
    mark(&mut layout, &moments(pass, shown.armed_deg)[2..]);
    let (begins, done) = moving_deg(pass);
    let margin = 0.02 * (done - begins);
    layout["xaxis"]["range"] = json!([begins - margin, done + margin]);
    let mut data = Vec::new();
    for (used, y) in shown.used.iter().zip(["y", "y2"]) {
        let kinds = [("speed", GREEN, "solid"), ("acceleration", BLUE, "dash"), ("jerk", ORANGE, "dot")];
        for (envelope, (name, color, dash)) in used.iter().zip(kinds) {
            let mut drawn = curve(envelope, name, color, ("x", y));
            drawn["line"]["dash"] = json!(dash);
            drawn["showlegend"] = json!(y == "y");
            drawn["legendgroup"] = json!(name);
            data.push(drawn);
        }
    }
    let (most, used) = (pass.limits_asked_pct.most(), pass.limits_used_pct.most());
    Figure {
        title: format!("{}: speed, acceleration and jerk against the limits", title(pass)),
        caption: format!(
            "What the pass asks of each axis, in per cent of what the machine file allows. Good: never beyond ±100 %. \
             This pass asks for at most {most:.0} %, and could be followed up to {:.0} % override; the true motion of \
             the nut uses {used:.0} %.",
            pass.max_feasible_override_pct
        ),
        alt: format!(
            "Speed, acceleration and jerk of X and Z in per cent of their limits; at most {most:.0} %."
        ),
        plot: json!({ "data": data, "layout": layout }),
        aspect: 0.6,
    }
}
