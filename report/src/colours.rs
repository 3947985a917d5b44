//! Colours that suit the ground a page is read on. In: the place of something in its order. Out: what the
//! page makes a colour of, for the ground it has at that moment.
//!
//! | written in a picture | what the page makes of it |
//! |---|---|
//! | `var(--blue)` | the colour of that name |
//! | `mix(--passes 0.25)` | the colour a quarter of the way along that list of colours |
//! | `scale(--passes)` | the whole list, evenly spaced, for a heat map or the bar of a key |
//!
//! The lists stand in `report.css`, and once more for a dark ground in `dark.css`. Lines have a contrast of 3
//! to their ground at least, and [`PASSES`] grows steadily in contrast, so that it can be read in grey and
//! with any kind of colour vision: what comes last stands out most.

use serde_json::{Value, json};

/// The first of five colours that differ for every kind of colour vision (Okabe and Ito).
pub const BLUE: &str = "var(--blue)";
/// The second.
pub const ORANGE: &str = "var(--orange)";
/// The third.
pub const GREEN: &str = "var(--green)";
/// The fourth.
pub const PURPLE: &str = "var(--purple)";
/// The fifth.
pub const YELLOW: &str = "var(--yellow)";
/// Text.
pub const INK: &str = "var(--ink)";
/// For what only guides the eye.
pub const GREY: &str = "var(--grey)";
/// A wide line that another one is drawn on.
pub const WIDE: &str = "var(--wide)";
/// What is shaded.
pub const BAND: &str = "var(--band)";
/// The grid of a picture, and its edge.
pub const GRID: &str = "var(--grid)";
/// The edge of a picture.
pub const EDGE: &str = "var(--edge)";

/// The list of colours of things that follow one another.
pub const PASSES: &str = "--passes";
/// The list from low to high of what lines and text are drawn on: as a `colorscale`.
pub const RELIEF: &str = "scale(--relief)";
/// The list from nothing to much: as a `colorscale`.
pub const AMOUNT: &str = "scale(--amount)";
/// The list from below over nothing to above: as a `colorscale`.
pub const EITHER_WAY: &str = "scale(--either-way)";

/// More things than this are told apart by the bar of a key, not by a legend.
const IN_A_LEGEND: usize = 8;

/// The colour of one of several that follow one another.
pub fn in_order(index: usize, of: usize) -> String {
    let place = if of < 2 { 1.0 } else { index as f64 / (of - 1) as f64 };
    format!("mix({PASSES} {place:.4})")
}

/// The colour of one of several kinds, in any order.
pub fn of_kind(index: usize) -> &'static str {
    [BLUE, ORANGE, GREEN, PURPLE, YELLOW][index % 5]
}

/// Whether so many are few enough for a legend.
pub fn in_a_legend(number: usize) -> bool {
    number <= IN_A_LEGEND
}

/// The bar of a key for things from `first` to `last`, as a trace that draws nothing else.
pub fn bar(title: &str, first: f64, last: f64) -> Value {
    json!({ "type": "scatter", "mode": "markers", "x": [null], "y": [null], "showlegend": false, "hoverinfo": "skip",
            "marker": { "color": [first], "cmin": first, "cmax": last, "showscale": true,
                        "colorscale": format!("scale({PASSES})"),
                        "colorbar": { "orientation": "h", "title": { "text": title, "side": "right" }, "nticks": 8,
                                      "tickformat": "d", "thickness": 10, "len": 0.5, "x": 0, "xanchor": "left",
                                      "xpad": 0, "ypad": 4, "yref": "container", "y": 0, "yanchor": "bottom",
                                      "outlinewidth": 0 } } })
}

#[cfg(test)]
mod tests {
    use super::in_order;

    const LIGHT: &str = include_str!("../assets/report.css");
    const DARK: &str = include_str!("../assets/dark.css");

    /// The value of a variable.
    fn value<'a>(style: &'a str, name: &str) -> &'a str {
        let rest = style.split(&format!("--{name}:")).nth(1).unwrap_or_else(|| panic!("no --{name}"));
        rest.split(';').next().unwrap_or_default().trim()
    }

    /// Relative luminance of sRGB, as WCAG 2 defines it.
    fn luminance(color: &str) -> f64 {
        let channel = |i: usize| {
            let byte = u8::from_str_radix(&color[1 + 2 * i..3 + 2 * i], 16).expect("six digits");
            let c = f64::from(byte) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { libm::pow((c + 0.055) / 1.055, 2.4) }
        };
        0.2126 * channel(0) + 0.7152 * channel(1) + 0.0722 * channel(2)
    }

    fn contrast(color: &str, ground: &str) -> f64 {
        let (a, b) = (luminance(color), luminance(ground));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn lines_stand_out_on_both_grounds() {
        for style in [LIGHT, DARK] {
            let ground = value(style, "ground");
            for name in ["blue", "orange", "green", "purple", "yellow", "grey"] {
                let got = contrast(value(style, name), ground);
                assert!(got >= 3.0, "{name} on {ground}: {got:.2}");
            }
            for name in ["ink", "soft"] {
                let got = contrast(value(style, name), ground);
                assert!(got >= 4.5, "text, {name} on {ground}: {got:.2}");
            }
        }
    }

    /// Whoever sees no colours reads the order by the contrast.
    #[test]
    fn the_last_pass_stands_out_most() {
        for style in [LIGHT, DARK] {
            let ground = value(style, "ground");
            let passes: Vec<f64> =
                value(style, "passes").split(',').map(|color| contrast(color.trim(), ground)).collect();
            assert!(passes.len() > 3 && passes[0] >= 3.0, "{ground}: {passes:?}");
            assert!(passes.windows(2).all(|two| two[1] > 1.2 * two[0]), "{ground}: {passes:?}");
        }
    }

    #[test]
    fn places_go_from_the_first_to_the_last() {
        let all = [0, 1, 2].map(|index| in_order(index, 3));
        assert_eq!(all, ["mix(--passes 0.0000)", "mix(--passes 0.5000)", "mix(--passes 1.0000)"]);
        assert_eq!(in_order(0, 1), "mix(--passes 1.0000)", "the only one stands out");
    }
}
