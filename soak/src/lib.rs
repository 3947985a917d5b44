//! Random machines, programs and faults, and a judge who knows the truth. In: seeds. Out: for each the first
//! invariant that was broken, and the smallest case that still breaks it.
//!
//! | module | what |
//! |---|---|
//! | [`draw()`] | a case from a seed |
//! | [`case`], [`event`] | what is run, and what happens, as files that a person can run |
//! | [`run`] | one run of a case |
//! | [`judge`] | the invariants, from outside |
//! | [`shrink`] | the smallest case that still breaks the same invariant |
//! | [`driver`] | many seeds on every core |
#![forbid(unsafe_code)]

pub mod case;
mod draw;
pub mod driver;
pub mod event;
pub mod judge;
pub mod run;
pub mod shrink;

pub use draw::draw;
