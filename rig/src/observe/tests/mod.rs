//! What is injected is what is measured.

mod contour;
pub(crate) mod ideal;
mod measures;
mod run;
mod tool;
mod traces;
