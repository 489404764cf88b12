//! The module that a page reads for drawings: the names that the library exports, and what they need.

use colltrans_wasm_picture as _;
