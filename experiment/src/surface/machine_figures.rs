//! Pictures of the wave on the whole machine: where the tip is off, what the corrections leave of the
//! commanded path, and the feed. In: runs. Out: figures in µm, mm, s, mm/min.

use serde_json::{Value, json};
use shape::Correction;

use super::{
    figures::{color, logarithmic},
    machine::{Run, STEP_MM},
    name,
};
use report::colours::{BLUE, EITHER_WAY, GREY, YELLOW};
use report::paint::{Figure, line};

/// Points of the map, of those that were kept.
const MAP_EVERY: usize = 3;

/// Time that is drawn, s: the first line there and a good part of the way back.
const SHOWN_S: f64 = 8.0;

pub(super) fn all(runs: &[Run]) -> Vec<Figure> {
    let exact = runs.iter().find(|run| run.correction == Correction::Exact);
    exact.map(|exact| vec![map(exact), over_time(runs, exact)]).unwrap_or_default()
}

fn short(value: f64) -> Value {
    json!((value * 1e3).round() / 1e3)
}

/// The way of the tip seen from above, in colours of its deviation.
fn map(run: &Run) -> Figure {
    let points = || run.curve.iter().step_by(MAP_EVERY);
    let column = |of: fn(&(f64, [f64; 2], rig::observe::Traced)) -> f64| -> Vec<Value> {
        points().map(|point| short(of(point))).collect()
    };
    let most = run.report.slide.max_abs_um();
    Figure {
        title: "Where the tool is off on the small mill".into(),
        caption: format!(
            "The tip of the ball seen from above, lines {STEP_MM} mm apart, with exact ratios. Colour: how far the ball \
             truly is from touching the surface; red stands off, blue cuts in, what is as the page is good. The largest magnitude is \
             {most:.2} µm."
        ),
        alt: format!(
            "Lines over the surface, coloured by the true deviation; largest {most:.2} µm, at the ends of lines and where \
             an axis reverses."
        ),
        plot: json!({
            "data": [{
                "type": "scatter", "mode": "markers", "x": column(|p| p.1[0]), "y": column(|p| p.1[1]),
                "marker": {
                    "size": 5, "color": column(|p| 1e3 * p.2.slide.deviation_mm), "cmin": -most, "cmax": most,
                    "colorscale": EITHER_WAY,
                    "colorbar": { "title": { "text": "µm" } },
                },
                "hovertemplate": "%{marker.color} µm<extra></extra>",
            }],
            "layout": {
                "xaxis": { "title": { "text": "X (mm)" }, "constrain": "domain" },
                "yaxis": { "title": { "text": "Y (mm)" }, "scaleanchor": "x", "constrain": "domain" },
                "showlegend": false,
            },
        }),
        aspect: 0.7,
    }
}

fn over_time(runs: &[Run], exact: &Run) -> Figure {
    let shown = |run: &Run, of: fn(&rig::observe::Traced) -> f64| -> Vec<(f64, f64)> {
        let points = run.curve.iter().take_while(|point| point.0 <= SHOWN_S);
        points.map(|(t, _, traced)| (*t, of(traced))).collect()
    };
    let mut data = Vec::new();
    for run in runs {
        // Zero has no logarithm; a setpoint on the wire is a whole number of 1e-6 µm.
        let off = shown(run, |traced| (1e3 * traced.commanded.deviation_mm.abs()).max(1e-5));
        let mut drawn = line(&off, name(run.correction), color(run.correction), ("x", "y"));
        drawn["line"]["width"] = json!(1.2);
        data.push(drawn);
    }
    let slide = shown(exact, |traced| 1e3 * traced.slide.deviation_mm);
    let mut drawn = line(&slide, "true, exact ratios", BLUE, ("x", "y2"));
    drawn["showlegend"] = json!(false);
    data.push(drawn);
    let mut feed =
        line(&shown(exact, |traced| traced.commanded.feed_mm_min), "commanded feed", GREY, ("x", "y3"));
    feed["line"]["width"] = json!(5);
    data.push(feed);
    data.push(line(&shown(exact, |traced| traced.slide.feed_mm_min), "true feed", YELLOW, ("x", "y3")));
    let mut commanded = logarithmic("commanded (µm)");
    commanded["domain"] = json!([0.72, 1.0]);
    commanded["dtick"] = json!(1);
    Figure {
        title: "Deviation and feed over time".into(),
        caption: format!(
            "The first {SHOWN_S} s. Above: magnitude of the deviation of what is commanded, with each correction; \
             logarithmic, less than 1e-5 µm is drawn as that. Between two setpoints it is also what the regulators \
             follow. Middle: true deviation with exact ratios. Below: feed along the path, commanded and true; it is lower \
             at the end of a line, where the path has a corner, and where a limit of an axis asks for it."
        ),
        alt: "Commanded deviation of five corrections on a logarithmic axis, true deviation of some micrometres at most, and \
              feed over time: flat at the programmed feed but for the ends of lines."
            .into(),
        plot: json!({
            "data": data,
            "layout": {
                "xaxis": { "anchor": "y3", "title": { "text": "time (s)" } },
                "yaxis": commanded,
                "yaxis2": { "domain": [0.37, 0.65], "title": { "text": "true (µm)" } },
                "yaxis3": { "domain": [0.0, 0.3], "title": { "text": "feed (mm/min)" }, "rangemode": "tozero" },
            },
        }),
        aspect: 0.85,
    }
}
