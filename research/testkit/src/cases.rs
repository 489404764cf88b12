//! Number of random cases of a test.

use std::env;
use std::ops::Div;

/// Environment variable that selects the number of random cases.
const VARIABLE: &str = "COLLTRANS_CASES";
/// Factor by which a usual run has fewer cases than a full one.
const FEWER: u8 = 4;

/// Returns the number of random cases that a test runs: all of them if the environment variable `COLLTRANS_CASES` is
/// `full`, as CI sets it, else a quarter, rounded down.
///
/// A test that counts kinds of cases expects `cases(n)` of them, too.
///
/// # Panics
///
/// If the variable has another value.
pub fn cases<N: Div<Output = N> + From<u8>>(full: N) -> N {
    match env::var(VARIABLE).as_deref() {
        Ok("full") => full,
        Err(env::VarError::NotPresent) => full / N::from(FEWER),
        other => panic!("{VARIABLE} is {other:?}; accepted: \"full\", or no such variable"),
    }
}
