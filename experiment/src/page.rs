//! The page of an experiment: the result, what was done, tables, pictures, what it means, and how to make it
//! again. In: findings. Out: HTML with everything in it, drawn as the report of a run is.

use maud::{Markup, html};

use report::{
    page::{document, pictures},
    table::{Place, Table},
};

use super::Findings;

/// The whole page of the experiment of this name; `again` is the command that makes it.
pub(super) fn html<R>(name: &str, again: &str, found: &Findings<R>) -> String {
    let content = html! {
        header {
            p.product { "pitchlock · experiment " (name) }
            h1 { (found.title) }
        }
        div.verdict.result { @for sentence in &found.short { p { (sentence) } } }
        (section("What was done", &found.done))
        @for table in &found.tables { (shown(table)) }
        @if !found.notes.is_empty() { section { h3 { "Notes" } ul { @for note in &found.notes { li { (note) } } } } }
        (pictures(&found.figures, 1))
        @for (heading, paragraphs) in &found.text { (section(heading, paragraphs)) }
        (repeat(again))
    };
    document(name, &content, !found.figures.is_empty())
}

fn section(heading: &str, paragraphs: &[String]) -> Markup {
    html! { section.prose { h2 { (heading) } @for paragraph in paragraphs { p { (paragraph) } } } }
}

fn shown(table: &Table) -> Markup {
    let body = html! {
        (table.markup())
        @if !table.caption.is_empty() { p.caption { (table.caption) } }
    };
    html! {
        @match table.place {
            Place::Everywhere | Place::Page => section { h2 { (table.title) } (body) },
            Place::Details => details { summary { (table.title) } (body) },
        }
    }
}

fn repeat(again: &str) -> Markup {
    html! {
        section.prose {
            h2 { "How to repeat it" }
            p { code { (again) } " prints the tables and draws this page; with " code { "--json" } " it prints the rows \
                as one document, the same as in " code { "rows.json" } " beside this page. The same seed gives the same \
                numbers." }
        }
    }
}
