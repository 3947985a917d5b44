//! The page of an adviser: verdict, tables, pictures, how it is to be read. In: what was asked, answers, the
//! command that says the same again. Out: HTML with everything in it.

use maud::html;

use super::{Asked, figures, tables, verdict::Verdict};
use report::{
    page::{document, pictures},
    table::Table,
};

/// The whole page.
pub(super) fn html(again: &str, asked: &Asked, verdicts: &[Verdict]) -> String {
    let table = |table: Table| {
        html! { section { h2 { (table.title) } (table.markup()) p.caption { (table.caption) } } }
    };
    let content = html! {
        header {
            p.product { "pitchlock · resolution" }
            h1 { (asked.name()) ": how fine it has to count" }
        }
        div.verdict.result {
            @for line in tables::head(asked).into_iter().chain(tables::sentences(asked, verdicts)) { p { (line) } }
        }
        section.prose {
            h2 { "What was done" }
            @for paragraph in PROSE { p { (paragraph) } }
        }
        (table(tables::answers(verdicts)))
        @if let Some(behind) = tables::behind(asked) { (table(behind)) }
        (table(tables::needed(asked)))
        (table(tables::differences(asked)))
        (pictures(&figures::all(asked), 1))
        section.prose {
            h2 { "How to repeat it" }
            p { code { (again) } " prints the tables." }
        }
    };
    document("resolution", &content, true)
}

const PROSE: [&str; 4] = [
    "The tolerance of the parts is divided into K_m steps of position, the highest feed into K_F steps of speed, the highest \
     acceleration into K_a and the highest jerk into K_J: each is the coarsest step a control may have there. The method and \
     its numbers are those of a published investigation of the discreteness of interpolation.",
    "Its \"int-up\" of the decimal order is used both ways in the source: rounded up, IT7 would be content with steps of 1e-2 \
     mm, where it says 1e-3 mm; rounded down, 30 m/min at 2.5 kHz with K_F 3e4 need 1e-6 mm, where it says 1e-5 mm. Here an \
     order is never coarser than the step that is needed: rounded down.",
    "A control that makes speed, acceleration and jerk by differences of counted positions needs counts as fine as the finest \
     of these steps, D times finer than it has. Here nothing is differenced: the law of motion gives each in double \
     precision, and only positions are counted, in steps of 1e-9 mm.",
    "On an axis that turns everything is in degrees; the tolerance is the angle under which it is seen from the centre of \
     the part, at the radius named above. X of a lathe makes diameters and moves by half of them: it gets half of the tolerance.",
];
