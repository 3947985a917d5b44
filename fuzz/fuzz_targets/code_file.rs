//! libFuzzer drives `fuzz::code_file`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz::code_file(bytes));
