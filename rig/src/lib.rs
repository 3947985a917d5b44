//! The whole machine in one process, and what is measured of a run: [`observe`] sees the true state of the plant and
//! measures every pass, [`trace`] writes and reads what happened in every control cycle.

pub mod observe;
mod rig;
pub mod trace;

pub use rig::Rig;
