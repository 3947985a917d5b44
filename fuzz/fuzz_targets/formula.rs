//! libFuzzer drives `fuzz::formula`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz::formula(bytes));
