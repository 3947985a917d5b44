//! Pictures of errors: over the step, accumulated along a path, the feed, and the m of the published
//! correction. In: what was computed. Out: figures in µm, mm, %.

use serde_json::{Value, json};
use shape::{Correction, Section};

use super::{Computed, Row, SCALES, maps, name, steps, work::Work};
use report::{
    paint::{BLUE, Figure, GREEN, GREY, ORANGE, PURPLE, axis, line},
    table::six,
};

pub(super) fn color(correction: Correction) -> &'static str {
    match correction {
        Correction::None => GREY,
        Correction::Published => ORANGE,
        Correction::PublishedSigns => PURPLE,
        Correction::Mixed => GREEN,
        Correction::Exact => BLUE,
    }
}

pub(super) fn all(computed: &Computed) -> Vec<Figure> {
    let pictures = [maps::parts(computed), over_step(computed)];
    let single = [accumulated(computed), maps::errors(computed), feed(computed), exact_m(computed)];
    pictures.into_iter().chain(single.into_iter().flatten()).collect()
}

/// A line of a correction, its values in six digits however small they are.
fn curve(correction: Correction, points: &[(f64, f64)], axes: (&str, &str), in_legend: bool) -> Value {
    let mut curve = line(points, name(correction), color(correction), axes);
    curve["y"] = points.iter().map(|(_, y)| json!(six(*y).parse::<f64>().ok())).collect();
    curve["legendgroup"] = json!(name(correction));
    curve["showlegend"] = json!(in_legend);
    curve["line"]["simplify"] = json!(false);
    if correction == Correction::Published {
        curve["line"]["dash"] = json!("dash");
    }
    curve
}

pub(super) fn logarithmic(title: &str) -> Value {
    json!({ "title": { "text": title }, "type": "log", "exponentformat": "power" })
}

/// Title over one of several plots of a picture.
pub(super) fn heading(text: &str, x: f64, y: f64) -> Value {
    json!({ "text": text, "xref": "paper", "yref": "paper", "x": x, "y": y, "xanchor": "center", "yanchor": "bottom",
            "showarrow": false })
}

/// The works whose errors are drawn over the step.
const OVER_STEP: [&str; 3] = ["c1", "quad_twist", "wave"];

fn over_step(computed: &Computed) -> Figure {
    let mut data = Vec::new();
    let mut layout = json!({ "annotations": [] });
    let headings = OVER_STEP.iter().enumerate().map(|(at, work)| {
        let left = 0.35 * at as f64;
        let suffix = if at == 0 { String::new() } else { (at + 1).to_string() };
        for correction in Correction::ALL {
            let rows =
                computed.rows.iter().filter(|row| row.surface == *work && row.correction == correction);
            let points: Vec<_> = rows.map(|row: &Row| (row.h_mm, row.max_next_point_um.max(1e-13))).collect();
            let mut drawn =
                curve(correction, &points, (&format!("x{suffix}"), &format!("y{suffix}")), at == 0);
            drawn["mode"] = json!("lines+markers");
            data.push(drawn);
        }
        let mut x = logarithmic("step (mm)");
        x["domain"] = json!([left, left + 0.28]);
        x["anchor"] = json!(format!("y{suffix}"));
        let ticks = computed.rows.iter().filter(|row| row.surface == *work).map(|row| row.h_mm);
        x["tickvals"] = ticks.take(SCALES.len()).collect();
        x["tickformat"] = json!(".3~f");
        let mut y = logarithmic(if at == 0 { "error of the next point (µm)" } else { "" });
        y["range"] = json!([-13.5, 2.5]);
        y["dtick"] = json!(2);
        y["anchor"] = json!(format!("x{suffix}"));
        layout[format!("xaxis{suffix}")] = x;
        layout[format!("yaxis{suffix}")] = y;
        heading(work, left + 0.14, 1.0)
    });
    layout["annotations"] = headings.collect();
    Figure {
        title: "Error of the next point over the step".into(),
        caption: "Largest over the work; both axes logarithmic. Falling by two decades in a decade of the step: the ratio \
                  has an error of the first order, as without correction. Three decades: of the second. Flat at the \
                  bottom: rounding. Good: a correction that is steeper than none; published, with its minus sign, \
                  is parallel to it and above."
            .into(),
        alt: "Three plots of error over step. On the curve published, published-signs and mixed lie on each other and are \
              steeper than none; on quad_twist published lies above none, only mixed is steeper; exact is at 1e-10 µm \
              or less in all."
            .into(),
        plot: json!({ "data": data, "layout": layout }),
        aspect: 0.5,
    }
}

