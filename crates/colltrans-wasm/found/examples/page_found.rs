//! The module that a page reads to show searches: the names that the library exports, and what they need.

use colltrans_wasm_found as _;
