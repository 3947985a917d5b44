//! Seeds of the soak, and whether it would find a reaction that is missing.

mod copies;
mod hidden;
mod mutants;
