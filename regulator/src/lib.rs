//! One axis, synchronous with the spindle or with time.
//!
//! Every control cycle a [`Regulator`] takes the measurement, and at interpolator ticks a frame, and answers
//! with a command to its drive and a status. The reference comes from setpoints (timed motion) or from the
//! law of a pass evaluated at the measured spindle angle; the loops below do not know which (M54).
//!
//! | file | what |
//! |---|---|
//! | [`state`] | the states of an axis as one enum, one transition function |
//! | [`spindle`] | spindle angle, speed and acceleration from counts (M53), index |
//! | [`leave`] | how an axis leaves a pass or a stream (M99, M100) |
//! | `watch` | what makes it leave: its own errors, the operator, the drives of the other axes |
//! | [`encoder`] | whether the counts can be true, and every index comes (M70, M71) |
//! | [`stream`] | timed motion between setpoints |
//! | [`reference`](mod@reference) | where the axis shall be: now, and about it, at the leads of the feedforwards (M8, M54) |
//! | [`compensation`] | what the motor does besides, for backlash and the error of the screw (M68, M69) |
//! | [`elastic`] | what the motor does besides, for what the drive train gives (M131) |
//! | [`feedforward`] | structures of feedforward: which of them feeds what (M54, M67) |
//! | [`learning`] | torque that each place of a turn of the motor needs besides (M133) |
//! | [`loops`] | position loop, feedforward of mass and friction (M54) |
#![forbid(unsafe_code)]

pub mod compensation;
pub mod elastic;
pub mod encoder;
pub mod feedforward;
mod jumps;
pub mod learning;
pub mod leave;
mod lift;
pub mod loops;
pub mod reference;
mod regulator;
pub mod spindle;
pub mod state;
pub mod stream;
mod watch;

pub use regulator::{In, Out, Regulator};
