//! The true way of the tools of a mill, thinned as it comes. In: rows of the trace, mm. Out: points of the
//! slides with what the tool did there, bounded in number however long the run was.

use std::collections::BTreeMap;

use protocol::{Axis, Motion};
use rig::observe::{Summary, WorkKind};
use rig::trace::Row;

/// The first step, mm; it is doubled whenever there are too many points.
const STEP_MM: f64 = 0.02;
const POINTS: usize = 400_000;

/// One point of the way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    /// The slides: X, Y, and Z less the zero of the tool, where that is known; mm.
    pub(super) at: [f64; 3],
    /// Number of the tool.
    pub(super) tool: u32,
    /// Whether it was fed, and not moved in rapid motion.
    pub(super) fed: bool,
    /// True deviation from a surface since the point before, farthest from nothing, µm.
    pub(super) deviation_um: Option<f64>,
}

/// The way so far.
pub(in crate::run) struct Way {
    pub(super) points: Vec<Point>,
    step_mm: f64,
    /// Z of the machine at which a tool touches Z 0 of the program.
    zero_mm: BTreeMap<u32, f64>,
    deviation_um: Option<f64>,
    surfaces: Vec<u32>,
}

impl Way {
    /// The way of a machine with X, Y and Z; `None` of another one.
    pub(in crate::run) fn new(summary: &Summary) -> Option<Way> {
        [Axis::X, Axis::Y, Axis::Z].iter().all(|axis| summary.limits.contains_key(axis)).then(|| {
            let zero = |(number, tool): (&u32, &rig::observe::ToolNote)| Some((*number, tool.origin_mm?[1]));
            let surfaces = summary.traces.iter().filter(|trace| trace.kind == WorkKind::Surface);
            Way {
                points: Vec::new(),
                step_mm: STEP_MM,
                zero_mm: summary.tools.iter().filter_map(zero).collect(),
                deviation_um: None,
                surfaces: surfaces.map(|trace| trace.trace).collect(),
            }
        })
    }

    /// Whether there were surfaces: then only what cut them is a feed.
    pub(super) fn surfaces(&self) -> bool {
        !self.surfaces.is_empty()
    }

    /// Takes the next row.
    pub(in crate::run) fn add(&mut self, row: &Row) {
        let [Some(x), Some(y), Some(z)] = [Axis::X, Axis::Y, Axis::Z].map(|axis| row.axis(axis)) else {
            return;
        };
        if self.surfaces.contains(&row.traced.trace) {
            let um = 1e3 * row.traced.slide.deviation_mm;
            let before = self.deviation_um.unwrap_or(0.0);
            self.deviation_um = Some(if um.abs() >= before.abs() { um } else { before });
        }
        let tool = row.led.tool;
        let zero = self.zero_mm.get(&tool).copied().unwrap_or(0.0);
        let at = [x.slide, y.slide, z.slide - zero];
        // A job is fed to its part from afar.
        let cuts = !self.surfaces() || row.traced.trace > 0;
        let fed = cuts && row.led.motion == Motion::Feed;
        if let Some(last) = self.points.last() {
            let gone = [0, 1, 2].map(|i| at[i] - last.at[i]);
            let same = last.tool == tool && last.fed == fed;
            if same && gone.iter().map(|d| d * d).sum::<f64>() < self.step_mm * self.step_mm {
                return;
            }
        }
        self.points.push(Point { at, tool, fed, deviation_um: self.deviation_um.take() });
        if self.points.len() > POINTS {
            self.thin();
        }
    }

    /// Leaves out every other point, but none where tool or motion change.
    fn thin(&mut self) {
        self.step_mm *= 2.0;
        let before = std::mem::take(&mut self.points);
        let changes = |i: usize| {
            before.get(i + 1).is_none_or(|next| next.tool != before[i].tool || next.fed != before[i].fed)
        };
        let mut left_out = None;
        for (i, point) in before.iter().enumerate() {
            if i % 2 == 1 && !changes(i) {
                left_out = point.deviation_um;
                continue;
            }
            let deviation_um = [point.deviation_um, left_out.take()].into_iter().flatten();
            let deviation_um = deviation_um.max_by(|a, b| a.abs().total_cmp(&b.abs()));
            self.points.push(Point { deviation_um, ..*point });
        }
    }
}
