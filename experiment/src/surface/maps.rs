//! Pictures seen from above: the parts with the paths on them, and where on a part the errors are. In: what
//! was computed. Out: figures in mm, µm.

use serde_json::{Value, json};
use shape::Correction;

use super::{Computed, figures::heading, name, steps::Step, work::Work};
use report::colours::{AMOUNT, GREY, INK, ORANGE, RELIEF};
use report::paint::Figure;

/// Places of a grid along each side.
const GRID: u32 = 60;

/// Places along a path.
const POINTS: u32 = 240;

/// Lower left corners of four plots, and their size: shares of the picture.
const CORNERS: [[f64; 2]; 4] = [[0.0, 0.56], [0.54, 0.56], [0.0, 0.0], [0.54, 0.0]];
const SIZE: [f64; 2] = [0.42, 0.38];

/// Domains of the parts that are drawn: X, then Y, mm.
const PARTS: [(&str, [f64; 2], [f64; 2]); 4] = [
    ("quad_twist", [-12.0, 2.0], [-4.0, 8.0]),
    ("sin_cos", [-5.0, 15.0], [-10.0, 10.0]),
    ("saddle", [-24.0, 24.0], [-20.0, 20.0]),
    ("wave", [0.0, 100.0], [0.0, 80.0]),
];

fn between([low, high]: [f64; 2]) -> Vec<f64> {
    (0..=GRID).map(|n| low + (high - low) * f64::from(n) / f64::from(GRID)).collect()
}

/// Names of the axes number `at`, for a trace.
fn axes(at: usize) -> [String; 2] {
    let suffix = if at == 0 { String::new() } else { (at + 1).to_string() };
    ["x", "y"].map(|axis| format!("{axis}{suffix}"))
}

/// Four plots seen from above, both axes of each at the same scale.
fn layout(headings: [String; 4]) -> Value {
    let mut layout = json!({ "annotations": [], "showlegend": false });
    let headings = headings.iter().zip(CORNERS).enumerate().map(|(at, (text, [left, bottom]))| {
        let [x, y] = axes(at);
        layout[x.replace('x', "xaxis")] =
            json!({ "title": { "text": "X (mm)" }, "domain": [left, left + SIZE[0]], "anchor": y, "showgrid": false,
                    "constrain": "domain" });
        layout[y.replace('y', "yaxis")] = json!({ "title": { "text": "Y (mm)" }, "domain": [bottom, bottom + SIZE[1]],
            "anchor": x, "scaleanchor": x, "showgrid": false, "constrain": "domain" });
        heading(text, left + 0.5 * SIZE[0], bottom + SIZE[1])
    });
    layout["annotations"] = headings.collect();
    layout
}

/// A number for a page, five digits behind the point.
fn short(value: f64) -> Value {
    json!(value.is_finite().then(|| (value * 1e5).round() / 1e5))
}

/// Contour lines of a function over a domain.
fn contour(at: usize, [x, y]: [&[f64]; 2], z: &[Vec<Value>]) -> Value {
    let [x_axis, y_axis] = axes(at);
    json!({ "type": "contour", "x": x, "y": y, "z": z, "xaxis": x_axis, "yaxis": y_axis, "hoverinfo": "x+y+z" })
}

/// The parts as contour lines, with the paths of the experiment on them.
pub(super) fn parts(computed: &Computed) -> Figure {
    let mut data = Vec::new();
    let mut headings: [String; 4] = Default::default();
    for (at, (name, x, y)) in PARTS.into_iter().enumerate() {
        let Some(work) = computed.work(name) else { continue };
        let (xs, ys) = (between(x), between(y));
        let row = |y: &f64| xs.iter().map(|x| short(work.height([*x, *y]).0)).collect();
        let heights: Vec<Vec<Value>> = ys.iter().map(row).collect();
        let mut lines = contour(at, [&xs, &ys], &heights);
        lines["colorscale"] = json!(RELIEF);
        lines["showscale"] = json!(false);
        lines["contours"] = json!({ "showlabels": true, "labelfont": { "size": 10, "color": INK } });
        lines["line"] = json!({ "color": GREY, "width": 0.7 });
        data.push(lines);
        data.push(path(work, at));
        let text = work.text;
        headings[at] = match text.ball_mm {
            0.0 => format!("{name}: z = {}", text.psi),
            ball => format!("{name}, under a ball of {ball} mm"),
        };
    }
    Figure {
        title: "The parts and the paths on them".into(),
        caption: "Seen from above: lines of equal height with their height in mm, light is high, and the path of the tool \
                  in orange. Of wave the surface is drawn on which the tip of the ball moves, not the part."
            .into(),
        alt: "Four maps with contour lines: a twisted saddle, a wave, a saddle with an elliptic path around its middle, \
              and a trough with waves that rises to 200 mm at its right side."
            .into(),
        plot: json!({ "data": data, "layout": layout(headings) }),
        aspect: 0.9,
    }
}

