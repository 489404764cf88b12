#![no_main]
//! See [`colltrans_oracle::fuzz::solids`]: the corpus runs through it as an ordinary test too.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| colltrans_oracle::fuzz::solids(bytes));
