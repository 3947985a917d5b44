//! Curves of all passes in one picture, each in the colour of its place in the order of cutting.

use serde_json::{Value, json};

use super::curves::Curves;
use crate::{envelope::Envelope, paint::curve};

/// Passes beyond this number are told apart by pointing at them, not by a legend.
const LEGEND_PASSES: usize = 8;

/// Colour of a pass: from dark blue for the first to light orange for the last.
fn pass_color(index: usize, passes: usize) -> String {
    const RAMP: [[f64; 3]; 5] = [
        [20.0, 42.0, 100.0],
        [0.0, 114.0, 178.0],
        [0.0, 145.0, 120.0],
        [190.0, 120.0, 0.0],
        [213.0, 94.0, 0.0],
    ];
    let place = index as f64 * (RAMP.len() - 1) as f64 / passes.saturating_sub(1).max(1) as f64;
    let (low, high) = (RAMP[place as usize], RAMP[(place as usize + 1).min(RAMP.len() - 1)]);
    let share = place - place.floor();
    let [r, g, b] = [0, 1, 2].map(|i| low[i] + share * (high[i] - low[i]));
    format!("rgb({r:.0},{g:.0},{b:.0})")
}

/// One curve a pass, in the order of cutting.
pub(super) fn by_pass<'a>(
    curves: &'a Curves,
    axes: (&'a str, &'a str),
    in_legend: bool,
    of: impl Fn(usize) -> &'a Envelope + 'a,
) -> impl Iterator<Item = Value> + 'a {
    let passes = curves.passes.len();
    (0..passes).map(move |index| {
        let name = format!("pass {}", curves.passes[index].pass);
        let mut drawn = curve(of(index), &name, &pass_color(index, passes), axes);
        drawn["legendgroup"] = json!(name);
        drawn["showlegend"] = json!(in_legend && passes <= LEGEND_PASSES);
        drawn
    })
}
