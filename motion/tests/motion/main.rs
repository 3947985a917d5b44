//! Laws, paths and the observer against their equations, random cases and reference values.

mod lead;
mod observer;
mod pass;
mod properties;
mod reference;
mod run_in;
