//! Commissioning of one axis from short test moves: what moves, what rubs, what delays, what swings; and the
//! loops that follow from it.
//!
//! Enters: a [`Bench`], on which a machine shows its measurements and takes drive commands. Leaves: a
//! [`Tuned`] axis: every identified value with its deviation, the margins of the loops before and after, and
//! the proposed `[axis.*]`. Nothing is known of the machine but its `[axis.*]` and what it measures.
//!
//! | file | what it holds |
//! |---|---|
//! | `stand` | drives the axis through test moves, watches over them, records them |
//! | `drive_loop` | the torque that the drive commands, known from its configuration |
//! | `rigid` | mass, Coulomb and viscous friction from impulses (M78) |
//! | `cogging` | what comes back with every turn of the motor, from slow runs (M133) |
//! | `presliding` | stiffness of friction before it slides, from small reversals (M79) |
//! | `excitation`, `response` | a multisine on the torque, and what the axis answers to it |
//! | `torque_path` | delay and lag from commanded to measured torque (M80) |
//! | `mode` | the mode of the slide (M81) |
//! | `margins`, `proposal` | the loops built on the measured response (M82) |
//! | `least_squares` | linear least squares with deviations |
#![forbid(unsafe_code)]

mod cogging;
mod drive_loop;
mod estimate;
mod excitation;
mod least_squares;
mod margins;
mod mode;
mod presliding;
mod proposal;
mod refusal;
mod response;
mod rigid;
mod stand;
mod torque_path;
mod tuned;

pub use cogging::Wave;
pub use estimate::Estimate;
pub use margins::{LoopMargins, Margins, OpenLoops, Timing};
pub use mode::Mode;
pub use nalgebra::Complex;
pub use proposal::Goals;
pub use refusal::Refusal;
pub use response::Line;
pub use stand::Bench;
pub use tuned::{Tuned, tune, tune_towards};
