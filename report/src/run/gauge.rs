//! What the gauge says of a thread. In: its report. Out: a sentence of the verdict, and a table.

use maud::{Markup, html};
use rig::observe::{GaugeReport, PartVerdict, Summary};

use super::verdict::{Grade, Verdict};

/// A sentence; reasons against the part are said with those of the part.
pub(super) fn says(summary: &Summary, verdict: &mut Verdict) {
    let Some(gauge) = &summary.gauge else { return };
    match gauge.verdict {
        PartVerdict::Good => verdict.say(Grade::Good, format!("Gauge: {}.", gauge.sentence())),
        PartVerdict::None => verdict.say(Grade::Look, format!("Gauge: {}.", gauge.sentence())),
        PartVerdict::Bad => {}
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
    let um = |um: f64| format!("{um:.2} µm");
    vec![
        ("Pitch diameter", pitch, limits.clone()),
        ("Virtual pitch diameter (GO)", virtual_mm, limits),
        ("Flanks", degrees(&gauge.flank_deg), degrees(&gauge.limits.flank_deg)),
        ("Lead error", um(gauge.lead_error_um), "in GO".into()),
        ("Drunkenness", um(gauge.drunkenness_um), "in GO".into()),
        ("Starts", um(gauge.starts_um), "in GO".into()),
        ("Taper", um(gauge.taper_um), "in GO and NO-GO".into()),
        ("Runout", um(gauge.runout_um), "in GO and NO-GO".into()),
        ("Length of full thread", format!("{:.2} mm", gauge.length_mm), String::new()),
    ]
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
