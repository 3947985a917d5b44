//! The language as its manual has it: programs in, calls and diagnostics out.

mod compensation;
mod driven;
mod encodings;
mod fanuc;
mod fanuc_mill;
mod files;
mod lengths;
mod machine_codes;
mod ngc;
mod printing;
mod roughing;
