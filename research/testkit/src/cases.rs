//! The number of random cases of a test.

use std::env;
use std::ops::Div;

/// Environment variable that selects the number of random cases.
const VARIABLE: &str = "COLLTRANS_CASES";
/// Factor by which a normal run has fewer cases than a full run.
const FEWER: u8 = 4;

/// Returns the number of random cases that a test runs. It is `full` if the environment variable
/// `COLLTRANS_CASES` is `full`, as in CI, and otherwise a quarter, rounded down.
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
