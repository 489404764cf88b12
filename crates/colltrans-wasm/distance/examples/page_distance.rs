//! The module that a page reads for distances: the names that the library exports, and what they need.

use colltrans_wasm_distance as _;
