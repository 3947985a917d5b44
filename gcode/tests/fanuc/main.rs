//! FANUC lathe programs, from text to calls.

mod blocks;
mod common;
mod cycles;
mod errors;
mod examples;
mod flow;
mod macros;
mod threads;
mod tools;
