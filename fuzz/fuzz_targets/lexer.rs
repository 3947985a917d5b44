//! libFuzzer drives `fuzz::lexer`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz::lexer(bytes));
