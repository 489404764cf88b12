//! The module that a page reads for assemblies: the names that the library exports, and what they need.

use colltrans_wasm_assembly as _;
