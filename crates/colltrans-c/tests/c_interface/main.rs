//! Tests of the C interface: the header, the layout of structs, programs in C and C++ against the library.
#![cfg(unix)]

mod header;
mod install;
mod layout;
mod numbers;
mod programs;
