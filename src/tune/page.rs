//! The page of a commissioning. In: what was found, the command that finds it again. Out: HTML with
//! everything in it.

use maud::html;

use super::{Found, figures, tables};
use report::{
    page::{document, pictures},
    table::Table,
};

/// The whole page.
pub(super) fn html(again: &str, found: &Found) -> String {
    let names: Vec<String> = found.tuned.iter().map(|tuned| tuned.axis.to_string()).collect();
    let table = |table: Table| {
        html! { section { h2 { (table.title) } (table.markup()) p.caption { (table.caption) } } }
    };
    let content = html! {
        header {
            p.product { "pitchlock · tune" }
            h1 { (found.machine.general.name) ": " (names.join(", ")) " commissioned" }
        }
        div.verdict.result {
            @for tuned in &found.tuned { @for sentence in tables::sentences(found, tuned) { p { (sentence) } } }
        }
        section.prose {
            h2 { "What was done" }
            p {
                "Each axis was moved by short test moves on its drive: runs both ways at five speeds, strokes of 50 µm to \
                 6 µm both ways, and a run at an even speed with many sines on the torque. Mass, friction, delays and the \
                 mode of the slide were identified from measured positions and torques alone, and the gains laid out on \
                 the frequency response as it was measured."
            }
        }
        @for tuned in &found.tuned {
            (table(tables::changes(found, tuned)))
            (table(tables::margins(tuned)))
        }
        @match &found.trial {
            Ok(compared) => {
                @for (axis, _) in &compared.curves { (table(tables::trial(*axis, &compared.rows))) }
                @for failure in tables::failures(&compared.rows) { p { (failure) } }
            }
            Err(reason) => section.prose { p { "No trial pass: " (reason) } },
        }
        (pictures(&figures::all(found), 1))
        section.prose {
            h2 { "How to repeat it" }
            p { code { (again) } " prints the tables; the same seed gives the same numbers." }
        }
    };
    document("tune", &content, true)
}
