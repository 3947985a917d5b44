//! Machine code in, setpoints and passes out.
//!
//! Every interpolator cycle an [`Interpolator`] takes the measurement and the status of the axes, and answers with one
//! frame per axis, a spindle command and its own status. Timed moves are planned block by block, at rest in between;
//! a pass of a thread is armed on every axis, watched, and needs nothing more from here once it has begun.
//!
//! | file | what |
//! |---|---|
//! | [`queue`] | items waiting, with credit |
//! | [`block`] | one straight move on the sin²-jerk feed profile, within every axis' limits |
//! | [`pace`] | live overrides and feed hold: how fast path time runs |
//! | [`spindle`] | programmed speed, override and its ceiling, at speed |
//! | `task` | what the interpolator is doing, as one enum |
//! | `begin` | the next item of the program |
//! | [`Interpolator`] | one tick |
#![forbid(unsafe_code)]

mod begin;
pub mod block;
mod interpolator;
pub mod pace;
pub mod queue;
pub mod shell;
pub mod spindle;
mod task;

pub use interpolator::{In, Interpolator, Out};