/// The errors that add up on the way over one surface.
fn accumulated(computed: &Computed) -> Option<Figure> {
    let work = computed.work("sin_cos")?;
    let sums = |correction| {
        let (_, sums) = steps::misses(work, correction, work.text.h_mm, true);
        sums.into_iter().map(|(t, error)| (t, 1e3 * error)).collect::<Vec<_>>()
    };
    let upper = Correction::ALL.map(|correction| curve(correction, &sums(correction), ("x", "y"), true));
    let fine = [Correction::PublishedSigns, Correction::Mixed, Correction::Exact];
    let lower = fine.map(|correction| curve(correction, &sums(correction), ("x", "y2"), false));
    Some(Figure {
        title: "Errors add up if ratios are summed".into(),
        caption: format!(
            "Height over the surface on the path of sin_cos, steps of {} mm, each with the ratio of its reference \
             point, added up from the first on; below, the three corrections with a scale of their own. Good: near \
             zero. A step that starts from the exact reference point has the error of one step alone, which is why \
             the interpolator starts each there.",
            work.text.h_mm
        ),
        alt: "Deviation over X. Without correction and with the published one it grows to tens of micrometres, with \
              the mixed term to a fraction of one."
            .into(),
        plot: json!({
            "data": upper.into_iter().chain(lower).collect::<Vec<_>>(),
            "layout": {
                "xaxis": { "anchor": "y2", "title": { "text": "X (mm)" } },
                "yaxis": { "domain": [0.54, 1.0], "title": { "text": "deviation (µm)" } },
                "yaxis2": { "domain": [0.0, 0.46], "title": { "text": "deviation (µm)" } },
            },
        }),
        aspect: 0.7,
    })
}

fn feed(computed: &Computed) -> Option<Figure> {
    let work = computed.work("sin_cos")?;
    let of = |correction| {
        let feed = steps::feed(work, correction, work.text.h_mm, true);
        let points: Vec<_> = feed.into_iter().map(|(t, error)| (t, 100.0 * error)).collect();
        curve(correction, &points, ("x", "y"), true)
    };
    Some(Figure {
        title: "How constant the feed is".into(),
        caption: format!(
            "Way along the path of sin_cos in a cycle, less the {} mm that are asked for. The step of the master is S_X \
             (M45) with the ratios of each correction. Good: zero; without correction the feed is too high where the \
             path becomes steeper and too low where it becomes flatter.",
            work.text.h_mm
        ),
        alt: "Error of the feed over X in per cent; largest without correction and with the published one, least with \
              exact ratios."
            .into(),
        plot: json!({
            "data": Correction::ALL.map(of),
            "layout": { "xaxis": axis("X (mm)"), "yaxis": axis("feed less the one asked for (%)") },
        }),
        aspect: 0.45,
    })
}

/// The m of M38 that would have been right on a curve, and its series.
fn exact_m(computed: &Computed) -> Option<Figure> {
    let work: &Work = computed.work("c1")?;
    let h = work.text.h_mm;
    let mut lines = [Vec::new(), Vec::new()];
    for n in 0..200 {
        let t = work.text.t[0] + 0.1 * f64::from(n);
        let (from, to) = (work.point(t), work.point(t + h));
        let path = work.path(t);
        let section = Section::of(&path[0], &path[2]);
        // Where the curve is straight no m is right, and its series has a pole.
        if section.curvature().abs() > 2e-3 {
            lines[0].push((t, section.exact_m(h, (to[2] - from[2]) / h)));
            lines[1].push((t, section.series_m(h)));
        } else {
            lines.iter_mut().for_each(|line| line.push((t, f64::NAN)));
        }
    }
    let drawn = |points: &[(f64, f64)], name: &str, color: &str, dash: &str| {
        let mut drawn = line(points, name, color, ("x", "y"));
        drawn["line"]["dash"] = json!(dash);
        drawn
    };
    Some(Figure {
        title: "The m that would be exact".into(),
        caption: format!(
            "m of M38 on c1 with steps of {h} mm, and its series to the first order. The published method leaves \
             m open; ½ is right in the limit of small steps and on a circle, and what is missing to the exact m is the \
             error that remains with right signs. Near a point of inflection there is no m."
        ),
        alt: "m over X, between 0.3 and 0.7 with poles at two points of inflection; its series lies on it."
            .into(),
        plot: json!({
            "data": [
                drawn(&lines[0], "exact", BLUE, "solid"),
                drawn(&lines[1], "½ + h (f‴/6f″ − f′f″/4(1 + f′²))", ORANGE, "dash"),
            ],
            "layout": {
                "xaxis": axis("X (mm)"), "yaxis": { "title": { "text": "m" }, "range": [0.2, 0.8] },
                "shapes": [{ "type": "line", "xref": "paper", "x0": 0, "x1": 1, "y0": 0.5, "y1": 0.5,
                             "line": { "color": GREY, "width": 1, "dash": "dot" } }],
            },
        }),
        aspect: 0.45,
    })
}
