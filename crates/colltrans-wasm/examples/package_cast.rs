//! The library of `colltrans/cast` in the npm package: convex bodies and questions along a direction.

colltrans_wasm::export!(colltrans_wasm::package::Casts);
