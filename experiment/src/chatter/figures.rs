//! Pictures of the experiment. In: rows, threads. Out: the chart, what the variation gains, the threads.

use serde_json::json;

use report::paint::{BLUE, Figure, GREEN, GREY, ORANGE, axis, line};

use super::{ASKED, MODE, NAMED_RPM, Row, STIFFNESS_N_MM2, lathe::Thread, lobes};

/// Speeds at which the lobes are drawn.
const DRAWN: u32 = 1500;
/// Highest width of the chart, mm.
const TOP_MM: f64 = 6.0;

pub(super) fn all(rows: &[Row], threads: &[Thread]) -> Vec<Figure> {
    vec![chart(rows), gains(rows), courses(threads)]
}

fn points(rows: &[Row], of: fn(&Row) -> f64) -> Vec<(f64, f64)> {
    rows.iter().map(|row| (row.rpm, of(row))).collect()
}

fn speeds() -> serde_json::Value {
    let mut speeds = axis("spindle speed (1/min)");
    speeds["type"] = json!("log");
    speeds["tickvals"] = json!([100, 150, 200, 300, 400, 600, 800, 1200, 2000, 3000]);
    speeds
}

fn chart(rows: &[Row]) -> Figure {
    let (first, last) = (rows.first().map_or(90.0, |row| row.rpm), rows.last().map_or(3000.0, |row| row.rpm));
    let lobes: Vec<(f64, f64)> = (0..=DRAWN)
        .map(|n| first * libm::pow(last / first, f64::from(n) / f64::from(DRAWN)))
        .map(|rpm| (rpm, lobes::limit_mm(&MODE, STIFFNESS_N_MM2, rpm)))
        .collect();
    let mut even = line(&points(rows, |row| row.even_mm), "model, even speed", BLUE, ("x", "y"));
    even["mode"] = json!("markers");
    even["marker"] = json!({ "color": BLUE, "size": 5 });
    let mut depth = axis("widest stable chip (mm)");
    depth["range"] = json!([0.0, TOP_MM]);
    let data = [
        line(&lobes, "lobes, calculated", GREY, ("x", "y")),
        even,
        line(&points(rows, |row| row.sine_mm), "model, sine", ORANGE, ("x", "y")),
        line(&points(rows, |row| row.random_mm), "model, random", GREEN, ("x", "y")),
    ];
    Figure {
        title: "Stability chart: width of the chip over the speed".into(),
        caption: format!(
            "Below a curve a swing dies away, above it grows. Grey: lobes of one mode, calculated. Blue: the plant's \
             model at an even speed; good: on the grey line. Orange and green: at a speed that is varied as strongly as \
             the drive can, ±30 % where it can. Left, where many waves lie in a turn, the orange line is above the \
             grey one; right, where the drive can hardly vary a fast spindle, it lies on it. The chart ends at {TOP_MM} mm."
        ),
        alt: "Stable width over spindle speed: grey lobes rising to the right, blue points on them, an orange line \
              above them at slow speeds and on them at fast ones."
            .into(),
        plot: json!({ "data": data, "layout": { "xaxis": speeds(), "yaxis": depth } }),
        aspect: 0.5,
    }
}

fn gains(rows: &[Row]) -> Figure {
    let level = |y: f64| {
        json!({ "type": "line", "xref": "paper", "yref": "y", "x0": 0, "x1": 1, "y0": y, "y1": y,
                "line": { "color": GREY, "width": 1, "dash": "dash" } })
    };
    let triangle = points(rows, |row| row.triangle_mm / row.even_mm);
    let data = [
        line(&points(rows, |row| row.gain), "sine", ORANGE, ("x", "y")),
        line(&triangle, "triangle", BLUE, ("x", "y")),
        line(&points(rows, |row| row.random_mm / row.even_mm), "random", GREEN, ("x", "y")),
    ];
    Figure {
        title: "What the variation gains".into(),
        caption: format!(
            "The stable width at the varied speed over that at the even one. Dashed: 1, where nothing is gained, and \
             {ASKED}, what is asked for at S{NAMED_RPM}."
        ),
        alt: "Ratio of stable widths over spindle speed, high at slow speeds, near one at fast ones.".into(),
        plot: json!({
            "data": data,
            "layout": { "xaxis": speeds(), "yaxis": axis("varied : even"), "shapes": [level(1.0), level(ASKED)] },
        }),
        aspect: 0.4,
    }
}

fn courses(threads: &[Thread]) -> Figure {
    let data = threads.iter().map(|thread| {
        let (name, color) = if thread.varied { ("varied speed", ORANGE) } else { ("even speed", BLUE) };
        line(&thread.course, name, color, ("x", "y"))
    });
    Figure {
        title: "The tool in the thread".into(),
        caption: format!(
            "The place of the tool across the groove, less its mean, in the pass of each thread that swings most, on \
             the whole lathe at S{NAMED_RPM}."
        ),
        alt: "Depth of the tool over turns: a swing that grows at the even speed, and hardly any at the varied one."
            .into(),
        plot: json!({
            "data": data.collect::<Vec<_>>(),
            "layout": { "xaxis": axis("turns at full depth"), "yaxis": axis("tool beside its mean (µm)") },
        }),
        aspect: 0.4,
    }
}
