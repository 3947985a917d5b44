//! libFuzzer drives `fuzz::job_text`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz::job_text(bytes));
