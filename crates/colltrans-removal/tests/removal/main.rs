//! Free directions and ways out, in one program: each program is linked for itself.

mod free;
mod half_space;
mod ways;
