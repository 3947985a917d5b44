//! What the gauge says of a thread. In: its report. Out: a sentence of the verdict, and a table.

use maud::{Markup, html};
use rig::observe::{GaugeReport, PartVerdict, Summary};

use super::verdict::{Grade, Verdict};

/// A sentence; reasons against the part are said with those of the part.
pub(super) fn says(summary: &Summary, verdict: &mut Verdict) {
    if let Some(groove) = summary.groove.as_ref().filter(|groove| groove.verdict != PartVerdict::Bad) {
        let good = groove.verdict == PartVerdict::Good;
        let grade = if good { Grade::Good } else { Grade::Look };
        verdict.say(grade, format!("Groove: {}.", groove.sentence()));
    }
    for gauge in summary.gauged() {
        match gauge.verdict {
            PartVerdict::Good => verdict.say(Grade::Good, format!("Gauge: {}.", gauge.sentence())),
            PartVerdict::None => verdict.say(Grade::Look, format!("Gauge: {}.", gauge.sentence())),
            PartVerdict::Bad => {}
        }
    }
}

/// What was measured, and what is allowed.
fn rows(gauge: &GaugeReport) -> Vec<(&'static str, String, String)> {
    let [least, most] = gauge.limits.pitch_diameter_mm;
    let limits = format!("{least:.3} to {most:.3} mm");
    let degrees =
        |flanks: &[f64]| flanks.iter().map(|deg| format!("{deg:.2}°")).collect::<Vec<_>>().join(", ");
    let pitch = format!("{:.4} to {:.4} mm", gauge.pitch_diameter_min_mm, gauge.pitch_diameter_max_mm);
    let virtual_mm = format!("{:.4} mm", gauge.virtual_pitch_diameter_mm);
    let go = match gauge.limits.side.as_str() {
        "internal" => format!("at least {least:.3} mm"),
        _ => format!("at most {most:.3} mm"),
    };
    let um = |um: f64| format!("{um:.2} µm");
    let crest = span(&gauge.crest_mm).unwrap_or_else(|| "not judged".into());
    let root = span(&gauge.root_mm).unwrap_or_default();
    let standoff = gauge.standoff_mm.map(|mm| {
        let found = format!("{mm:+.3} mm, {:+.2} turns", mm / gauge.limits.pitch_mm);
        ("GO before its plane", found, "in GO and NO-GO".into())
    });
    let mut rows = vec![
        ("Pitch diameter", pitch, limits),
        ("Virtual pitch diameter (GO)", virtual_mm, go),
        ("Crest, diameter", crest, asked(gauge.limits.crest_mm)),
        ("Root, diameter", root, asked(root_asked(gauge))),
        ("Flanks", degrees(&gauge.flank_deg), degrees(&gauge.limits.flank_deg)),
        ("Lead error", um(gauge.lead_error_um), "in GO".into()),
        ("Drunkenness", um(gauge.drunkenness_um), "in GO".into()),
        ("Starts", um(gauge.starts_um), "in GO".into()),
        ("Taper", um(gauge.taper_um), "in GO and NO-GO".into()),
        ("Runout", um(gauge.runout_um), "in GO and NO-GO".into()),
        (
            "Length of full thread",
            format!("{:.2} mm", gauge.length_mm),
            format!("GO gauge of {:.2} mm", gauge.limits.length_mm),
        ),
    ];
    rows.extend(standoff);
    rows.extend(gauge.blunt_turns.map(|[gone, whole]| {
        let found = format!("gone for {gone:.2} turns, whole from {whole:.2} on");
        ("Blunt start", found, "in the name".into())
    }));
    rows
}

/// Smallest and largest diameter that was found; `None` if nobody knows.
fn span(found: &[f64]) -> Option<String> {
    let (least, most) = (found.first()?, found.last()?);
    let is_one = most - least < 5e-5;
    Some(if is_one { format!("{least:.4} mm") } else { format!("{least:.4} to {most:.4} mm") })
}

/// What is asked of a diameter.
fn asked([least, most]: [Option<f64>; 2]) -> String {
    match (least, most) {
        (Some(least), Some(most)) => format!("{least:.3} to {most:.3} mm"),
        (Some(least), None) => format!("at least {least:.3} mm"),
        (None, Some(most)) => format!("at most {most:.3} mm"),
        (None, None) => "nothing".into(),
    }
}

/// Limits of the root, with that of the GO gauge.
fn root_asked(gauge: &GaugeReport) -> [Option<f64>; 2] {
    let [mut least, mut most] = gauge.limits.root_mm;
    let go = gauge.limits.root_go_mm;
    if gauge.limits.side == "internal" {
        least = [least, go].into_iter().flatten().reduce(f64::max);
    } else {
        most = [most, go].into_iter().flatten().reduce(f64::min);
    }
    [least, most]
}

/// The section of the page.
pub(super) fn table(gauge: &GaugeReport) -> Markup {
    html! {
        section {
            h2 { "Gauge" }
            p { (gauge.sentence()) "." @for note in &gauge.notes { " Note: " (note) "." } }
            @if gauge.length_mm > 0.0 {
                div.scroll tabindex="0" role="region" aria-label="Table of the gauge" {
                    table.plain {
                        thead { tr { th scope="col" { "Measure" } th scope="col" { "Found" } th scope="col" { "Asked" } } }
                        tbody { @for (what, found, asked) in rows(gauge) {
                            tr { td { (what) } td { (found) } td { (asked) } }
                        } }
                    }
                }
            }
        }
    }
}
