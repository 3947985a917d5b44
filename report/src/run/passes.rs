//! The tables of passes: what the part is judged by, and, folded up, what each axis did for it. In: reports
//! of passes. Out: HTML; each row knows its pass and its line of the program.

use maud::{Markup, html};
use rig::observe::{PassReport, ServoError, Summary};

/// One column: heading, its explanation, and the cell.
type Column = (&'static str, &'static str, fn(&PassReport) -> String);

const PART: [Column; 10] = [
    ("Pass", "(line)", place),
    ("Helix", "at the tool, about its mean, µm", |p| {
        at_the_tool(p, format!("{:.2}", p.tool.helix_max_abs_um))
    }),
    ("Lead error", "of the nut, µm/rev", |p| format!("{:+.3}", p.lead_error_um_per_rev)),
    ("Depth", "error at the tool, range, µm", |p| {
        at_the_tool(p, format!("{:+.2}…{:+.2}", p.tool.x_min_um, p.tool.x_max_um))
    }),
    ("Phase", "at the tool, µm", |p| at_the_tool(p, format!("{:+.2}", p.tool.phase_um))),
    ("Lead", "mm/rev", |p| format!("{:.3}", p.lead_mm)),
    ("Spindle", "programmed: true, 1/min", |p| {
        format!("{:.0}: {:.0}…{:.0}", p.programmed_rpm, p.rpm_min, p.rpm_max)
    }),
    ("Override", "in the pass (most that is feasible), %", |p| {
        let (low, high) = (p.override_min_pct, p.override_max_pct);
        let range = if low == high { format!("{low:.0}") } else { format!("{low:.0}…{high:.0}") };
        format!("{range} ({:.0})", p.max_feasible_override_pct)
    }),
    ("X servo", "error in the thread (after a turn), µm", |p| in_thread(&p.x)),
    ("Z servo", "error in the thread (after a turn), µm", |p| in_thread(&p.z)),
];

/// Where several threads begin: it tells passes of one thread from those of another.
const START: Column = ("Start", "of the thread", |p| (p.start + 1).to_string());

const SERVO: [Column; 6] = [
    ("Pass", "(line)", place),
    ("X run-in", "servo error: range, at its end, µm", |p| approach(&p.x)),
    ("X slide", "error: range in the run-in, at its end; thread, µm", |p| slide(&p.x_slide)),
    ("Z run-in", "servo error: range, at its end, µm", |p| approach(&p.z)),
    ("Z slide", "error: range in the run-in, at its end; thread, µm", |p| slide(&p.z_slide)),
    ("Nut", "largest error from the helix; mean (phase), µm", |p| {
        format!("{:.2}; {:+.2}", p.helix_max_abs_um, p.phase_um)
    }),
];

fn place(pass: &PassReport) -> String {
    format!("{} ({})", pass.pass, pass.line)
}

/// What was measured in the material, if the tool touched any.
fn at_the_tool(pass: &PassReport, measured: String) -> String {
    if pass.tool.contact_deg > 0.0 { measured } else { "no contact".into() }
}

fn approach(error: &ServoError) -> String {
    format!("{:+.2}…{:+.2}, {:+.2}", error.approach_min_um, error.approach_max_um, error.end_um)
}

fn in_thread(error: &ServoError) -> String {
    format!("{:.2} ({:.2})", error.thread_max_abs_um, error.settled_max_abs_um)
}

fn slide(error: &ServoError) -> String {
    format!("{}; {:.2}", approach(error), error.thread_max_abs_um)
}

/// One row a pass that was turned, in the order of cutting; each knows its place among all passes.
fn table(label: &str, columns: &[Column], summary: &Summary) -> Markup {
    let passes = summary.passes.iter().enumerate().filter(|(_, pass)| pass.tap.is_none());
    html! {
        div.scroll tabindex="0" role="region" aria-label=(label) {
            table.passes {
                thead { tr { @for (name, unit, _) in columns { th scope="col" { (name) small { (unit) } } } } }
                tbody { @for (index, pass) in passes {
                    tr class=[(!pass.complete).then_some("broken")] data-pass=(index) data-line=(pass.line) {
                        @for (_, _, cell) in columns { td { (cell(pass)) } }
                    }
                } }
            }
        }
    }
}

/// Both tables.
pub(super) fn tables(summary: &Summary) -> Markup {
    let mut part = PART.to_vec();
    if summary.turned().any(|pass| pass.start > 0) {
        part.insert(1, START);
    }
    html! {
        section {
            h2 { "Passes" }
            (table("Table of passes", &part, summary))
            p.caption {
                "Helix: the true slide against the programmed helix at the true spindle angle, less its mean, as long as \
                 the point is in the material; the mean is the phase: passes of one start must agree in it, or they \
                 cut different grooves. Depth is positive where the groove is too shallow. By these the part is judged. \
                 Servo error: commanded minus measured; in the thread, after its first turn, 0.2 µm across it (X; of a \
                 thread on a face Z) and 1.5 µm along it (Z; there X) are good."
            }
            details {
                summary { "More about the servo" }
                (table("Table of servo errors", &SERVO, summary))
                p.caption {
                    "Slide: commanded minus true position of the slide, behind backlash, screw and elasticity. Nut: true Z \
                     (of a thread on a face X) of the nut against the helix over the thread. A run-in within ±8 µm that ends near 0 is good."
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{PassReport, Summary, tables};
    use rig::observe::ToolReport;

    fn page(starts: u32) -> String {
        let tool = ToolReport {
            helix_max_abs_um: 0.42,
            x_min_um: -1.0,
            x_max_um: 2.0,
            contact_deg: 90.0,
            ..ToolReport::default()
        };
        let pass =
            |start: u32| PassReport { pass: start + 1, line: 23, start, tool, ..PassReport::default() };
        tables(&Summary { passes: (0..starts).map(pass).collect(), ..Summary::default() }).into_string()
    }

    #[test]
    fn what_the_part_is_judged_by_comes_first() {
        let page = page(1);
        let cells: Vec<_> = page.split("<td>").skip(1).filter_map(|cell| cell.split('<').next()).collect();
        assert_eq!(cells[..4], ["1 (23)", "0.42", "+0.000", "-1.00…+2.00"]);
        let (open, folded) = page.split_once("<details>").expect("the rest is folded up");
        assert!(!open.contains("run-in") && folded.contains("X run-in") && folded.contains("Nut"));
    }

    #[test]
    fn starts_are_told_where_there_are_several() {
        assert!(!page(1).contains("Start<") && page(2).contains("Start<"));
        assert!(page(2).contains("data-pass=\"1\" data-line=\"23\""));
    }
}
