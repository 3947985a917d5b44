//! Leads by a table: Z against the lead integrated over the angle by nothing but its meaning.

use protocol::{Axis, ThreadPass};

use super::{fanuc, only_pass, refused, turn_deg};
use crate::good;

/// Z and lead of each row, in the order of the cut.
type Rows<'a> = &'a [[f64; 2]];

/// The lead along Z at a place: its square is a line between two rows.
fn lead(rows: Rows<'_>, z: f64) -> f64 {
    let pair = rows.windows(2).find(|pair| (z - pair[0][0]) * (z - pair[1][0]) <= 0.0);
    let Some([[a, k], [b, l]]) = pair.map(|pair| [pair[0], pair[1]]) else {
        let [first, last] = [rows[0], rows[rows.len() - 1]];
        return if (z - first[0]).abs() < (z - last[0]).abs() { first[1] } else { last[1] };
    };
    (k * k + (l * l - k * k) * (z - a) / (b - a)).sqrt()
}

/// Largest distance of Z from the integral of the lead, outside of the windows of the corners and inside, mm.
fn off(pass: &ThreadPass, rows: Rows<'_>, from_z: f64, towards: f64) -> [f64; 2] {
    const STEPS_A_TURN: f64 = 2000.0;
    let along = pass.axis(Axis::Z);
    let (law, turn) = (pass.law(Axis::Z), turn_deg(pass));
    let locked = along.run_in_c0_deg + along.run_in_dc_deg;
    let (mut z, mut step, mut most, mut looks) = (from_z, 0u32, [0.0f64; 2], [0; 2]);
    loop {
        let c = turn + 360.0 * f64::from(step) / STEPS_A_TURN;
        if c >= pass.thread_end_deg {
            break;
        }
        if c >= locked && step % 25 == 0 {
            let inside =
                pass.corners().any(|corner| (corner.c_deg..corner.c_deg + corner.dc_deg).contains(&c));
            let which = usize::from(inside);
            most[which] = most[which].max((along.start.mm() + law.at(c).s - z).abs());
            looks[which] += 1;
        }
        // The midpoint rule.
        let middle = z + towards * 0.5 / STEPS_A_TURN * lead(rows, z);
        z += towards / STEPS_A_TURN * lead(rows, middle);
        step += 1;
    }
    assert!(looks[0] > 300 && looks[1] > 5, "{looks:?}");
    most
}

const ROWS: [[f64; 2]; 5] = [[0.0, 2.0], [-10.0, 3.0], [-20.0, 2.5], [-40.0, 4.0], [-50.0, 4.0]];
const TABLE: &str = "(lead_table, Z0 K2, Z-10 K3, Z-20 K2.5, Z-40 K4, Z-50 K4)";

#[test]
fn a_thread_has_the_leads_of_its_table() {
    // From in front of the first row, behind the last, and from the middle of a row to that of another.
    for (from, to, k) in [(5.0, -60.0, 2.0), (5.0, -48.0, 2.0), (-5.0, -33.0, lead(&ROWS, -5.0))] {
        let check = good(&format!("S300 M3\nG0 X20 Z{from}\n{TABLE}\nG33 Z{to} K{k:.9}\nG0 X35\nM2\n"));
        let pass = only_pass(&check);
        let [outside, inside] = off(&pass, &ROWS, from, -1.0);
        assert!(
            outside < 1e-5 && inside < 2e-4,
            "from {from} to {to}: {outside} mm off, {inside} about rows"
        );
        let end = check.passes[0].end_lead_mm.expect("it changes");
        assert!((end + lead(&ROWS, to)).abs() < 1e-6, "{end} at {to}");
        assert!(check.passes[0].corners.is_empty(), "no corner is programmed");
    }
    // Rows told the other way, and a thread towards Z+.
    let check = good(
        "S300 M3\nG0 X20 Z-60\n(Lead_Table, z-50k4, Z-40 F4, Z-20 K2.5, Z-10 K3, Z0 K2)\nG33 Z5 K4\nG0 X35\nM2\n",
    );
    let [outside, inside] = off(&only_pass(&check), &ROWS, -60.0, 1.0);
    assert!(outside < 1e-5 && inside < 2e-4, "{outside} {inside}");
}

