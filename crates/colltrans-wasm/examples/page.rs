//! The module that a page reads: the names that the library exports, and what they need.
//!
//! It is linked alone, not beside a Rust library, so that all of it is optimised at once.

use colltrans_wasm as _;
