#![no_main]
//! Fuzzes `readers::manifest`. An ordinary test also runs its corpus.

#[path = "../readers.rs"]
#[allow(dead_code, reason = "each target is one of its functions")]
mod readers;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| readers::manifest(bytes));