/// The table lies in the coordinates and units of the program, and stays until it is told to be off.
#[test]
fn a_table_is_in_units_and_from_the_zero_of_the_program() {
    let inches = good(
        "S300 M3\nG20\nG92 Z0\nG0 X0.8 Z0.2\n(lead_table, Z0 K0.1, Z-1 K0.2)\nG33 Z-2 K0.1\nG0 X1.4\nG0 Z0.2\nG0 X0.8\n\
         G33 Z-2 K0.1\nG0 X1.4\n(lead_table, off)\nG0 Z0.2\nG0 X0.8\nG33 Z-2 K0.1\nG0 X1.4\nM2\n",
    );
    let all = crate::passes(&inches.items);
    let z0 = all[0].axis(Axis::Z).start.mm() - 5.08;
    let rows = [[z0, 2.54], [z0 - 25.4, 5.08]];
    for pass in &all[..2] {
        let [outside, _] = off(pass, &rows, z0 + 5.08, -1.0);
        assert!(outside < 1e-5, "{outside}");
    }
    assert!(all.len() == 3 && all[2].corners().count() == 0, "the last one has one lead");
}

/// On a cone the table is that along Z; K is along the path, F along Z.
#[test]
fn both_dialects_read_a_table_on_a_cone() {
    let k = 2.0 * libm::hypot(60.0, 6.0) / 60.0;
    let one = good(&format!("S300 M3\nG0 X20 Z5\n{TABLE}\nG33 X26 Z-55 K{k:.12}\nG0 X35\nM2\n"));
    let words = TABLE.to_uppercase();
    let other = fanuc(&format!("G97 S300 M03\nG00 X40. Z5.\n{words}\nG32 X52. Z-55. F2.\nG00 X70.\n"));
    let [one, other] = [only_pass(&one), only_pass(&other)];
    assert!(off(&one, &ROWS, 5.0, -1.0)[0] < 1e-5);
    for axis in [Axis::X, Axis::Z] {
        for c in (0..7000).map(f64::from) {
            let [a, b] = [one.law(axis).at(c).s, other.law(axis).at(c).s];
            assert!((a - b).abs() < 1e-9, "{axis:?} at {c}: {a} and {b}");
        }
    }
    let turn = turn_deg(&one);
    for c in (0..60).map(|n| turn + 600.0 + 80.0 * f64::from(n)) {
        let [x, z] = [Axis::X, Axis::Z].map(|axis| one.axis(axis).start.mm() + one.law(axis).at(c).s);
        assert!((x - (20.0 + (5.0 - z) / 10.0)).abs() < 2e-4, "on the cone: {x} {z}");
    }
}

#[test]
fn what_is_no_table_is_refused_with_a_remedy() {
    let refused = |blocks: &str, line: u32, message: &str, help: &str| {
        refused(&format!("G7 S300 M3\nG0 X40 Z5\n{blocks}\nG0 X70\nM2\n"), line, message, help);
    };
    for (told, message) in [
        ("(lead_table)", "a comma is missing"),
        ("(lead_table Z0 K2)", "a comma is missing"),
        ("(lead_table, Z0 K2)", "has 1 rows"),
        ("(lead_table, Z0 K2, Z0 K3)", "not on its way"),
        ("(lead_table, Z0 K2, Z-10 K3, Z-5 K4)", "not on its way"),
        ("(lead_table, Z0 K2, Z-10)", "\"Z-10\" is no row"),
        ("(lead_table, Z0 K2, Z-10 K0)", "is no row"),
        ("(lead_table, Z0 K2, Z-10 Knan)", "is no row"),
        ("(lead_table, Z0 K2, X-10 K1)", "is no row"),
        ("(lead_tables, Z0 K2, Z-10 K3)", "is no word"),
    ] {
        refused(told, 3, message, "(lead_table, Z0 K3, Z-40 K5)");
    }
    for word in ["thread_milling, M20x2", "THREAD_WHIRLING"] {
        refused(&format!("({word})\nG33 Z-20 K2"), 3, "the tool would turn by itself", "G2 or G3 with Z");
    }
    refused("(lead_spline, Z0 K2, Z-10 K3)", 3, "not told by a spline", "as many rows");
    refused(
        "(lead table of the shop)\n(lead_table, Z0 K2, Z-40 K3)\nG33 Z-60 K2.5",
        5,
        "is 2 mm",
        "begins alike",
    );
    refused("(lead_table, Z0 K2, Z-40 K3)\nG33 X30 K2", 4, "a thread on a face", "(lead_table, off)");
    refused("(lead_table, Z0 K2, Z-40 K3)\nG33.1 Z-20 K2", 4, "a tap", "(lead_table, off)");
    refused(
        "(lead_table, Z0 K2, Z-40 K3)\nG76 P2 Z-40 I-4 J0.4 K2.4",
        4,
        "a threading cycle",
        "(lead_table, off)",
    );
    let many: String = (0..20).map(|n| format!(", Z{} K{}", -4 * n, 2 + n % 2)).collect();
    refused(&format!("(lead_table{many})\nG33 Z-70 K2"), 4, "12 corners at most", "less rows");
}
