//! Tests of assemblies and robots as one program, because each program is linked separately.

#[path = "../common/mod.rs"]
mod common;

mod audit;
mod bounds;
mod clashes;
mod collection;
mod constraints;
mod fastened;
mod fasteners;
mod fuzz_corpus;
mod hints;
mod hostile;
mod known;
mod machines;
mod oracle;
mod order;
mod precision;
mod read;
mod report;
mod roles;
mod several;
mod split;
mod stand;
mod tools;
mod turning;
mod validation;
