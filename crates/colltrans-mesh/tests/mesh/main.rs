//! Mesh files, in one program: each is linked for itself.

mod collection;
mod formats;
mod precision;
mod validation;
