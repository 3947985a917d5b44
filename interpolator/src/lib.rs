//! Machine code in, setpoints and passes out.
//!
//! Every interpolator cycle an [`Interpolator`] takes the measurement and the status of the axes, and answers
//! with one frame per axis, a spindle command and its own status. Timed moves are planned ahead over chains
//! of up to a thousand; a pass of a thread is armed on every axis, watched, and needs nothing more from here
//! once it has begun.
//!
//! | file | what |
//! |---|---|
//! | [`Interpolator`], `answer` | one tick: an event is found, the task goes one step, frames go out |
//! | `task` | what the interpolator is doing: every state, every event, one function |
//! | `program`, [`queue`] | the item in hand, what is executed at rest, items waiting, credit |
//! | `hand` | blocks that are given by hand, one by one: whether another is there, whether a jog goes on |
//! | `reference` | reference runs: which way is next, and what makes the position true |
//! | `outputs` | outputs, at rest and in step with motion, and when they become safe |
//! | `travel`, `run` | timed motion: moves that run without a stop, overrides, hold, single block |
//! | `working` | the work in hand, piece by piece |
//! | `pass` | a pass before it is armed, and while it is watched |
//! | `axes` | what the regulators say, taken together, and whether they say anything new |
//! | `supervise` | what ends every task: axes, drives, spindle, panel, waits that are too long |
//! | `guard` | slows the spindle where an axis comes near its limits in a thread |
//! | [`spindle`] | programmed speed, override and its ceiling, at speed; whether it does what it is told |
//! | `tap` | turns the spindle round in a tap |
//! | `patience` | waits that are too long |
#![forbid(unsafe_code)]

mod axes;
mod guard;
mod hand;
mod interpolator;
mod outputs;
mod pass;
mod patience;
mod program;
pub mod queue;
mod reference;
mod run;
pub mod spindle;
mod tap;
mod task;
mod travel;
mod working;

pub use interpolator::{In, Interpolator, Out};
