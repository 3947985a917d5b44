//! libFuzzer drives `fuzz::program_fanuc`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz::program_fanuc(bytes));
