//! Contours, surfaces and seams: their table, and the curves gathered for their pictures. In: reports of
//! traces, rows of the trace. Out: µm, degrees and mm/min over the way in mm, and the deviation over the
//! part.

use maud::{Markup, html};
use protocol::Axis;
use rig::observe::{Summary, TraceReport, WorkKind};
use rig::trace::{Row, STRIDE};

use crate::envelope::Envelope;

/// Traces that get pictures: those with the largest deviation.
const DRAWN: usize = 4;
/// Intervals of a curve over the way.
const SLOTS: usize = 1000;
/// Cells of a map along its longer side.
const CELLS: f64 = 160.0;

/// Curves of one trace.
pub(super) struct TraceCurves {
    /// Where its report stands in the summary.
    pub(super) index: usize,
    way_mm: f64,
    /// The cycle of the row before.
    cycle: Option<u64>,
    /// Deviation by commanded and by true positions over the way, µm.
    pub(super) deviation: [Envelope; 2],
    /// Angle between the direction of a seam and the beam, degrees.
    pub(super) angle: [Envelope; 2],
    /// Feed, mm/min.
    pub(super) feed: [Envelope; 2],
    /// True deviation over the part.
    pub(super) map: Map,
}

/// The largest magnitude of the deviation in every cell of the part, seen from above, µm.
pub(super) struct Map {
    pub(super) cell_mm: f64,
    from_mm: [f64; 2],
    /// Columns, rows.
    pub(super) size: [usize; 2],
    cells: Vec<Option<f64>>,
}

/// Whether anything was measured.
pub(super) fn any(summary: &Summary) -> bool {
    !summary.traces.is_empty()
}

/// Largest true deviation of all, µm.
pub(super) fn worst_um(summary: &Summary) -> f64 {
    summary.traces.iter().map(|trace| trace.slide.max_abs_um()).fold(0.0, f64::max)
}

/// What a trace is called.
pub(super) fn name(trace: &TraceReport) -> String {
    let kind = match trace.kind {
        WorkKind::Contour => "Contour",
        WorkKind::Surface => "Surface",
        WorkKind::Seam => "Seam",
    };
    format!("{kind} in line {}", trace.line)
}

impl TraceCurves {
    /// Empty curves of the traces that get pictures, in the order of cutting.
    pub(super) fn all(summary: &Summary) -> Vec<TraceCurves> {
        let mut worst: Vec<usize> = (0..summary.traces.len()).collect();
        let deviation =
            |index: &usize| summary.traces.get(*index).map_or(0.0, |trace| trace.slide.max_abs_um());
        worst.sort_by(|a, b| deviation(b).total_cmp(&deviation(a)));
        worst.truncate(DRAWN);
        worst.sort_unstable();
        let curves = |index: usize| {
            let trace = summary.traces.get(index)?;
            let way_mm = trace.way_mm.max(1e-3);
            let a_cycle = way_mm / trace.cut_cycles.max(1) as f64;
            let curve = Envelope::new(0.0, way_mm, SLOTS).with_steps(2.0 * STRIDE as f64 * a_cycle);
            let both = [curve.clone(), curve];
            let (deviation, angle, feed) = (both.clone(), both.clone(), both);
            Some(TraceCurves {
                index,
                way_mm: 0.0,
                cycle: None,
                deviation,
                angle,
                feed,
                map: Map::new(trace),
            })
        };
        worst.into_iter().filter_map(curves).collect()
    }

    /// Takes the next row.
    pub(super) fn add(&mut self, summary: &Summary, row: &Row) {
        let Some(trace) = summary.traces.get(self.index).filter(|trace| trace.trace == row.traced.trace)
        else {
            return;
        };
        let points = [row.traced.commanded, row.traced.slide];
        let apart = row.after(self.cycle.replace(row.cycle)).unwrap_or(1);
        self.way_mm += points[0].feed_mm_min / 60.0 * apart as f64 * summary.cycle_s;
        for (i, point) in points.iter().enumerate() {
            self.deviation[i].add(self.way_mm, 1e3 * point.deviation_mm);
            self.angle[i].add(self.way_mm, point.angle_deg);
            if point.feed_mm_min > 0.0 {
                self.feed[i].add(self.way_mm, point.feed_mm_min);
            }
        }
        if trace.kind == WorkKind::Surface
            && let [Some(x), Some(y)] = [Axis::X, Axis::Y].map(|axis| row.axis(axis))
        {
            let at = [x.commanded - trace.origin_mm[0], y.commanded - trace.origin_mm[1]];
            self.map.add(at, 1e3 * points[1].deviation_mm);
        }
    }
}

