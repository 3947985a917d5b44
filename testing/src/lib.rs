//! What tests and benches of every crate share: [`Seed`], numbers that look random and are the same in every
//! run, and [`mod@reference`], the loader of reference values. Only tests, benches and `soak` depend on this
//! crate.

pub mod reference;
mod seed;

pub use seed::{Seed, count};
