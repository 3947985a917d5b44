//! Pictures of the ramps and blocks. In: rows. Out: for each example s, v, a, j, dj over time, one above the
//! other; for the blocks their feed over time. Way in mm and feed in mm/s, the rest in m and s.

use motion::{FeedBlock, Sample};
use serde_json::{Value, json};

use super::{Row, name};
use report::{
    paint::{BLUE, Figure, GREEN, GREY, ORANGE, axis, line},
    table::six,
};

/// Points of a curve.
const POINTS: usize = 361;

/// One of the pictures above each other: title of its axis, and its value.
type Quantity = (&'static str, fn(&Sample) -> f64);

const QUANTITIES: [Quantity; 5] = [
    ("s (mm)", |at| 1e3 * at.s),
    ("v (mm/s)", |at| 1e3 * at.v),
    ("a (m/s²)", |at| at.a),
    ("j (m/s³)", |at| at.j),
    ("dj/dt (m/s⁴)", |at| at.dj),
];

/// A figure for each example, and one for the blocks.
pub(super) fn all(rows: &[Row]) -> Vec<Figure> {
    let (examples, blocks): (Vec<&Row>, Vec<&Row>) = rows.iter().partition(|row| row.example.is_some());
    examples.into_iter().map(example).chain([feeds(&blocks)]).collect()
}

/// A quantity over the time of a block.
fn points(block: &FeedBlock, of: fn(&Sample) -> f64) -> Vec<(f64, f64)> {
    let step = block.duration() / (POINTS - 1) as f64;
    (0..POINTS).map(|n| n as f64 * step).map(|t| (t, of(&block.at(t)))).collect()
}

fn example(row: &Row) -> Figure {
    let start = &row.start;
    let mut data = Vec::new();
    let mut layout = json!({
        "xaxis": { "anchor": "y5", "title": { "text": "time (s)" } },
        "showlegend": false,
        "shapes": ([start.t1, start.t2].map(upright)),
    });
    for (index, (title, of)) in QUANTITIES.into_iter().enumerate() {
        let number = if index == 0 { String::new() } else { (index + 1).to_string() };
        let top = 1.0 - 0.205 * index as f64;
        layout[format!("yaxis{number}")] =
            json!({ "domain": [top - 0.18, top], "title": { "text": title }, "nticks": 4 });
        let mut curve = line(&points(&row.block, of), title, BLUE, ("x", &format!("y{number}")));
        curve["line"]["simplify"] = json!(false);
        data.push(curve);
    }
    Figure {
        title: format!("{}: from {} to {} mm/s", capital(&name(row)), six(1e3 * row.f0), six(1e3 * row.f)),
        caption: format!(
            "Way, feed, acceleration, jerk, and rate of the jerk. Dotted: t1 = {} s, where the first pulse of jerk ends, \
             and t2 = {} s, where the second begins{}. Peaks (and limits): {} ({}) m/s², {} ({}) m/s³, {} ({}) m/s⁴. \
             The bound of this ramp: {}. Good: no curve has a step.",
            six(start.t1),
            six(start.t2),
            if start.t1 == start.t2 { " (the same: the acceleration is never constant)" } else { "" },
            six(start.a_peak),
            six(row.a_max),
            six(start.j_p),
            six(row.j_max),
            six(start.dj_peak),
            six(row.dj_max),
            start.bound.unwrap_or("nothing")
        ),
        alt: format!(
            "Way, feed, acceleration, jerk and jerk rate over {} s, one above the other, all without steps.",
            six(row.total_time_s)
        ),
        plot: json!({ "data": data, "layout": layout }),
        aspect: 0.95,
    }
}

fn upright(t: f64) -> Value {
    json!({ "type": "line", "xref": "x", "yref": "paper", "x0": t, "x1": t, "y0": 0, "y1": 1,
            "line": { "color": GREY, "width": 1, "dash": "dot" } })
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

fn feeds(blocks: &[&Row]) -> Figure {
    let named = |row: &Row| {
        let [f0, f, f_end, length] = [row.f0, row.f, row.f_end, row.length_m].map(|value| six(1e3 * value));
        format!("{f0} → {f} → {f_end} mm/s over {length} mm")
    };
    let styles = [(BLUE, "solid"), (ORANGE, "dash"), (GREEN, "solid"), (GREY, "solid")];
    let curves = blocks.iter().zip(styles.into_iter().cycle()).map(|(row, (color, dash))| {
        let mut curve = line(&points(&row.block, |at| 1e3 * at.v), &named(row), color, ("x", "y"));
        curve["line"] = json!({ "color": color, "dash": dash, "width": 2, "simplify": false });
        curve
    });
    Figure {
        title: "Blocks: feed over time".into(),
        caption: "Feed at the start, programmed, and at the end. A block that is long enough reaches its programmed feed \
                  and keeps it; a shorter one turns round at the highest feed from which it can still reach its end feed."
            .into(),
        alt: format!("Feed over time of {} blocks, each a ramp, a stretch at constant feed if any, a ramp.", blocks.len()),
        plot: json!({
            "data": curves.collect::<Vec<_>>(),
            "layout": { "xaxis": axis("time (s)"), "yaxis": axis("feed (mm/s)") },
        }),
        aspect: 0.45,
    }
}
