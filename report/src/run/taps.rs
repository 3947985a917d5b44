//! What a report says of taps. In: their reports. Out: a sentence of the verdict, and a table; µm.

use rig::observe::{PassReport, Summary, TapReport};

use super::verdict::{Grade, LOOK_SHARE, Verdict, more_than_half, um};
use crate::table::{Column, Table};

const COLUMNS: [Column<PassReport>; 9] = [
    Column { name: "Tap", unit: "(line)", cell: |pass| format!("{} ({})", pass.pass, pass.line) },
    Column { name: "In", unit: "off the helix at most, µm", cell: |pass| of_tap(pass, |tap| tap.in_um) },
    Column {
        name: "Turn",
        unit: "while the spindle turns round, µm",
        cell: |pass| of_tap(pass, |tap| tap.turn_um),
    },
    Column { name: "Out", unit: "off the helix at most, µm", cell: |pass| of_tap(pass, |tap| tap.out_um) },
    Column {
        name: "Short",
        unit: "of the depth; deeper: negative, µm",
        cell: |pass| of_tap(pass, |tap| tap.short_um),
    },
    Column { name: "Lead", unit: "mm/rev", cell: |pass| format!("{:.3}", pass.lead_mm) },
    Column {
        name: "Spindle",
        unit: "programmed: true, 1/min",
        cell: |pass| format!("{:.0}: {:.0}…{:.0}", pass.programmed_rpm, pass.rpm_min, pass.rpm_max),
    },
    Column { name: "Way out", unit: "times S", cell: |pass| of_tap(pass, |tap| tap.return_ratio) },
    Column {
        name: "Z servo",
        unit: "error in the thread, µm",
        cell: |pass| format!("{:.2}", pass.z.thread_max_abs_um),
    },
];

fn of_tap(pass: &PassReport, of: fn(&TapReport) -> f64) -> String {
    pass.tap.as_ref().map_or_else(String::new, |tap| format!("{:.2}", of(tap)))
}

/// How many there are, and the farthest off of each part of the way; nothing without a tap.
pub(super) fn says(summary: &Summary, verdict: &mut Verdict) {
    let Some(([inwards, turn, out], [least, most])) = summary.taps_at_worst() else { return };
    let (taps, they) = match summary.taps().count() {
        1 => ("One tap was cut".to_owned(), "It"),
        n => (format!("{n} taps were cut"), "They"),
    };
    let depth = match least < 0.0 {
        true => format!("at most {} deeper than programmed", um(-least)),
        false => format!("at most {} short of the depth", um(most)),
    };
    verdict.say(
        Grade::Good,
        format!(
            "{taps}. {they} kept to the helix within {} on the way in, {} while the spindle turned round and {} on the way \
             out, {depth}.",
            um(inwards),
            um(turn),
            um(out)
        ),
    );
    let too_near = worst_um(summary).is_some_and(|off| off > LOOK_SHARE * summary.part.error_um);
    if too_near {
        more_than_half(summary, "a tap", verdict);
    }
}

/// The farthest of all from its helix; `None` without a tap.
pub(super) fn worst_um(summary: &Summary) -> Option<f64> {
    summary.taps_at_worst().map(|(off, _)| off.into_iter().fold(0.0, f64::max))
}

/// A row for each.
pub(super) fn table(summary: &Summary) -> Option<Table> {
    let taps: Vec<PassReport> = summary.taps().map(|(pass, _)| pass.clone()).collect();
    let caption = "The true slide against the helix at the true angle of the spindle, less the mean of the whole way: the thread \
                   in the hole is as far off its own mean. Short: what the tool lacked of the programmed depth.";
    (!taps.is_empty()).then(|| Table::of("Taps", &COLUMNS, &taps).with_caption(caption))
}

#[cfg(test)]
mod tests {
    use rig::observe::{Outcome, PartVerdict, PassReport, Summary, TapReport, ToolReport};

    use super::super::verdict::{Grade, of};
    use super::table;

    /// Each part of the way has its own figure, and none of a turned pass is told of a tap.
    #[test]
    fn a_tap_is_told_by_its_helix_and_its_depth_along_z() {
        let tap = TapReport { in_um: 3.1, turn_um: 3.4, out_um: 3.6, short_um: 7.0, return_ratio: 1.5 };
        // X of a tap stands where it likes.
        let tool = ToolReport {
            contact_deg: 7200.0,
            x_max_um: 60.0,
            helix_max_abs_um: 3.6,
            ..ToolReport::default()
        };
        let pass = PassReport {
            pass: 1,
            line: 10,
            complete: true,
            same_index: true,
            thread_cycles: 9,
            tool,
            tap: Some(tap),
            ..PassReport::default()
        };
        let mut summary = Summary { outcome: Outcome::Completed, passes: vec![pass], ..Summary::default() };
        summary.passes[0].x_slide.thread_max_abs_um = 60.0;
        summary.part.verdict = PartVerdict::Good;
        let verdict = of(&summary);
        let told = "The program ran to its end. One tap was cut. It kept to the helix within 3.10 µm on the way in, 3.40 µm \
                    while the spindle turned round and 3.60 µm on the way out, at most 7.00 µm short of the depth.";
        assert_eq!((verdict.grade, verdict.sentences.join(" ").as_str()), (Grade::Good, told));
        let rows = table(&summary).expect("a table").rows;
        assert_eq!(rows[0][..5], ["1 (10)", "3.10", "3.40", "3.60", "7.00"]);
        summary.passes[0].tap = Some(TapReport { out_um: 5.2, short_um: -2.0, ..tap });
        let verdict = of(&summary);
        let words = verdict.sentences.join(" ");
        assert!(
            verdict.grade == Grade::Look
                && words.contains("2.00 µm deeper")
                && words.contains("in a tap: name the"),
            "{words}"
        );
    }
}
