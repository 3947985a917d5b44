#![doc = include_str!("../README.md")]
//!
//! # Laws and their equations
//!
//! | law | type | equations |
//! |---|---|---|
//! | stroke of the transverse axis over a spindle angle, sin² acceleration | [`Stroke`] | M1–M8a |
//! | change of speed (run-in, run-out, feed ramp), sin² jerk | [`Ramp`] | M9–M21 |
//! | one axis over a whole threading pass | [`PassLaw`] | M2, M13–M15 |
//! | feed of one block, ramp – cruise – ramp | [`FeedBlock`] | M22–M27 |
//! | line, arc or piece of a curve as a function of its length, in the space of the axes | [`Path`] | M55–M58, M84, M85 |
//! | change of speed from any acceleration | [`SpeedChange`] | M63–M64 |
//! | a chain of blocks: look-ahead, blends, overrides, hold | [`chain::Chain`] | M24–M26, M65–M66 |
//! | smooth junction of two paths | [`Blend`] | M59–M62 |
//! | speed and acceleration of the spindle from its encoder count | [`SpindleObserver`] | M53 |
//!
//! A law maps a time-like parameter `p` to a [`Sample`]: the path and its four derivatives with respect to `p`. For
//! a thread `p` is the *time at programmed speed*, `p = (C − C0)/(6 S)` (M1), so the path follows the measured
//! spindle angle; [`Sample::driven`] turns the derivatives into those with respect to real time (M8).
//!
//! Units are coherent: a length given in mm yields mm, mm/s, …, mm/s⁴; a length in m yields m, …, m/s⁴.
//! Two lines with a corner that is rounded within 0.02 mm, planned ahead and asked for every 2 ms:
//!
//! ```
//! use motion::chain::{Ask, Block, Chain, Corner, Feed, Ratios, Settings};
//! use motion::{Limits, Path};
//!
//! // mm/s, mm/s², mm/s³, mm/s⁴ of X and of Y
//! let axes = [Limits { v: 150.0, a: 2000.0, j: 80_000.0, dj: 8.0e6 }; 2];
//! let mut chain: Chain<2, &str> = Chain::new(Settings { axes, cycle_s: 0.002 });
//! let lines = [("across", [40.0, 0.0], Corner::Blend(0.02)), ("up", [0.0, 25.0], Corner::Stop)];
//! for (tag, way, corner) in lines {
//!     let path = Path::line(way, &[true; 2]).expect("it has a length");
//!     chain.push(Block { path, feed: Feed::PerSecond(50.0), corner, room: 1.0, chord_mm: 0.001, tag });
//! }
//! chain.close();
//!
//! let ask = Ask { ratios: Ratios::full(0.0), hold: false, single: false, more: false };
//! let (mut slowest_at_corner, mut last) = (f64::INFINITY, None);
//! while let Some(step) = chain.tick(&ask) {
//!     assert!(step.axes.iter().zip(&axes).all(|(axis, limit)| axis.a.abs() <= limit.a));
//!     if last.is_some_and(|before: motion::chain::Step<2, &str>| before.tag != step.tag) {
//!         slowest_at_corner = step.along.v;
//!     }
//!     last = Some(step);
//! }
//! let end = last.expect("it moved");
//! assert!(slowest_at_corner > 1.0, "no stop at the corner");
//! assert!((end.axes[1].s - 25.0).abs() < 1e-9 && end.along.v == 0.0, "at rest at its end");
//! ```
//!
//! All types but [`chain::Chain`] are plain `Copy` values. Nothing allocates after it was made, and every evaluation has a
//! bounded cost.
#![forbid(unsafe_code)]

mod blend;
pub mod chain;
mod change;
mod feed;
mod limits;
mod observer;
mod pass;
mod path;
mod ramp;
mod reach;
mod sample;
mod search;
mod stroke;
mod versine;

pub use blend::Blend;
pub use change::SpeedChange;
pub use feed::{FeedBlock, Unreachable, junction_distance, reachable_feed};
pub use limits::Limits;
pub use observer::{SpindleMotion, SpindleObserver};
pub use pass::{PassLaw, Window};
pub use path::Path;
pub use ramp::{Binding, Ramp};
pub use sample::Sample;
pub use stroke::Stroke;
