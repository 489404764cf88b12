//! The library of the npm package: bodies of both kinds and all questions.

colltrans_wasm::export!(colltrans_wasm::package::Bodies);
