//! The page of a certificate. In: the certificate, the program's name, the command that says the same again.
//! Out: HTML with everything in it.

use maud::{Markup, html};
use report::{
    page::{document, pictures},
    paint::{BLUE, Figure, ORANGE, axis},
};
use rig::observe::PartVerdict;
use serde_json::{Value, json};

use super::{Certificate, Row};

/// The whole page.
pub(crate) fn html(certificate: &Certificate, program: &str, again: &str) -> String {
    let content = html! {
        header {
            p.product { "pitchlock · certificate" }
            h1 { (program) }
        }
        (verdict(certificate))
        @for table in certificate.tables() {
            section {
                h2 { (table.title) }
                (table.markup())
                p.caption { (table.caption) }
            }
        }
        (pictures(&figures(certificate), 1))
        section.prose {
            h2 { "What was done" }
            p { (DONE) }
            p { code { (again) } " prints the table." }
        }
    };
    document("certificate", &content, true)
}

fn verdict(certificate: &Certificate) -> Markup {
    html! {
        div.verdict.(certificate.class()) {
            p { "It was " (certificate.sentence()) "." }
            @for reason in &certificate.reasons { p { (if certificate.verdict == PartVerdict::Bad { "Not good: " } else { "No verdict: " }) (reason) } }
            @if let Some(gauge) = &certificate.gauge { p { "Gauge: " (gauge) } }
            @for note in &certificate.notes { p { (note) } }
        }
    }
}

pub(super) const COLUMNS: &str = "Run-in, run-out: the way along the thread while the lead is reached and while it is left, at the highest \
     override that the pass is laid out for. Most S, override: what the axes can follow. Deeper: than the last pass of the \
     same start; X is a radius. Chip: its thickness on the flank that takes most. Force, torque, power: the largest. Helix: \
     the slide in the material off the helix, about its mean; depth: off the depth, the largest of either sign.";

const DONE: &str = "The program was run once, in virtual time, on the simulated machine that the machine file describes; pauses \
     were gone on from at once. What the simulated machine does not know (chatter, a worn edge, a part that bends) is not in \
     the figures.";

/// What each pass takes, and what it is off by.
fn figures(certificate: &Certificate) -> Vec<Figure> {
    let force = |row: &Row| row.force_n;
    let error = |row: &Row| row.helix_um;
    let passes = &certificate.passes;
    let mut figures = Vec::new();
    if passes.iter().any(|row| row.force_n.is_some()) {
        figures.push(bars(
            "Cutting force, pass by pass",
            "The largest tangential force of each pass. Even bars load the edge evenly.",
            passes,
            (force, "force (N)", ORANGE),
        ));
    }
    if passes.iter().any(|row| row.helix_um.is_some()) {
        figures.push(bars(
            "Helix error at the tool, pass by pass",
            "The largest distance of the slide from the programmed helix, about the mean of the pass.",
            passes,
            (error, "error (µm)", BLUE),
        ));
    }
    figures
}

type Quantity = (fn(&Row) -> Option<f64>, &'static str, &'static str);

fn bars(title: &str, caption: &str, passes: &[Row], (of, unit, color): Quantity) -> Figure {
    let x: Vec<u32> = passes.iter().map(|row| row.pass).collect();
    let y: Vec<Option<f64>> = passes.iter().map(of).collect();
    let bars: Value = json!({ "type": "bar", "name": unit, "x": x, "y": y, "marker": { "color": color } });
    Figure {
        title: title.into(),
        caption: caption.into(),
        alt: format!("{title}: a bar for each of {} passes.", passes.len()),
        plot: json!({ "data": [bars], "layout": { "xaxis": axis("pass"), "yaxis": axis(unit), "showlegend": false } }),
        aspect: 0.35,
    }
}
