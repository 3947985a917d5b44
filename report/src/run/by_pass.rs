//! Curves of all passes in one picture, each in the colour of its place in the order of cutting, with one
//! key: a legend of few passes, the bar of a scale for many. In: curves of passes. Out: traces, which know
//! the pass and the line of the program they belong to.

use serde_json::{Value, json};

use super::curves::Curves;
use crate::colours::{bar, in_a_legend, in_order};
use crate::{envelope::Envelope, paint::curve};

/// Colours, names and key of the passes of a run.
pub(super) struct PassScale<'a> {
    curves: &'a Curves,
}

impl<'a> PassScale<'a> {
    /// The scale of all passes of a run.
    pub(super) fn new(curves: &'a Curves) -> PassScale<'a> {
        PassScale { curves }
    }

    /// Gives a trace of lines the colour of a pass, its name, and its place in the legend, if asked for.
    pub(super) fn dress(&self, drawn: &mut Value, index: usize, in_legend: bool) {
        let passes = &self.curves.passes;
        let name = format!("pass {}", passes[index].pass);
        drawn["line"]["color"] = json!(in_order(index, passes.len()));
        drawn["name"] = json!(name);
        drawn["legendgroup"] = json!(name);
        drawn["showlegend"] = json!(in_legend && in_a_legend(passes.len()));
        drawn["meta"] = json!({ "pass": index, "line": passes[index].line });
    }

    /// The key of many passes, as a trace; few have a legend.
    pub(super) fn key(&self) -> Option<Value> {
        let passes = &self.curves.passes;
        let (first, last) = (passes.first()?.pass, passes.last()?.pass);
        (!in_a_legend(passes.len())).then(|| bar("pass", f64::from(first), f64::from(last)))
    }
}

/// One curve a pass, in the order of cutting; the one picture of those above each other that has the legend
/// has the key too.
pub(super) fn by_pass<'a>(
    curves: &'a Curves,
    axes: (&'a str, &'a str),
    in_legend: bool,
    of: impl Fn(usize) -> &'a Envelope + 'a,
) -> impl Iterator<Item = Value> + 'a {
    let scale = PassScale::new(curves);
    let key = if in_legend { scale.key() } else { None };
    let drawn = (0..curves.passes.len()).map(move |index| {
        let mut drawn = curve(of(index), "", "", axes);
        scale.dress(&mut drawn, index, in_legend);
        drawn
    });
    drawn.chain(key)
}
