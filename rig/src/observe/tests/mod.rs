//! What is injected is what is measured.

pub(crate) mod ideal;
mod measures;
mod run;
