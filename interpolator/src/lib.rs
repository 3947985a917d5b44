//! Machine code in, setpoints and passes out.
//!
//! Every interpolator cycle an [`Interpolator`] takes the measurement and the status of the axes, and answers with one
//! frame per axis, a spindle command and its own status. Timed moves are planned ahead over chains of up to a thousand;
//! a pass of a thread is armed on every axis, watched, and needs nothing more from here once it has begun.
//!
//! | file | what |
//! |---|---|
//! | [`queue`] | items waiting, with credit |
//! | `travel` | timed motion: the chain of moves, overrides, hold, single block |
//! | `tracing` | the trace in hand, piece by piece |
//! | [`spindle`] | programmed speed, override and its ceiling, at speed |
//! | `task` | what the interpolator is doing, as one enum |
//! | `begin` | the next item of the program |
//! | [`Interpolator`] | one tick |
#![forbid(unsafe_code)]

mod begin;
mod interpolator;
pub mod queue;
pub mod spindle;
mod task;
mod tracing;
mod travel;

pub use interpolator::{In, Interpolator, Out};
