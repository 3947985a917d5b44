//! One regulator against a recorded or ideal machine: states, streams, encoder, structures of control,
//! compensation.

mod allocation;
mod compensation;
mod encoder;
mod losses;
mod stand;
mod states;
mod stream;
mod structures;