/// The path of a work, seen from above.
fn path(work: &Work, at: usize) -> Value {
    let [from, to] = work.text.t;
    let points = (0..=POINTS).map(|n| work.point(from + (to - from) * f64::from(n) / f64::from(POINTS)));
    let (x, y): (Vec<_>, Vec<_>) = points.map(|[x, y, _]| (short(x), short(y))).unzip();
    let [x_axis, y_axis] = axes(at);
    json!({ "type": "scatter", "mode": "lines", "x": x, "y": y, "xaxis": x_axis, "yaxis": y_axis, "name": "path",
            "line": { "color": ORANGE, "width": 2.5 }, "hoverinfo": "skip" })
}

/// Direction of the steps of the map of errors, seen from above.
const DIRECTION: [f64; 2] = [0.8, 0.6];

/// Where on the wave each correction misses the next point.
pub(super) fn errors(computed: &Computed) -> Option<Figure> {
    let work = computed.work("wave")?;
    let (_, x, y) = PARTS.into_iter().find(|part| part.0 == "wave")?;
    let (xs, ys) = (between(x), between(y));
    let shown = [Correction::None, Correction::Published, Correction::PublishedSigns, Correction::Mixed];
    let mut data = Vec::new();
    for (at, correction) in shown.into_iter().enumerate() {
        // What is smaller than 1e-4 µm is drawn as that; it is a change of sign.
        let lg = |x: f64, y: f64| {
            let there = work.towards([x, y], DIRECTION);
            let error = Step::of(&there, correction, 0.0, work.text.h_mm, false).next(&there)[0];
            short(libm::log10((1e3 * error.abs()).max(1e-4)))
        };
        let row = |y: &f64| xs.iter().map(|x| lg(*x, *y)).collect();
        let logarithms: Vec<Vec<Value>> = ys.iter().map(row).collect();
        let mut map = contour(at, [&xs, &ys], &logarithms);
        map["type"] = json!("heatmap");
        map["coloraxis"] = json!("coloraxis");
        data.push(map);
    }
    let mut layout = layout(shown.map(|correction| name(correction).to_owned()));
    layout["coloraxis"] = json!({
        "colorscale": AMOUNT, "cmin": -3, "cmax": 1.3,
        "colorbar": { "title": { "text": "µm" }, "tickvals": [-3, -2, -1, 0, 1],
                      "ticktext": ["0.001", "0.01", "0.1", "1", "10"] },
    });
    Some(Figure {
        title: "Where on the wave the next point is missed".into(),
        caption: format!(
            "Magnitude of the error of the next point, along Z, of a step of {} mm from every place of the surface under \
             the ball, in the direction ({}, {}) seen from above; the axis with the largest way leads. Dark is good. \
             Where Z leads (right of about X = 30 mm) every follower is a plane curve over Z, which is printed right; \
             left of it X leads, and the corrections differ. Dark lines are places where the error changes its sign.",
            work.text.h_mm, DIRECTION[0], DIRECTION[1]
        ),
        alt: "Four maps of error over the surface. Without correction the error is some micrometres nearly everywhere, with \
              the published signs as much in the left part, with right signs about one; with the mixed term it is below \
              a tenth of a micrometre nearly everywhere."
            .into(),
        plot: json!({ "data": data, "layout": layout }),
        aspect: 0.9,
    })
}
