//! What an experiment gives: its findings, or why it was not made.

use report::{paint::Figure, table::Table};

/// Why an experiment was not made.
#[derive(Debug, thiserror::Error)]
pub enum ExperimentError {
    /// The machine is not one for this experiment; the text says what would be right.
    #[error("{0}")]
    Input(String),
    /// The machine did not do what the experiment needs.
    #[error("{0}")]
    Machine(String),
}

/// What an experiment found: rows of type `R`, one a case.
pub(crate) struct Findings<R> {
    /// Heading of the page.
    pub(crate) title: &'static str,
    /// The result in a few sentences.
    pub(crate) short: Vec<String>,
    /// What was done, in paragraphs.
    pub(crate) done: Vec<String>,
    /// The content of the JSON document.
    pub(crate) rows: Vec<R>,
    /// What is shown of them on the screen and on the page.
    pub(crate) tables: Vec<Table>,
    /// Remarks on single rows, below the tables.
    pub(crate) notes: Vec<String>,
    pub(crate) figures: Vec<Figure>,
    /// What it means, after the pictures: headings with their paragraphs.
    pub(crate) text: Vec<(&'static str, Vec<String>)>,
}
