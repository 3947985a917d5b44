//! The figures of a report, in their order. In: [`Curves`]. Out: [`Figure`]s with what to look for in words.

use rig::observe::{PassReport, Summary, WorkKind};
use serde_json::{Value, json};

use super::by_pass::by_pass;
use super::curves::{Curves, moving_deg, thread_deg};
use crate::paint::{BLUE, Figure, ORANGE, axis, band, curve, stacked};

/// All figures that the curves allow.
pub(super) fn all(summary: &Summary, curves: &Curves) -> Vec<Figure> {
    let mut figures = vec![curves.path.figure()];
    figures.extend(super::part::figures(summary, curves));
    let shown = summary.passes.get(curves.shown_index).zip(curves.shown.as_ref());
    if let Some((pass, shown)) = shown {
        figures.push(super::figures_pass::motion(pass, shown));
    }
    if !summary.passes.is_empty() {
        figures.push(servo(summary, curves));
    }
    if let Some((pass, shown)) = shown {
        figures.push(super::figures_pass::slide(pass, shown));
    }
    if !summary.passes.is_empty() {
        figures.push(helix(summary, curves));
    }
    figures.extend(curves.error_map.figure());
    if let Some((pass, shown)) = shown {
        figures.push(super::figures_pass::limits(pass, shown));
    }
    if super::cutting::cuts(summary) {
        figures.push(super::figures_cutting::figure(summary, curves));
    }
    for curves in &curves.traces {
        let Some(trace) = summary.traces.get(curves.index) else { continue };
        if trace.kind == WorkKind::Surface {
            figures.push(super::figures_traces::map(trace, &curves.map));
        }
        figures.push(super::figures_traces::way(trace, curves));
    }
    if let Some(lap) = &curves.moves.lap
        && let Some(circle) = summary.moves.circles.get(lap.index)
    {
        figures.push(super::figures_moves::circle(circle, lap));
    }
    if summary.moves.contour_max_um > 0.0 {
        figures.push(super::figures_moves::contour(summary, &curves.moves));
    }
    if curves.spindle_turns {
        figures.push(spindle(summary, curves));
    }
    figures
}

fn servo(summary: &Summary, curves: &Curves) -> Figure {
    let x = by_pass(curves, ("x", "y"), true, |index| &curves.passes[index].servo[0]);
    let z = by_pass(curves, ("x", "y2"), false, |index| &curves.passes[index].servo[1]);
    let mut layout = stacked("spindle angle since the index (degrees)", "X (µm)", "Z (µm)");
    layout["shapes"] = bands(summary);
    let worst = |of: fn(&PassReport) -> f64| summary.passes.iter().map(of).fold(0.0, f64::max);
    let x_worst = worst(|pass| pass.x.approach_max_um.max(-pass.x.approach_min_um));
    let z_worst = worst(|pass| pass.z.approach_max_um.max(-pass.z.approach_min_um));
    Figure {
        title: "Servo error of every pass".into(),
        caption: "Commanded minus measured position, at the instant of measuring. The shaded part is the thread. \
                  Good: a few µm while the tool accelerates before and after it, next to nothing in it, and passes \
                  that lie on each other."
            .into(),
        alt: format!(
            "Servo errors of X and Z over the spindle angle, one curve a pass. Largest in the run-in: X {x_worst:.2} \
             µm, Z {z_worst:.2} µm."
        ),
        plot: json!({ "data": x.chain(z).collect::<Vec<_>>(), "layout": layout }),
        aspect: 0.6,
    }
}

/// The part of the angle in which every pass is in its thread.
fn bands(summary: &Summary) -> Value {
    let from = summary.passes.iter().map(|pass| thread_deg(pass).0).fold(0.0, f64::max);
    let to = summary.passes.iter().map(|pass| thread_deg(pass).1).fold(f64::INFINITY, f64::min);
    let end = summary.passes.iter().map(|pass| moving_deg(pass).1).fold(0.0, f64::max);
    if from >= to.min(end) {
        return json!([]);
    }
    json!([band(from, to)])
}

fn helix(summary: &Summary, curves: &Curves) -> Figure {
    let drawn = by_pass(curves, ("x", "y"), true, |index| &curves.passes[index].helix);
    let worst = summary.passes.iter().map(|pass| pass.helix_max_abs_um).fold(0.0, f64::max);
    Figure {
        title: "Thread error of every pass".into(),
        caption: "True Z, of a thread on a face X (of the nut, before backlash and elasticity), minus the programmed helix at \
                  the true spindle angle, over the turns of the thread. Good: every curve close to zero, without slope (a slope is a \
                  wrong lead), all on each other (a distance between passes is a wrong groove)."
            .into(),
        alt: format!("Distance from the helix over the turns of the thread, one curve a pass; at most {worst:.2} µm."),
        plot: json!({
            "data": drawn.collect::<Vec<_>>(),
            "layout": { "xaxis": axis("turns of the thread"), "yaxis": axis("distance from the helix (µm)") },
        }),
        aspect: 0.45,
    }
}

fn spindle(summary: &Summary, curves: &Curves) -> Figure {
    let at = |cycle: u64| cycle as f64 * summary.cycle_s;
    let cut: Vec<Value> = summary.passes.iter().map(|p| band(at(p.begin_cycle), at(p.end_cycle))).collect();
    let mut layout = stacked("time (s)", "spindle (1/min)", "override (%)");
    layout["shapes"] = json!(cut);
    layout["showlegend"] = json!(false);
    layout["yaxis2"]["rangemode"] = json!("tozero");
    Figure {
        title: "Spindle over time".into(),
        caption: "True speed of the spindle, and the override on the panel; shaded where a pass is cut. The speed may \
                  change as it likes, in a pass too: the thread follows the angle, not the time."
            .into(),
        alt: "Spindle speed and spindle override over the time of the run, with the passes shaded.".into(),
        plot: json!({
            "data": [
                curve(&curves.rpm, "speed", BLUE, ("x", "y")),
                curve(&curves.override_pct, "override", ORANGE, ("x", "y2")),
            ],
            "layout": layout,
        }),
        aspect: 0.45,
    }
}
