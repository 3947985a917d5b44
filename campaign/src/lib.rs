//! Campaigns: one command of `pitchlock` over many seeds and values, cut into jobs that any scheduler runs in
//! any order, and one table of what came of them. In: a campaign file. Out: jobs, and a Parquet file.
//!
//! A run is a command line with `--json`; the rows of its document are rows of the table. So whatever prints
//! JSON can be made many times, and every row says the command that makes it again.
//!
//! | module | what |
//! |---|---|
//! | [`plan`] | the campaign file, and the runs and jobs that it asks for |
//! | [`vary`] | machine files with other values in them |
//! | [`rows`] | the rows of a document |
//! | [`folder`] | what is done: a file for each job, written whole or not at all |
//! | `made` | what a campaign is made of, as a hash |
//! | `whole` | files that are there as a whole or not at all |
//! | [`table`] | rows as Parquet |
#![forbid(unsafe_code)]

pub mod folder;
mod made;
pub mod plan;
pub mod rows;
pub mod table;
pub mod vary;
mod whole;

use std::path::PathBuf;

/// Why there is no campaign, or no table of it.
#[derive(Debug, thiserror::Error)]
pub enum CampaignError {
    /// The campaign file, or what it names, is wrong: which, why, what to do.
    #[error("{0}")]
    Input(String),
    /// What a job has left is not of this campaign, or not whole.
    #[error("{0}")]
    Stale(String),
    /// A file cannot be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// Which.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The table cannot be written.
    #[error("the table: {0}")]
    Table(#[from] parquet::errors::ParquetError),
}

impl CampaignError {
    fn file(path: impl Into<PathBuf>) -> impl FnOnce(std::io::Error) -> CampaignError {
        let path = path.into();
        move |source| CampaignError::File { path, source }
    }
}
