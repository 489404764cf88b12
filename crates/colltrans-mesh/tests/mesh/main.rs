//! Tests of mesh files, in one program, because each test program is linked separately.

mod collection;
mod formats;
mod precision;
mod validation;
