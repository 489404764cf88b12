//! How far two solids are apart.

pub(crate) mod triangle;
