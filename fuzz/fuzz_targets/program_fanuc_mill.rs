//! libFuzzer drives `fuzz::program_fanuc_mill`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz::program_fanuc_mill(bytes));
