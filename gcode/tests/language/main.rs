//! The language, from text to calls.

mod common;
mod expressions;
mod flow;
mod parameters;
mod source;
mod words;
