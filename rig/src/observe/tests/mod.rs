//! What is injected is what is measured.

mod contour;
mod gauge;
pub(crate) mod ideal;
mod measures;
mod run;
mod tool;
mod traces;
