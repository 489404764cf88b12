//! The module `distance` as a page loads it.
//!
//! It is linked alone, not beside a Rust library, so that all of it is optimised at once.

colltrans_wasm::export!(colltrans_wasm::distance::State);
