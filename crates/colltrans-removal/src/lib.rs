//! Along which directions a body can leave another one ([`free`]), and in which moves ([`ways`]).

#![allow(
    rustdoc::private_intra_doc_links,
    reason = "hidden modules are read with their private parts"
)]

pub mod free;
pub mod ways;
