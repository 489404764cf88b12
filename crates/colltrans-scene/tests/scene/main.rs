//! One body among many, and one pair many times, in one program: each program is linked for itself.

mod among;
mod bulk;
mod fuzz_corpus;
