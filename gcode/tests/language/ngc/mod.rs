//! RS274/NGC as LinuxCNC speaks it.

mod again;
mod arcs;
mod check;
mod coordinates;
mod cycles;
mod expressions;
mod flow;
mod lines;
mod modes;
mod parameters;
mod printed;
mod recorded;
mod source;
mod splines;
mod threading;
mod tools;
mod words;
