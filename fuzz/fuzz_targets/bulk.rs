#![no_main]
//! See [`colltrans_testkit::oracle::fuzz::bulk`]: the corpus runs through it as an ordinary test too.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| colltrans_testkit::oracle::fuzz::bulk(bytes));
