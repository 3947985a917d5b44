//! The page of an experiment: what was done, the rows, the pictures, and how to make it again. In: findings. Out: HTML
//! with everything in it, drawn as the report of a run is.

use maud::{Markup, html};

use super::{Findings, table};
use crate::report::page::{document, pictures};

/// The whole page of the experiment of this name.
pub(super) fn html<R>(name: &str, found: &Findings<R>) -> String {
    let content = html! {
        header {
            p.product { "pitchlock · experiment " (name) }
            h1 { (found.title) }
        }
        @for (heading, paragraphs) in &found.text {
            section { h2 { (heading) } @for paragraph in paragraphs { p { (paragraph) } } }
        }
        section {
            h2 { "Rows" }
            (table::markup(found.columns, &found.rows))
            @if !found.notes.is_empty() { h3 { "Notes" } ul { @for note in &found.notes { li { (note) } } } }
        }
        (pictures(&found.figures))
        (again(name))
    };
    document(name, &content, !found.figures.is_empty())
}

fn again(name: &str) -> Markup {
    html! {
        section {
            h2 { "How to repeat it" }
            p { code { "pitchlock experiment " (name) } " prints the table and draws this page; with " code { "--json" }
                " it prints the rows as one document, the same as in " code { "rows.json" } " beside this page." }
        }
    }
}
