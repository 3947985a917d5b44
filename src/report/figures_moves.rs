//! The figures of timed motion: contour error over time, and the worst circle with its quadrants.

use protocol::Axis;
use rig::observe::{CircleReport, Summary};
use serde_json::{Value, json};

use super::curves_moves::{LapCurve, MovesCurves};
use super::figures::{BLUE, Figure, GREY, ORANGE, axis, curve, short};
use super::verdict::um;

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
    let points = lap.deviation.points();
    let around = points.iter().map(|(swept, _)| short(lap.from_deg + way * swept)).collect();
    let deviations = points.iter().map(|(_, um)| short(*um)).collect();
    let reach = points.iter().map(|(_, um)| um.abs()).fold(0.5, f64::max);
    let [first, second] = circle.plane.map(name);
    let glitches = circle.quadrants_um.map(|glitch| format!("{glitch:+.2} µm"));
    let round: Vec<f64> = (0..=72).map(|step| 5.0 * f64::from(step)).collect();
    let program = polar(round.clone(), vec![0.0; round.len()], "programmed radius", GREY);
    let quadrants: Vec<f64> = (0..4).map(|quadrant| 90.0 * f64::from(quadrant)).collect();
    let marks = json!({ "type": "scatterpolar", "mode": "markers+text", "name": "quadrant glitch", "theta": quadrants,
                        "r": circle.quadrants_um.map(|glitch| short(glitch + circle.mean_um)), "text": glitches,
                        "textposition": ["bottom left", "top right", "top left", "bottom right"],
                        "cliponaxis": false, "marker": { "color": ORANGE, "size": 9, "symbol": "circle-open" } });
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
        plot: json!({
            "data": [program, polar(around, deviations, "true path", BLUE), marks],
            "layout": { "polar": {
                "domain": { "x": [0.06, 0.94], "y": [0.04, 0.96] },
                "radialaxis": { "range": [-3.0 * reach, 1.3 * reach], "angle": 45, "tickangle": 0, "nticks": 7,
                                "gridcolor": "#e3e7ec", "linecolor": "#9aa3ad" },
                "angularaxis": { "gridcolor": "#e3e7ec", "linecolor": "#9aa3ad", "dtick": 30, "ticksuffix": "°" },
            } },
        }),
        aspect: 0.7,
    }
}

fn polar(theta: Vec<f64>, r: Vec<f64>, name: &str, color: &str) -> Value {
    json!({ "type": "scatterpolar", "mode": "lines", "name": name, "theta": theta, "r": r, "line": { "color": color, "width": 1.5 } })
}

fn name(axis: Axis) -> String {
    axis.to_string()
}
