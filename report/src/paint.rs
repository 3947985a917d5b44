//! What every picture is painted with: its frame, colours, lines and axes, as the plotting script takes them:
//! traces and axes in JSON, without fonts and sizes, which the page adds for the width it has.

use base64::prelude::{BASE64_STANDARD, Engine as _};
use serde_json::{Value, json};

pub use crate::colours::{BLUE, GREEN, GREY, ORANGE, PURPLE, YELLOW};

use crate::colours::BAND;
use crate::envelope::Envelope;

/// One picture and its words.
pub struct Figure {
    /// What stands above it.
    pub title: String,
    /// What is drawn, what is good, what would be wrong.
    pub caption: String,
    /// For a reader who does not see it.
    pub alt: String,
    /// Traces and layout.
    pub plot: Value,
    /// Height over width, on a wide page.
    pub aspect: f64,
}

/// Most numbers of a column that is written out; a longer one is packed.
const WRITTEN_OUT: usize = 256;

/// A number short enough for a page: six significant digits of what is drawn.
pub(crate) fn short(value: f64) -> f64 {
    (value * 1e5).round() / 1e5
}

/// A column of a trace. A long one is packed as the plotting script reads it: `f32`, little-endian, in
/// base64, which keeps seven digits of every number in a little more than five bytes. Where there is no
/// number, the line is interrupted.
pub(crate) fn column(numbers: impl ExactSizeIterator<Item = Option<f64>>) -> Value {
    if numbers.len() <= WRITTEN_OUT {
        return numbers.map(|number| json!(number.map(short))).collect();
    }
    let bytes: Vec<u8> =
        numbers.flat_map(|number| number.map_or(f32::NAN, |number| number as f32).to_le_bytes()).collect();
    json!({ "dtype": "f4", "bdata": BASE64_STANDARD.encode(bytes) })
}

/// A line through points.
pub fn line(points: &[(f64, f64)], name: &str, color: &str, axes: (&str, &str)) -> Value {
    let points: Vec<_> = points.iter().copied().map(Some).collect();
    strokes(&points, name, color, axes)
}

/// A line through points that is interrupted where there is none.
pub(crate) fn strokes(points: &[Option<(f64, f64)>], name: &str, color: &str, axes: (&str, &str)) -> Value {
    let x = column(points.iter().map(|point| point.map(|point| point.0)));
    let y = column(points.iter().map(|point| point.map(|point| point.1)));
    json!({ "type": "scatter", "mode": "lines", "name": name, "x": x, "y": y, "xaxis": axes.0, "yaxis": axes.1,
            "line": { "color": color, "width": 1.5 } })
}

/// A line through the points of an envelope, interrupted where samples are missing.
pub(crate) fn curve(envelope: &Envelope, name: &str, color: &str, axes: (&str, &str)) -> Value {
    strokes(&envelope.strokes(), name, color, axes)
}

/// An axis of a plot with its title.
pub fn axis(title: &str) -> Value {
    json!({ "title": { "text": title } })
}

/// Two plots one above the other, over the same x.
pub(crate) fn stacked(x: &str, upper: &str, lower: &str) -> Value {
    json!({
        "xaxis": { "anchor": "y2", "title": { "text": x } },
        "yaxis": { "domain": [0.54, 1.0], "title": { "text": upper } },
        "yaxis2": { "domain": [0.0, 0.46], "title": { "text": lower } },
    })
}

/// A shaded interval of x.
pub(crate) fn band(from: f64, to: f64) -> Value {
    json!({ "type": "rect", "xref": "x", "yref": "paper", "x0": short(from), "x1": short(to), "y0": 0, "y1": 1,
            "fillcolor": BAND, "line": { "width": 0 }, "layer": "below" })
}
