//! libFuzzer drives `fuzz::language`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz::language(bytes));
