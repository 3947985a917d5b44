//! Pictures of the approach. In: measured passes. Out: for each override the four pictures of the original,
//! position, speed, acceleration and servo error over time; then the structures beside each other, torques,
//! and errors over the override.

use machine::Feedforward;
use serde_json::{Value, json};

use super::{Done, OVERRIDES, STRUCTURES, measure::Moment, micrometres, name, published::BAND_UM};
use report::paint::{BLUE, Figure, GREEN, GREY, ORANGE, PURPLE, YELLOW, axis, line};

/// One of the pictures above each other: title of its axis, and its value.
type Quantity = (&'static str, fn(&Moment) -> f64);

/// Colour of each structure, in the order of [`STRUCTURES`].
const COLORS: [&str; 6] = [GREY, PURPLE, ORANGE, YELLOW, GREEN, BLUE];

pub(super) fn all(done: &[Done]) -> Vec<Figure> {
    let original = OVERRIDES.into_iter().filter_map(|pct| original(done, pct));
    let compared = [structures(done), torques(done)].into_iter().flatten();
    original.chain(compared).chain([over_override(done)]).collect()
}

fn found(done: &[Done], structure: Feedforward, override_pct: f64) -> Option<&Done> {
    done.iter().find(|done| {
        done.row.structure == structure && done.row.override_pct == override_pct && !done.row.tuned
    })
}

/// A quantity over time.
fn curve(done: &Done, name: &str, color: &str, axes: (&str, &str), of: fn(&Moment) -> f64) -> Value {
    let points: Vec<_> = done.measured.curve.iter().map(|moment| (moment.t_s, of(moment))).collect();
    line(&points, name, color, axes)
}

/// The curve without an entry of its own in the legend.
fn quiet(mut curve: Value) -> Value {
    curve["showlegend"] = json!(false);
    curve
}

/// A dashed line across the y axis of this name.
fn level(y: &str, um: f64) -> Value {
    json!({ "type": "line", "xref": "paper", "yref": y, "x0": 0, "x1": 1, "y0": um, "y1": um,
            "line": { "color": GREY, "width": 1, "dash": "dash" } })
}

/// The published band.
fn band(y: &str) -> Value {
    json!([level(y, BAND_UM), level(y, -BAND_UM)])
}

/// Position, speed, acceleration and servo error at one override, one above the other.
fn original(done: &[Done], pct: f64) -> Option<Figure> {
    let full = found(done, Feedforward::Full, pct)?;
    let published = found(done, Feedforward::DifferenceVa, pct)?;
    let quantities: [Quantity; 3] = [
        ("way (mm)", |at| at.way_mm),
        ("speed (mm/s)", |at| at.v_mm_s),
        ("acceleration (m/s²)", |at| 1e-3 * at.a_mm_s2),
    ];
    let mut data = Vec::new();
    let mut layout =
        json!({ "xaxis": { "anchor": "y4", "title": { "text": "time (s)" } }, "shapes": band("y4") });
    for (index, (title, of)) in quantities.into_iter().enumerate() {
        let number = if index == 0 { String::new() } else { (index + 1).to_string() };
        let top = 1.0 - 0.22 * index as f64;
        layout[format!("yaxis{number}")] =
            json!({ "domain": [top - 0.185, top], "title": { "text": title }, "nticks": 4 });
        data.push(quiet(curve(full, title, BLUE, ("x", &format!("y{number}")), of)));
    }
    let worst = [published, full].map(|done| done.row.approach_max_um.max(-done.row.approach_min_um));
    let most = 1.15 * worst.into_iter().fold(BAND_UM, f64::max);
    layout["yaxis4"] =
        json!({ "domain": [0.0, 0.305], "title": { "text": "servo error (µm)" }, "range": [-most, most] });
    let error = |done, name, color| curve(done, name, color, ("x", "y4"), |at| at.error_um);
    data.push(error(published, "difference-va, like the published structure", ORANGE));
    data.push(error(full, "full", BLUE));
    Some(Figure {
        title: format!("Override {pct:.0} %: position, speed, acceleration, servo error"),
        caption: format!(
            "Way, speed and acceleration as commanded by the structure full at the observed spindle angle; servo \
             errors of two structures. Dashed: the published band of ±{BAND_UM:.0} µm. The motion is the same law of \
             the same angle at every override: at {pct:.0} % it takes {:.2} s.",
            20.0 / pct,
        ),
        alt: format!(
            "Four curves over time at {pct:.0} % override. Servo error of difference-va {:.1} to {:.1} µm, of full \
             {:.1} to {:.1} µm.",
            published.row.approach_min_um,
            published.row.approach_max_um,
            full.row.approach_min_um,
            full.row.approach_max_um
        ),
        plot: json!({ "data": data, "layout": layout }),
        aspect: 0.85,
    })
}

/// Servo errors of every structure at 100 %.
fn structures(done: &[Done]) -> Option<Figure> {
    let (mut data, mut largest) = (Vec::new(), Vec::new());
    for (structure, color) in STRUCTURES.into_iter().zip(COLORS) {
        let done = found(done, structure, 100.0)?;
        let um = micrometres(done.row.approach_max_um.max(-done.row.approach_min_um));
        largest.push(format!("{} {um} µm", name(structure)));
        let panel = if structure == Feedforward::None { "y" } else { "y2" };
        data.push(curve(done, name(structure), color, ("x", panel), |at| at.error_um));
    }
    let mut layout = json!({
        "xaxis": { "anchor": "y2", "title": { "text": "time (s)" } },
        "yaxis": { "domain": [0.72, 1.0], "title": { "text": "none (µm)" } },
        "yaxis2": { "domain": [0.0, 0.66], "title": { "text": "the others (µm)" } },
    });
    layout["shapes"] = band("y2");
    Some(Figure {
        title: "Servo errors of the structures at 100 %".into(),
        caption: "Above, on its own scale, the position loop alone: its error is the speed over the gain. Below, the \
                  others; dashed the published band. Speed alone leaves an error in the shape of the acceleration; \
                  differences of positions of 1 µm add noise."
            .into(),
        alt: format!("Servo errors over time. Largest: {}.", largest.join(", ")),
        plot: json!({ "data": data, "layout": layout }),
        aspect: 0.6,
    })
}

/// Torques of the published structure and of the one that is used.
fn torques(done: &[Done]) -> Option<Figure> {
    let drawn = [(Feedforward::DifferenceVa, ORANGE), (Feedforward::Full, BLUE)].map(|(structure, color)| {
        let done = found(done, structure, 100.0)?;
        let label = format!("{}, noise {:.2} N·m", name(structure), done.row.torque_noise_nm);
        Some(curve(done, &label, color, ("x", "y"), |at| at.torque_nm))
    });
    Some(Figure {
        title: "Torque of X at 100 %".into(),
        caption: "Measured torque of the motor. Positions of 1 µm, differenced twice, make steps of acceleration that \
                  the motor turns into noise and heat; the law itself needs a smooth torque. Noise: root of the mean \
                  square of the change from cycle to cycle in the approach."
            .into(),
        alt: "Torque over time: ragged with differences, smooth with the full structure.".into(),
        plot: json!({
            "data": drawn.into_iter().collect::<Option<Vec<_>>>()?,
            "layout": { "xaxis": axis("time (s)"), "yaxis": axis("torque (N·m)") },
        }),
        aspect: 0.42,
    })
}

/// Largest magnitude of the error in the approach over the override.
fn over_override(done: &[Done]) -> Figure {
    let drawn = STRUCTURES.into_iter().zip(COLORS).map(|(structure, color)| {
        let rows = done.iter().map(|done| &done.row);
        let points: Vec<_> = rows
            .filter(|row| row.structure == structure && !row.tuned)
            .map(|row| (row.override_pct, row.approach_max_um.max(-row.approach_min_um)))
            .collect();
        let mut drawn = line(&points, name(structure), color, ("x", "y"));
        drawn["mode"] = json!("lines+markers");
        drawn
    });
    let mut y = axis("largest servo error (µm)");
    y["type"] = json!("log");
    Figure {
        title: "Largest servo error in the approach, over the override".into(),
        caption: "What is missing in a feedforward of acceleration shrinks with the square of the speed; noise of the \
                  encoder and breaking away of friction do not shrink."
            .into(),
        alt: "One curve a structure, on a logarithmic scale; their figures are in the table of every case.".into(),
        plot: json!({
            "data": drawn.collect::<Vec<_>>(),
            "layout": { "xaxis": axis("spindle override (%)"), "yaxis": y, "shapes": [level("y", BAND_UM)] },
        }),
        aspect: 0.45,
    }
}
