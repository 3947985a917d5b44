#![doc = include_str!("../README.md")]
//!
//! # Laws and their equations
//!
//! | law | type | equations |
//! |---|---|---|
//! | stroke of the transverse axis over a spindle angle, sin² acceleration | [`Stroke`] | M1–M8a |
//! | change of speed (run-in, run-out, feed ramp), sin² jerk | [`Ramp`] | M9–M21 |
//! | change of lead at a corner of a thread, of its growth | [`LeadChange`] | M214–M216 |
//! | one axis over a whole threading pass | [`PassLaw`] | M2, M13–M15, M214 |
//! | feed of one block, ramp – cruise – ramp | [`FeedBlock`] | M22–M27 |
//! | line, arc or piece of a curve as a function of its length, in the space of the axes | [`Path`] | M55–M58, M84, M85 |
//! | change of speed from any acceleration | [`SpeedChange`] | M63–M64 |
//! | a chain of blocks: look-ahead, blends, overrides, hold | [`chain::Chain`] | M24–M26, M65–M66 |
//! | smooth junction of two paths | [`Blend`] | M59–M62 |
//! | speed and acceleration of the spindle from its encoder count | [`SpindleObserver`] | M53 |
//! | what of its angle repeats with every turn | [`Ripple`] | M130 |
//!
//! A law maps a time-like parameter `p` to a [`Sample`]: the path and its four derivatives with respect to
//! `p`. For a thread `p` is the *time at programmed speed*, `p = (C − C0)/(6 S)` (M1), so the path follows
//! the measured spindle angle; [`Sample::driven`] turns the derivatives into those with respect to real time
//! (M8).
//!
//! Units are coherent: a length given in mm yields mm, mm/s, …, mm/s⁴; a length in m yields m, …, m/s⁴. All
//! types but [`chain::Chain`] are plain `Copy` values. Nothing allocates after it was made, and every
//! evaluation has a bounded cost.
#![forbid(unsafe_code)]

mod blend;
pub mod chain;
mod change;
mod exit;
mod feed;
mod lead;
mod limits;
mod observer;
mod pass;
mod path;
mod ramp;
mod reach;
mod ripple;
mod sample;
mod search;
mod stroke;
mod versine;

pub use blend::Blend;
pub use change::SpeedChange;
pub use exit::Exit;
pub use feed::{FeedBlock, Unreachable, junction_distance, reachable_feed};
pub use lead::LeadChange;
pub use limits::Limits;
pub use observer::{SpindleMotion, SpindleObserver};
pub use pass::{MOST_CHANGES, PassLaw, Window};
pub use path::Path;
pub use ramp::{Binding, Ramp};
pub use ripple::Ripple;
pub use sample::Sample;
pub use stroke::Stroke;
