//! A recorded run, made again: [`Arrivals`] are what a run folder keeps of what the modules took, a
//! [`Replica`] are the modules that take it again, and [`fields`] are the fields of a message by their names,
//! to say in which of them two runs differ.

mod arrivals;
mod fields;
mod replica;
mod sealed;

pub use arrivals::{Arrivals, Change, Collector, MOST, MOST_BYTES};
pub use fields::{fields, first_difference};
pub use replica::Replica;
