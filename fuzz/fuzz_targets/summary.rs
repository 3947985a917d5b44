//! libFuzzer drives `fuzz::summary`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz::summary(bytes));
