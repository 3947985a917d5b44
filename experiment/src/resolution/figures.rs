//! Pictures: servo error and torque noise over the quantum, an approach with three of them, and the error of
//! a feed. In: the rows and the passes of the first seed. Out: figures in mm, µm, N·m, s.

use adviser::resolution::Counts;
use machine::Machine;
use protocol::Axis;
use serde_json::{Value, json};

use super::{
    Row, Series,
    measure::{Measured, Moment, foretold},
    quantum,
    reference::PRINTED,
};
use report::{
    paint::{BLUE, Figure, GREEN, GREY, ORANGE, axis, line},
    table::six,
};

/// Quanta whose approach is drawn, mm.
const DRAWN_MM: [Option<f64>; 3] = [Some(1e-3), Some(1e-4), None];

pub(super) fn all(machine: &Machine, own: &Series) -> Vec<Figure> {
    vec![over_quantum(machine, &own.rows), approach(own), feed()]
}

/// A line through points on logarithmic axes, in six digits however small they are.
fn fine(points: &[(f64, f64)], name: &str, color: &str, axes: (&str, &str)) -> Value {
    let mut curve = line(points, name, color, axes);
    let digits = |value: f64| json!(six(value).parse::<f64>().ok());
    curve["x"] = points.iter().map(|point| digits(point.0)).collect();
    curve["y"] = points.iter().map(|point| digits(point.1)).collect();
    curve["line"]["simplify"] = json!(false);
    curve
}

fn marked(mut curve: Value, symbol: &str) -> Value {
    curve["mode"] = json!("lines+markers");
    curve["marker"] = json!({ "symbol": symbol, "size": 7 });
    curve
}

fn points_only(mut curve: Value) -> Value {
    curve["mode"] = json!("markers");
    curve["marker"] = json!({ "symbol": "diamond-open", "size": 10, "color": GREY });
    curve
}

fn dashed(mut curve: Value, dash: &str) -> Value {
    curve["line"]["dash"] = json!(dash);
    curve
}

fn logarithmic(title: &str) -> Value {
    json!({ "title": { "text": title }, "type": "log", "exponentformat": "power", "dtick": 1 })
}

fn over_quantum(machine: &Machine, rows: &[Row]) -> Figure {
    let of = |value: fn(&Row) -> f64| -> Vec<(f64, f64)> {
        rows.iter().filter_map(|row| Some((row.quantum_mm?, value(row)))).collect()
    };
    let without = |value: fn(&Row) -> f64| -> Vec<(f64, f64)> {
        let law = rows.iter().find(|row| row.quantum_mm.is_none()).map_or(0.0, value);
        rows.iter().filter_map(|row| Some((row.quantum_mm?, law))).collect()
    };
    let printed_error: Vec<(f64, f64)> = PRINTED
        .iter()
        .filter_map(|p| Some((p.quantum_mm?, p.approach_um[1].max(-p.approach_um[0]))))
        .collect();
    let printed_noise: Vec<(f64, f64)> =
        PRINTED.iter().filter_map(|p| Some((p.quantum_mm?, p.noise_nm))).collect();
    let rounding: Vec<(f64, f64)> = machine.axis.get(&Axis::X).map_or_else(Vec::new, |x| {
        let said = |(q, _): (f64, f64)| (q, foretold(x, machine.general.cycle_s, q));
        of(|_| 0.0).into_iter().map(said).filter(|(_, noise)| *noise > 1e-3).collect()
    });
    let highest: fn(&Row) -> f64 = |row| row.approach_highest_um.max(-row.approach_lowest_um);
    let (error, noise) = (("x", "y"), ("x", "y2"));
    let data = vec![
        marked(fine(&of(Row::approach_abs_um), "largest servo error, median", BLUE, error), "circle"),
        dashed(fine(&of(highest), "largest of any seed", BLUE, error), "dot"),
        dashed(fine(&without(Row::approach_abs_um), "the law itself", GREEN, error), "dash"),
        points_only(fine(&printed_error, "reference simulation", GREY, error)),
        marked(fine(&of(|row| row.torque_noise_nm), "torque noise", ORANGE, noise), "circle"),
        dashed(fine(&rounding, "rounding alone (M77)", GREY, noise), "dot"),
        quiet(dashed(fine(&without(|row| row.torque_noise_nm), "the law itself", GREEN, noise), "dash")),
        quiet(points_only(fine(&printed_noise, "reference simulation", GREY, noise))),
    ];
    let mut layout = json!({ "xaxis": logarithmic("quantum of position (mm)") });
    layout["xaxis"]["anchor"] = json!("y2");
    layout["yaxis"] = logarithmic("servo error (µm)");
    layout["yaxis"]["domain"] = json!([0.54, 1.0]);
    layout["yaxis2"] = logarithmic("torque noise (N·m)");
    layout["yaxis2"]["domain"] = json!([0.0, 0.46]);
    Figure {
        title: "Servo error and torque noise over the quantum".into(),
        caption: "Largest servo error of X in the approach, and rms step of the torque that the drive asks for. \
                  Diamonds: the reference simulation, under conditions of its own. Good: from some quantum on both \
                  curves are flat: then the resolution no longer matters. What is left of the error is the delay of the \
                  hold."
            .into(),
        alt: "Two falling curves over the quantum on logarithmic axes; servo error and torque noise are flat from 1e-5 \
              mm on."
            .into(),
        plot: json!({ "data": data, "layout": layout }),
        aspect: 0.85,
    }
}

