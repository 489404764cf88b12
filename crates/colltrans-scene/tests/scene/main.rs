//! Tests of one body among many and of many casts of one pair, as one program, because each program is linked
//! separately.

mod among;
mod bulk;
mod fuzz_corpus;
