//! Pictures of what is needed and what there is. In: what was asked. Out: figures.

use adviser::{
    resolution::{Counts, double_mm},
    tolerance::Grade,
};
use protocol::Position;
use serde_json::{Value, json};

use super::{Asked, needs::AxisNeeds, needs::QUANTITIES};
use report::{
    paint::{BLUE, Figure, GREEN, GREY, ORANGE},
    table::{six, three},
};

/// Points of a curve.
const POINTS: u32 = 60;

/// One picture of steps for each kind of axis, the feed, and the grades.
pub(super) fn all(asked: &Asked) -> Vec<Figure> {
    let groups = asked.groups();
    let steps = groups.iter().map(|(needs, names)| steps(needs, names));
    let feed = groups.first().map(|(needs, names)| feed(asked, needs, names));
    steps.chain(feed).chain(grades(asked)).collect()
}

/// Values over the four quantities.
fn over(values: &[Option<f64>; 4], name: &str, color: &str, dash: &str) -> Value {
    json!({ "type": "scatter", "mode": "lines+markers", "name": name, "x": QUANTITIES, "y": values,
            "line": { "color": color, "width": 1.5, "dash": dash }, "marker": { "color": color, "size": 8 } })
}

fn curve(points: &[(f64, f64)], name: &str, color: &str) -> Value {
    let (x, y): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
    json!({ "type": "scatter", "mode": "lines", "name": name, "x": x, "y": y,
            "line": { "color": color, "width": 1.5 } })
}

fn log_axis(title: &str, dtick: u32) -> Value {
    json!({ "title": { "text": title }, "type": "log", "exponentformat": "power", "dtick": dtick })
}

fn steps(needs: &AxisNeeds, names: &str) -> Figure {
    let unit = needs.unit();
    let f = needs.demand.cycle_hz;
    let needed = needs.required.steps().map(Some);
    let count = [Some(needs.encoder.increment_mm()); 4];
    let wire = [Some(1.0 / Position::PER_MM); 4];
    let [v, a, j] = needs.limits();
    let doubles =
        [None, Some(double_mm(v) / f), Some(double_mm(a) / f.powi(2)), Some(double_mm(j) / f.powi(3))];
    Figure {
        title: format!("Steps that are needed, and steps there are: {names}"),
        caption: format!(
            "Steps per cycleⁿ. Whatever lies on or below the blue line is fine enough. Differences of counts have the step \
             of a count in every quantity (orange), those of positions on the wire 1e-9 {unit} (green); what the law gives \
             in double precision is the grey line."
        ),
        alt: format!(
            "Steps of position, speed, acceleration and jerk that {names} needs, beside those there are."
        ),
        plot: json!({
            "data": [
                over(&needed, "needed", BLUE, "solid"),
                over(&count, &format!("one count, {} {unit}", three(needs.encoder.increment_mm())), ORANGE, "dash"),
                over(&wire, &format!("position on the wire, 1e-9 {unit}"), GREEN, "dash"),
                over(&doubles, "law in double precision", GREY, "dot"),
            ],
            "layout": { "xaxis": { "type": "category" }, "yaxis": log_axis(&format!("step ({unit}/cycleⁿ)"), 3) },
        }),
        aspect: 0.5,
    }
}

/// What whole counts per cycle make of a feed: one count of it, from slow feeds to the highest.
fn feed(asked: &Asked, needs: &AxisNeeds, names: &str) -> Figure {
    let (unit, highest) = (needs.unit(), needs.demand.feed_mm_min);
    let feeds =
        (0..=POINTS).map(|n| highest * libm::pow(10.0, 5.0 * (f64::from(n) / f64::from(POINTS) - 1.0)));
    let envelope = |per_mm: f64| {
        let counts = Counts { per_mm, ..needs.encoder };
        feeds.clone().map(|feed| (feed, counts.feed_error(feed).envelope_pct)).collect::<Vec<_>>()
    };
    let asked_for = feeds.clone().map(|feed| (feed, 100.0 * highest / (asked.steps.feed * feed)));
    Figure {
        title: format!("What a feed made by differences errs by: {names}"),
        caption: "One count per cycle, in per cent of the feed: the envelope of what is seen. The slower the feed, the worse. \
                  Blue: what is asked for, the highest feed divided by K_F."
            .into(),
        alt: "Error of a feed as differences of counts show it, over the feed, for three sizes of counts.".into(),
        plot: json!({
            "data": [
                curve(&asked_for.collect::<Vec<_>>(), "asked for", BLUE),
                curve(&envelope(needs.encoder.per_mm), "counts of the encoder", ORANGE),
                curve(&envelope(1e3), &format!("counts of 1e-3 {unit}"), GREY),
                curve(&envelope(Position::PER_MM), &format!("counts of 1e-9 {unit}"), GREEN),
            ],
            "layout": { "xaxis": log_axis(&format!("feed ({unit}/min)"), 1), "yaxis": log_axis("error (%)", 2) },
        }),
        aspect: 0.5,
    }
}

/// Steps of position over the grades at the size of the parts.
fn grades(asked: &Asked) -> Option<Figure> {
    let (grade, size_mm) = asked.parts.grade?;
    let needs = asked.axes.iter().find(|needs| needs.unit() == "mm")?;
    let of = |grade: Grade| {
        Some((grade.to_string(), grade.tolerance_um(size_mm).ok()? / (1e3 * asked.steps.tolerance)))
    };
    let (names, steps): (Vec<_>, Vec<_>) = Grade::all().filter_map(of).unzip();
    let colors: Vec<_> =
        names.iter().map(|name| if *name == grade.to_string() { BLUE } else { GREY }).collect();
    let count = vec![needs.position_step(); names.len()];
    let what =
        if needs.axis.is_some() { format!("one count of {}", needs.name()) } else { "one count".into() };
    Some(Figure {
        title: format!("Step of position for each grade at {size_mm} mm"),
        caption: format!(
            "Standard tolerance of ISO 286-1 divided by {}. Blue: the grade that is asked for. A count below a point is fine \
             enough for its grade.",
            six(asked.steps.tolerance)
        ),
        alt: format!("Step of position that each tolerance grade needs at {size_mm} mm, and one count."),
        plot: json!({
            "data": [
                { "type": "scatter", "mode": "markers", "name": "needed", "x": names, "y": steps,
                  "marker": { "color": colors, "size": 9 } },
                { "type": "scatter", "mode": "lines", "name": what, "x": names, "y": count,
                  "line": { "color": ORANGE, "width": 1.5, "dash": "dash" } },
            ],
            "layout": { "xaxis": { "type": "category" }, "yaxis": log_axis("step (mm)", 1) },
        }),
        aspect: 0.5,
    })
}
