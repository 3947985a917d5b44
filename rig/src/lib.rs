//! The whole machine in one process, and what is measured of a run: [`observe`] sees the true state of the
//! plant and measures every pass, [`trace`] writes and reads what happened in every control cycle, [`trial`]
//! makes passes to be measured, [`mod@bench`] tunes its axes. What lies between the modules are [`wires`],
//! which a test can disturb. A [`supervisor`] brings it to rest when a part of it has died; [`standstill`]
//! finds one that waits for nobody. [`mod@resume`] plans how a program that was broken off is gone on with.

pub mod bench;
pub mod hash;
pub mod journal;
mod lives;
mod modules;
pub mod observe;
pub mod replay;
pub mod resume;
mod rig;
pub mod standstill;
pub mod supervisor;
pub mod trace;
pub mod trial;
pub mod wires;

pub use rig::{Exchange, Rig};
