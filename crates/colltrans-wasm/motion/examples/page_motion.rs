//! The module that a page reads for motions: the names that the library exports, and what they need.

use colltrans_wasm_motion as _;
