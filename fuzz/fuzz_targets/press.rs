//! libFuzzer drives `fuzz::press`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz::press(bytes));
