#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| plume_fuzz::read("walls", bytes));