fn quiet(mut curve: Value) -> Value {
    curve["showlegend"] = json!(false);
    curve
}

fn approach(own: &Series) -> Figure {
    let drawn = |of: fn(&Moment) -> f64, axes: (&'static str, &'static str), in_legend: bool| {
        let passes = own.rows.iter().zip(&own.first);
        let shown = passes.filter(|(row, _)| DRAWN_MM.contains(&row.quantum_mm));
        let styles = [(ORANGE, 1.0), (BLUE, 1.3), (GREEN, 2.0)];
        let curve = move |((row, pass), (color, width)): ((&Row, &Measured), (&str, f64))| {
            let points: Vec<_> = pass.curve.iter().map(|at| (at.t_s, of(at))).collect();
            let name = row.quantum_mm.map_or(quantum(row), |_| format!("{} mm", quantum(row)));
            let mut curve = line(&points, &name, color, axes);
            curve["line"]["width"] = json!(width);
            curve["showlegend"] = json!(in_legend);
            curve
        };
        shown.zip(styles).map(curve).collect::<Vec<_>>()
    };
    let error = drawn(|at| at.error_um, ("x", "y"), true);
    let torque = drawn(|at| at.torque_nm, ("x", "y2"), false);
    Figure {
        title: "An approach with rounded positions and without".into(),
        caption: "Servo error of X and the torque that its drive asks for, one pass. The torque shows what differences \
                  make of a count; the axis follows it only as fast as its mass lets it."
            .into(),
        alt: "Servo error and torque over the approach. With 1e-3 mm the torque jumps by several N·m in every step, \
              with 1e-4 mm by some tenths; with the law itself it is a smooth curve."
            .into(),
        plot: json!({
            "data": error.into_iter().chain(torque).collect::<Vec<_>>(),
            "layout": {
                "xaxis": { "anchor": "y2", "title": { "text": "time (s)" } },
                "yaxis": { "domain": [0.54, 1.0], "title": { "text": "servo error (µm)" } },
                "yaxis2": { "domain": [0.0, 0.46], "title": { "text": "torque (N·m)" } },
            },
        }),
        aspect: 0.75,
    }
}

fn feed() -> Figure {
    let counts = Counts { per_mm: 1000.0, cycle_hz: 1000.0 };
    let finer = Counts { per_mm: 10_000.0, ..counts };
    let feeds: Vec<f64> = (0..=2150).map(|n| libm::exp10(0.002 * f64::from(n))).collect();
    let of = |error: &dyn Fn(f64) -> f64| -> Vec<(f64, f64)> {
        feeds.iter().map(|feed| (*feed, error(*feed))).collect()
    };
    let all = ("x", "y");
    let low = of(&|feed| -counts.feed_error(feed).low_pct);
    let high = of(&|feed| counts.feed_error(feed).high_pct);
    let seen =
        |points: Vec<(f64, f64)>| points.into_iter().filter(|(_, pct)| *pct > 1e-3).collect::<Vec<_>>();
    let mut percent = axis("error of the feed (%)");
    (percent["type"], percent["range"], percent["dtick"]) = (json!("log"), json!([-2, 4]), json!(1));
    let mut over = axis("feed (mm/min)");
    (over["type"], over["dtick"]) = (json!("log"), json!(1));
    Figure {
        title: "A feed as differences of counts show it".into(),
        caption: "How far too fast and too slow a feed looks in a control of 1 µm and 1 ms: the difference of two \
                  positions is one of two whole numbers. Dashed: one count, which neither exceeds, for 1 µm and for \
                  0.1 µm. Below 60 mm/min it is nothing or too much."
            .into(),
        alt: "Error of a feed over the feed on logarithmic axes: two saw-toothed curves below a straight line that \
              falls from 6000 % at 1 mm/min to 0.3 % at 20000 mm/min."
            .into(),
        plot: json!({
            "data": [
                fine(&seen(high), "too fast by", ORANGE, all),
                fine(&seen(low), "too slow by", BLUE, all),
                dashed(fine(&of(&|f| counts.feed_error(f).envelope_pct), "one count of 1 µm", GREY, all), "dash"),
                dashed(fine(&of(&|f| finer.feed_error(f).envelope_pct), "one count of 0.1 µm", GREEN, all), "dash"),
            ],
            "layout": { "xaxis": over, "yaxis": percent },
        }),
        aspect: 0.5,
    }
}
