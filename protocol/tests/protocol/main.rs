//! What crosses a process boundary: its layout, what is packed and unpacked, and in how many bytes,
//! machine-code files, codes of faults.

mod code_file;
mod faults;
mod layout;
mod packets;
mod wire;
mod wire_work;
