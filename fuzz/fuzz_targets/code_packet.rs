//! libFuzzer drives `fuzz::code_packet`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz::code_packet(bytes));
