//! The machine as processes: the channels between them ([`ipc`]), and what each of them does ([`shell`]).
//!
//! This is the only crate that names iceoryx2 and the only one that reads the clock of the operating system.
//! The cores that it runs know neither.
#![allow(clippy::disallowed_methods)] // clocks and sleeps are what this crate is for

pub mod ipc;
pub mod link;
pub mod shell;
