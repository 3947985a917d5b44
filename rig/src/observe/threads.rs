//! The threads of a run as a whole: whether passes that should lie in one groove do. In: the reports of the
//! passes. Out: a [`ThreadReport`], µm.
//!
//! Passes of one start and lead are compared with each other. The starts of a thread are compared by the last
//! pass of each: their phases are counted from the helix that the program means for each of them, so they are
//! the same if the grooves are where they should be. The depth of a thread is that of its finishing passes:
//! those that go deepest.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::PassReport;
use super::span::Span;
use super::tool::Finish;

/// Surfaces and depths nearer than this are one, mm.
const SAME_MM: f64 = 5e-4;

/// The threads as a whole.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ThreadReport {
    /// Largest minus smallest `phase_um` among the passes of one start and lead.
    pub phase_spread_um: f64,
    /// The same at the tool, of the passes that touched the material.
    pub tool_phase_spread_um: f64,
    /// Largest minus smallest phase at the tool among the starts of one lead, each by its last pass.
    pub tool_start_spread_um: f64,
    /// Largest minus smallest error of depth over the finishing passes of a thread, from end to end.
    pub tool_depth_um: f64,
    /// Error of depth of those passes where its magnitude is largest; positive where the thread is too
    /// shallow.
    pub tool_depth_off_um: f64,
}

/// What is known of the depth of a groove.
#[derive(Clone)]
struct Groove {
    start: u32,
    lead_mm: f64,
    surface_mm: f64,
    reach_mm: f64,
    error: Span,
}

/// Collects the depths of the passes.
#[derive(Clone, Default)]
pub(super) struct Threads(Vec<Groove>);

impl Threads {
    /// Takes a pass, and how deep it goes if it touched the material. The depth of a tap is along its axis,
    /// and is in its own report.
    pub(super) fn take(&mut self, pass: &PassReport, finish: Option<Finish>) {
        let Some(Finish { surface_mm, reach_mm }) = finish.filter(|_| pass.tap.is_none()) else { return };
        let PassReport { start, lead_mm, tool, .. } = *pass;
        let same = |groove: &Groove| {
            (groove.start, groove.lead_mm) == (start, lead_mm)
                && (groove.surface_mm - surface_mm).abs() < SAME_MM
        };
        let place = self.0.iter().position(same).unwrap_or_else(|| {
            self.0.push(Groove { start, lead_mm, surface_mm, reach_mm, error: Span::default() });
            self.0.len() - 1
        });
        let groove = &mut self.0[place];
        if reach_mm > groove.reach_mm + SAME_MM {
            (groove.reach_mm, groove.error) = (reach_mm, Span::default());
        }
        if reach_mm > groove.reach_mm - SAME_MM {
            groove.error.add(tool.x_min_um);
            groove.error.add(tool.x_max_um);
        }
    }

    /// What the passes come to.
    pub(super) fn report(&self, passes: &[PassReport]) -> ThreadReport {
        let touched = |pass: &PassReport| (pass.tool.contact_deg > 0.0).then_some(pass.tool.phase_um);
        let mut last: BTreeMap<(bool, u64), BTreeMap<u32, f64>> = BTreeMap::new();
        for (pass, phase_um) in passes.iter().filter_map(|pass| Some((pass, touched(pass)?))) {
            last.entry(thread_of(pass)).or_default().insert(pass.start, phase_um);
        }
        let among = |starts: &BTreeMap<u32, f64>| {
            let mut span = Span::default();
            starts.values().for_each(|phase_um| span.add(*phase_um));
            span.width()
        };
        ThreadReport {
            phase_spread_um: spread(passes, |pass| (pass.thread_cycles > 0).then_some(pass.phase_um)),
            tool_phase_spread_um: spread(passes, touched),
            tool_start_spread_um: last.values().map(among).fold(0.0, f64::max),
            tool_depth_um: self.0.iter().map(|groove| groove.error.width()).fold(0.0, f64::max),
            tool_depth_off_um: self.0.iter().fold(0.0, |most, groove| {
                let (low, high) = groove.error.ends();
                [low, high]
                    .into_iter()
                    .fold(most, |most, um: f64| if um.abs() > f64::abs(most) { um } else { most })
            }),
        }
    }
}

/// What passes of one thread have in common: whether it is tapped, and its lead.
fn thread_of(pass: &PassReport) -> (bool, u64) {
    (pass.tap.is_some(), pass.lead_mm.to_bits())
}

/// Largest minus smallest phase among the passes of one start and lead, µm.
fn spread(passes: &[PassReport], phase_um: impl Fn(&PassReport) -> Option<f64>) -> f64 {
    let mut spans: BTreeMap<_, Span> = BTreeMap::new();
    for pass in passes {
        if let Some(phase_um) = phase_um(pass) {
            spans.entry((pass.start, thread_of(pass))).or_default().add(phase_um);
        }
    }
    spans.values().map(|span| span.width()).fold(0.0, f64::max)
}
