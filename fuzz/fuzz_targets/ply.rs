#![no_main]
//! See `readers::ply`: the corpus runs through it as an ordinary test too.

#[path = "../readers.rs"]
#[allow(dead_code, reason = "each target is one of its functions")]
mod readers;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| readers::ply(bytes));
