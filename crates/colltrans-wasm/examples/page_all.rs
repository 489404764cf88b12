//! The module `page` with solids and rounded bodies, as the page loads it for them.
//!
//! It is linked by itself, not together with a Rust library, so that all of it is optimised at once.

colltrans_wasm::export!(colltrans_wasm::page::State);
