//! Channels and name spaces, within one process and across several that live and die.

mod ports;
mod processes;
