//! Canonical machining functions: what a program means, free of its spelling.
//!
//! The names and meanings are those of NIST RS274/NGC as LinuxCNC continued them. Lengths and feeds are in
//! the units that the last [`Call::UseLengthUnits`] named, positions in the coordinate system that the last
//! offsets made, X a radius, angles in degrees.

mod call;
mod decimal;
mod job;
mod linuxcnc;
mod nurbs;
mod place;
mod plain;
mod pose;
mod printer;
mod sink;
mod thread;

pub use call::{Arc, Call, FeedMode, PathMode, Turn};
pub use job::Job;
pub use linuxcnc::LinuxcncPrinter;
pub use nurbs::{Follows, Nurbs};
pub use place::Place;
pub use plain::PlainPrinter;
pub use pose::{A, B, C, Plane, Pose, Units, X, Y, Z};
pub use sink::Sink;
pub use thread::{Degression, ThreadCycle};
