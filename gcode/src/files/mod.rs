//! Files beside the program: tool table, parameters, machine description.

mod tools;

pub use tools::{Tool, ToolTable};
