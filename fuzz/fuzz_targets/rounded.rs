#![no_main]
//! Fuzzes [`colltrans_testkit::oracle::fuzz::rounded`]. An ordinary test also runs its corpus.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| colltrans_testkit::oracle::fuzz::rounded(bytes));
