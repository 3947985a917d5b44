//! libFuzzer drives `fuzz::program_linuxcnc`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz::program_linuxcnc(bytes));