impl Map {
    fn new(trace: &TraceReport) -> Map {
        let [x, y, _] = trace.reach_mm;
        let (width, height) = (x[1] - x[0], y[1] - y[0]);
        let cell_mm = (width.max(height) / CELLS).max(1e-3);
        let size = [width, height].map(|side| (side / cell_mm).floor() as usize + 1);
        Map { cell_mm, from_mm: [x[0], y[0]], size, cells: vec![None; size[0] * size[1]] }
    }

    fn add(&mut self, at: [f64; 2], um: f64) {
        let [column, row] = [0, 1].map(|i| ((at[i] - self.from_mm[i]) / self.cell_mm).floor());
        if column < 0.0 || row < 0.0 || column as usize >= self.size[0] {
            return;
        }
        if let Some(cell) = self.cells.get_mut(row as usize * self.size[0] + column as usize) {
            *cell = Some(cell.map_or(um.abs(), |before| before.max(um.abs())));
        }
    }

    /// Middles of the columns and of the rows, mm.
    pub(super) fn middles(&self) -> [Vec<f64>; 2] {
        let of = |i: usize| {
            let middle = |k: usize| self.from_mm[i] + (k as f64 + 0.5) * self.cell_mm;
            (0..self.size[i]).map(middle).collect()
        };
        [of(0), of(1)]
    }

    /// The cells, row by row; nothing where the tool has not been.
    pub(super) fn rows(&self) -> impl Iterator<Item = &[Option<f64>]> {
        self.cells.chunks(self.size[0].max(1))
    }
}

/// The table of traces.
pub(super) fn table(summary: &Summary) -> Markup {
    let pair = |low: f64, high: f64| format!("{low:+.2}…{high:+.2}");
    html! {
        section {
            h2 { "Contours, surfaces, seams" }
            div.scroll tabindex="0" role="region" aria-label="Table of traces" {
                table {
                    thead { tr {
                        th scope="col" { "Trace" }
                        th scope="col" { "Way" small { "mm" } }
                        th scope="col" { "Commanded" small { "deviation: range, rms, µm" } }
                        th scope="col" { "True" small { "deviation: range, rms, µm" } }
                        th scope="col" { "Direction" small { "of a seam: commanded, true, degrees" } }
                        th scope="col" { "Feed" small { "mm/min; held, % of the time" } }
                        th scope="col" { "True feed" small { "where held: % of the time, range, rms, %" } }
                        th scope="col" { "Chord" small { "error, µm" } }
                        th scope="col" { "Limits" small { "used at most: speed, acceleration, jerk, %" } }
                    } }
                    tbody { @for trace in &summary.traces { tr {
                        td { (name(trace)) }
                        td { (format!("{:.1}", trace.way_mm)) }
                        @for side in [&trace.commanded, &trace.slide] {
                            td { (pair(side.low_um, side.high_um)) (format!(", {:.2}", side.rms_um)) }
                        }
                        @if trace.kind == WorkKind::Seam {
                            td { (format!("{:.5}, {:.5}", trace.commanded.angle_max_deg, trace.slide.angle_max_deg)) }
                        } @else { td { "–" } }
                        td { (format!("{:.0}; {:.1}", trace.feed.programmed_mm_min, trace.feed.held_pct)) }
                        td {
                            (format!("{:.1}; ", trace.feed.true_held_pct))
                            (pair(trace.feed.true_low_pct, trace.feed.true_high_pct))
                            (format!(", {:.2}", trace.feed.true_rms_pct))
                        }
                        td { (format!("{:.3}", trace.feed.chord_max_um)) }
                        td { (limits(trace)) }
                    } } }
                }
            }
            p.caption {
                "Deviation: how far the tool is from touching the surface or contour that its formula describes, positive \
                 where it stands off; of a seam, the distance of the beam from it. True: of the slides, behind drives, \
                 screws and elasticity. What is early or late along the path does not count. The feed is held within 1 % \
                 of what is asked for; elsewhere a limit makes it slower."
            }
        }
    }
}

fn limits(trace: &TraceReport) -> String {
    let most = trace.limits_used.values().fold([0.0_f64; 3], |most, used| {
        let used = [used.velocity_pct, used.acceleration_pct, used.jerk_pct];
        [0, 1, 2].map(|i| most[i].max(used[i]))
    });
    most.map(|share| format!("{share:.0}")).join(", ")
}
