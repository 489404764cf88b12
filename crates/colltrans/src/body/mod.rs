//! Bodies.

pub(crate) mod solid;
