//! libFuzzer drives `fuzz::arrivals_live`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz::arrivals_live(bytes));
