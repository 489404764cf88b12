//! Tests of the algorithms with which colltrans is compared, as one program.

mod egjk;
mod hwalk;
mod portals;
mod pqp;
mod raycast;
mod vclip;
mod walks;
