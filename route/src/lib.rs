//! The one walk from machine code to what a chain plans: moves and works of a program as blocks with paths,
//! feeds and corners.
//!
//! ```text
//! terms  ←  legs  ←  route  ←  course        in_force  ←  approach
//! ```
//!
//! [`Route`] makes a block of a move, a [`Course`] the blocks of a work, piece by piece. The interpolator
//! moves along these blocks, and the interpreter foretells how long that takes: both ask here, so that they
//! mean the same path.
//!
//! [`in_force`] reads a program that is not executed, [`approach`] leads a tool to where it is begun then.

pub mod approach;
mod course;
pub mod in_force;
mod legs;
pub mod positioner;
mod route;
mod terms;

pub use course::{Advance, Course, START_REACH_MM};
pub use route::{Route, Routed};
pub use terms::{Cut, Move, Spot, Stretch, Unworkable};
