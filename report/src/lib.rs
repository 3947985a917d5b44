//! Pages that hold everything they need: tables, pictures, the script that draws them, and the report of a
//! run.
//!
//! | module | in | out |
//! |---|---|---|
//! | [`colours`] | the place of something in its order | a colour for the ground of the page |
//! | [`paint`] | points, names, colours | pictures as the plotting script takes them |
//! | [`table`] | rows seen through columns | text for a terminal, HTML for a page |
//! | [`page`] | content and pictures | one HTML file that opens without a network |
//! | [`render`] | a run folder | its `report.html` |
//!
//! The plotting script is an asset of this crate ([`page::PLOTTING_SCRIPT`]): plotly.js as its authors built
//! it, of which `report/assets/README.md` says version, licence and origin.
#![forbid(unsafe_code)]

pub mod colours;
mod envelope;
pub mod page;
pub mod paint;
mod run;
pub mod table;

pub use run::{ReportError, damage, render};
