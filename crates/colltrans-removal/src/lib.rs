//! Along which directions a body can leave another one ([`free`]), and in which moves ([`ways`]).

pub mod free;
pub mod ways;
