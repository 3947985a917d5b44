//! The language, from text to calls.

mod arcs;
mod check;
mod common;
mod coordinates;
mod cycles;
mod expressions;
mod flow;
mod lines;
mod modes;
mod parameters;
mod printed;
mod source;
mod threading;
mod tools;
mod words;
