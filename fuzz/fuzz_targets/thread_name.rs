//! libFuzzer drives `fuzz::thread_name`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz::thread_name(bytes));
