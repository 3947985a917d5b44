//! What crosses a process boundary: its layout, what is packed and unpacked, machine-code files, codes of faults.

mod code_file;
mod faults;
mod layout;
mod wire;
mod wire_work;
