//! What cutting took: its table, its curves, its picture. In: reports of passes, rows of the trace. Out: N,
//! N·m, kW, mm² a pass; force and torque over seconds since the tool went in.

use maud::{Markup, html};
use rig::observe::{CuttingReport, PassReport, Summary};
use rig::trace::Row;

use crate::envelope::Envelope;

/// Curves of one pass from the moment at which its tool goes in.
struct PassCut {
    /// The control cycle of that moment; none before it.
    began: Option<u64>,
    /// Tangential force, and torque of the spindle motor in the direction of the pass.
    curves: [Envelope; 2],
}

/// What cutting took over the time of each pass; empty if nothing was cut.
pub(super) struct CutCurves(Vec<PassCut>);

impl CutCurves {
    /// Empty curves for a run, with as many intervals each.
    pub(super) fn new(summary: &Summary, slots: usize) -> CutCurves {
        let of_pass = |pass: &PassReport| {
            let cycles = pass.end_cycle.saturating_sub(pass.begin_cycle) as f64;
            let curve = Envelope::new(0.0, cycles * summary.cycle_s, slots);
            PassCut { began: None, curves: [curve.clone(), curve] }
        };
        CutCurves(if cuts(summary) { summary.passes.iter().map(of_pass).collect() } else { Vec::new() })
    }

    /// Force and torque of the pass with this index.
    pub(super) fn of_pass(&self, index: usize) -> &[Envelope; 2] {
        &self.0[index].curves
    }

    /// Takes the next row, of the pass with this index.
    pub(super) fn add(&mut self, summary: &Summary, index: usize, row: &Row) {
        let Some((pass, cut)) = summary.passes.get(index).zip(self.0.get_mut(index)) else { return };
        if cut.began.is_none() && row.cut.area <= 0.0 {
            return;
        }
        let began = *cut.began.get_or_insert(row.cycle);
        let t_s = row.cycle.saturating_sub(began) as f64 * summary.cycle_s;
        let [force, torque] = &mut cut.curves;
        force.add(t_s, row.cut.force);
        torque.add(t_s, row.cut.motor_torque * pass.direction);
    }
}

/// Whether anything was cut.
pub(super) fn cuts(summary: &Summary) -> bool {
    summary.passes.iter().any(|pass| pass.cutting.is_some())
}

/// One column of the table: heading, its explanation, and the cell.
type Column = (&'static str, &'static str, fn(&CuttingReport) -> String);

const COLUMNS: [Column; 4] = [
    ("Chip area", "mm²", |cut| format!("{:.4}", cut.chip_area_max_mm2)),
    ("Force", "tangential; radial, axial, N", |cut| {
        format!("{:.1}; {:.1}, {:.1}", cut.force_max_n, cut.radial_max_n, cut.axial_max_n)
    }),
    ("Torque", "at the spindle, N·m", |cut| format!("{:.2}", cut.torque_max_nm)),
    ("Power", "of the cut, kW", |cut| format!("{:.3}", cut.power_max_kw)),
];

/// The table of what cutting took.
pub(super) fn table(summary: &Summary) -> Markup {
    html! {
        section {
            h2 { "Cutting" }
            div.scroll tabindex="0" role="region" aria-label="Table of cutting forces" {
                table {
                    thead { tr {
                        th scope="col" { "Pass" small { "(line)" } }
                        th scope="col" { "Depth" small { "mm" } }
                        th scope="col" { "Spindle" small { "programmed: true, 1/min" } }
                        @for (name, unit, _) in COLUMNS { th scope="col" { (name) small { (unit) } } }
                    } }
                    tbody { @for pass in &summary.passes { tr {
                        td { (pass.pass) " (" (pass.line) ")" }
                        td { (format!("{:.4}", pass.depth_mm)) }
                        td { (format!("{:.0}: {:.1}…{:.1}", pass.programmed_rpm, pass.rpm_min, pass.rpm_max)) }
                        @for (_, _, cell) in COLUMNS { td { (pass.cutting.as_ref().map_or("–".into(), cell)) } }
                    } } }
                }
            }
            p.caption {
                "Largest of each in the pass, by the model of [plant.cutting]: specific cutting force times chip area \
                 times the factor of a V chip. Radial: what pushes X out of the cut. Axial: what pushes Z against the \
                 motion along the thread. A pass without figures cut nothing."
            }
        }
    }
}
