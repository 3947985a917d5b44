//! The figures of timed motion: contour error over time, and the worst circle with its quadrants.

use protocol::Axis;
use rig::observe::{CircleReport, Summary};
use serde_json::json;

use super::curves_moves::{LapCurve, MovesCurves};
use super::dial::Dial;
use super::verdict::um;
use crate::paint::{BLUE, Figure, GREY, ORANGE, axis, curve};

/// Contour error of the whole run.
pub(super) fn contour(summary: &Summary, curves: &MovesCurves) -> Figure {
    let moves = &summary.moves;
    let mut y = axis("contour error (µm)");
    y["rangemode"] = json!("tozero");
    Figure {
        title: "Contour error over time".into(),
        caption: "Distance of the true position (at the motors) from the commanded path while the axes move in timed \
                  motion, rapid motion included; what is early or late along the path does not count. Good: a few µm, \
                  most of it where an axis turns back or accelerates hard."
            .into(),
        alt: format!(
            "Contour error over the time of the run: at most {} in line {} at {:.3} s, root of the mean square {}.",
            um(moves.contour_max_um),
            moves.contour_line,
            moves.contour_t_s,
            um(moves.contour_rms_um)
        ),
        plot: json!({
            "data": [curve(&curves.contour, "contour error", BLUE, ("x", "y"))],
            "layout": { "xaxis": axis("time (s)"), "yaxis": y, "showlegend": false },
        }),
        aspect: 0.4,
    }
}

/// The circle with the largest deviation, as a ball bar would draw it.
pub(super) fn circle(circle: &CircleReport, lap: &LapCurve) -> Figure {
    let way = circle.swept_deg.signum();
    let points: Vec<_> =
        lap.deviation.points().into_iter().map(|(swept, um)| (lap.from_deg + way * swept, um)).collect();
    let reach = points.iter().map(|(_, um)| um.abs()).fold(0.5, f64::max);
    let [first, second] = circle.plane.map(name);
    let glitches = circle.quadrants_um.map(|glitch| format!("{glitch:+.2} µm"));
    let dial = Dial::new(-3.0 * reach, 1.3 * reach);
    let round: Vec<_> = (0..=72).map(|step| (5.0 * f64::from(step), 0.0)).collect();
    let mut program = dial.trace(&round, "lines", "programmed radius");
    program["line"] = json!({ "color": GREY, "width": 1.5, "shape": "spline" });
    let mut path = dial.trace(&points, "lines", "true path");
    path["line"] = json!({ "color": BLUE, "width": 1.5 });
    let quadrants = [0.0, 90.0, 180.0, 270.0];
    let glitch = |i: usize| (quadrants[i], circle.quadrants_um[i] + circle.mean_um);
    let mut marks = dial.trace(&[0, 1, 2, 3].map(glitch), "markers+text", "quadrant glitch");
    marks["text"] = json!(glitches);
    marks["textposition"] = json!(["bottom left", "top right", "top left", "bottom right"]);
    marks["cliponaxis"] = json!(false);
    marks["marker"] = json!({ "color": ORANGE, "size": 9, "symbol": "circle-open" });
    Figure {
        title: format!("Circle in line {}", circle.line),
        caption: format!(
            "Deviation of the true path (at the motors) from the programmed radius of {} mm, which is drawn in grey, at \
             {:.0} mm/min; {first} to the right, {second} upwards; the deviation is drawn much magnified. Rings \
             and numbers are in µm. At each quadrant one axis turns back and its friction with it: the glitch is how \
             far the deviation goes from its mean there. Good: 3 µm at most, the four glitches alike and small.",
            circle.radius_mm, circle.feed_mm_min
        ),
        alt: format!(
            "Polar picture of the deviation of the circle: at most {}, mean {}; quadrants {}.",
            um(circle.round_max_um),
            um(circle.mean_um),
            glitches.join(", ")
        ),
        plot: json!({ "data": [program, path, marks], "layout": dial.layout() }),
        aspect: 0.7,
    }
}

fn name(axis: Axis) -> String {
    axis.to_string()
}
