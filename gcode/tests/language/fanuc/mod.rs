//! FANUC lathe programs, from text to calls.

mod blocks;
mod cycles;
mod drilling;
mod errors;
mod examples;
mod flow;
mod habits;
mod macros;
mod order;
mod points;
pub(crate) mod recorded;
mod refusals;
mod simulator;
mod system;
mod taps;
mod thin;
mod threads;
mod tools;
