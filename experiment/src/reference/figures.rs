//! The picture: every figure of the reference over what it is here. In: rows. Out: one figure, in µm.

use serde_json::json;

use super::Row;
use report::paint::{BLUE, Figure, GREEN, GREY, ORANGE, axis, line};

/// Smallest and largest figure that is drawn, µm.
const RANGE_UM: [f64; 2] = [0.02, 1000.0];

/// Magnitudes here over those printed.
pub(super) fn beside(rows: &[Row]) -> Figure {
    let of = |which: &[usize], name: &str, color: &str| {
        let figures = rows.iter().flat_map(|row| which.iter().map(|index| &row.figures[*index]));
        let points: Vec<_> = figures.map(|figure| (figure.reference().abs(), figure.median.abs())).collect();
        let mut drawn = line(&points, name, color, ("x", "y"));
        drawn["mode"] = json!("markers");
        drawn
    };
    let mut equal = line(&RANGE_UM.map(|um| (um, um)), "equal", GREY, ("x", "y"));
    equal["line"]["dash"] = json!("dash");
    let logarithmic = |title: &str| {
        let mut axis = axis(title);
        axis["type"] = json!("log");
        axis["range"] = json!(RANGE_UM.map(libm::log10));
        axis
    };
    let agree = rows.iter().flat_map(|row| &row.figures).filter(|figure| figure.agrees()).count();
    Figure {
        title: "Every figure of the reference, and what it is here".into(),
        caption: "Magnitudes of all figures of the table on logarithmic scales; figures that were printed as 0 are \
                  left out. Dashed: equal."
            .into(),
        alt: format!("Points along a diagonal; {agree} of {} figures agree.", 4 * rows.len()),
        plot: json!({
            "data": [equal, of(&[0, 1], "approach", BLUE), of(&[2], "end", ORANGE), of(&[3], "thread", GREEN)],
            "layout": { "xaxis": logarithmic("printed (µm)"), "yaxis": logarithmic("here (µm)") },
        }),
        aspect: 0.6,
    }
}
