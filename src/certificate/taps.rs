//! The taps of a certificate. In: their reports. Out: rows of a table of their own, since a tap goes to its
//! depth along its axis, and takes no chip that the simulated machine would feel.

use report::table::{Column, Table};
use rig::observe::Summary;
use serde::Serialize;

/// A tap, as it was made on the simulated machine.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Tap {
    pass: u32,
    line: u32,
    /// Programmed speed, 1/min.
    rpm: f64,
    /// Way along the axis until Z is on the helix, mm.
    run_in_mm: f64,
    /// The highest override at which the spindle turns round in time, per cent.
    highest_override_pct: f64,
    /// Farthest off the mean of the helix on the way in, at the turn and on the way out, µm.
    in_um: f64,
    turn_um: f64,
    out_um: f64,
    /// Less deep than programmed, µm; negative if deeper.
    short_um: f64,
}

/// A row for every tap.
pub(super) fn rows(summary: &Summary) -> Vec<Tap> {
    let row = |(pass, tap): (&rig::observe::PassReport, &rig::observe::TapReport)| Tap {
        pass: pass.pass,
        line: pass.line,
        rpm: pass.programmed_rpm,
        run_in_mm: pass.delta_z_mm.abs(),
        highest_override_pct: pass.max_feasible_override_pct,
        in_um: tap.in_um,
        turn_um: tap.turn_um,
        out_um: tap.out_um,
        short_um: tap.short_um,
    };
    summary.taps().map(row).collect()
}

const COLUMNS: [Column<Tap>; 9] = [
    Column { name: "tap", unit: "", cell: |tap| tap.pass.to_string() },
    Column { name: "line", unit: "", cell: |tap| tap.line.to_string() },
    Column { name: "S", unit: "1/min", cell: |tap| format!("{:.0}", tap.rpm) },
    Column { name: "run-in", unit: "mm", cell: |tap| format!("{:.3}", tap.run_in_mm) },
    Column { name: "override", unit: "%", cell: |tap| format!("{:.0}", tap.highest_override_pct) },
    Column { name: "in", unit: "µm", cell: |tap| format!("{:.2}", tap.in_um) },
    Column { name: "turn", unit: "µm", cell: |tap| format!("{:.2}", tap.turn_um) },
    Column { name: "out", unit: "µm", cell: |tap| format!("{:.2}", tap.out_um) },
    Column { name: "short", unit: "µm", cell: |tap| format!("{:.2}", tap.short_um) },
];

/// The table; nothing without a tap.
pub(super) fn table(taps: &[Tap]) -> Option<Table> {
    let caption = "Off the helix at most, about the mean of the whole way: in, while the spindle turns round, out. Short: what \
                   the tool lacks of the programmed depth.";
    (!taps.is_empty()).then(|| Table::of("Taps", &COLUMNS, taps).with_caption(caption))
}
