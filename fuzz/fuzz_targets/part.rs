//! libFuzzer drives `fuzz::part`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz::part(bytes));
