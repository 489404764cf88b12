//! What colltrans is measured against, in one program.

mod egjk;
mod hwalk;
mod pqp;
mod raycast;
mod vclip;
mod walks;
