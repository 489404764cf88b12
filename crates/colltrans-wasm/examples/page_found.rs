//! The module `found` as the page loads it.
//!
//! It is linked by itself, not together with a Rust library, so that all of it is optimised at once.

colltrans_wasm::export!(colltrans_wasm::found::State);
