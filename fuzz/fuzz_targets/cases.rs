#![no_main]
//! Fuzzes `documents::cases`.

#[path = "../documents.rs"]
#[allow(dead_code, reason = "each target is one of its functions")]
mod documents;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| documents::cases(bytes));
