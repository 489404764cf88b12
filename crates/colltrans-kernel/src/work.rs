//! How much is looked at, for tests of how it grows: counted where debug assertions are, nothing in optimised builds.
//!
//! Loops whose length depends on the input call [`count`]. No clock, so no machine disturbs a test.

/// So many points, faces or pairs more have been looked at.
#[inline(always)]
#[expect(clippy::inline_always, reason = "it is nothing")]
pub fn count(looks: usize) {
    #[cfg(debug_assertions)]
    LOOKS.set(LOOKS.get() + looks);
    #[cfg(not(debug_assertions))]
    let _ = looks;
}

#[cfg(debug_assertions)]
thread_local! {
    static LOOKS: std::cell::Cell<usize> = const { std::cell::Cell::new(0) };
}

/// Returns how much is looked at in a run.
#[cfg(debug_assertions)]
#[inline]
pub fn looks(run: impl FnOnce()) -> usize {
    let before = LOOKS.get();
    run();
    LOOKS.get() - before
}

/// So many times as much may be looked at for five times the input: `n log n` is 6 to 7, the ears of
/// jagged polygons 11, quadratic 25.
#[cfg(debug_assertions)]
const MOST: f64 = 15.0;

/// Asserts that what is looked at grows hardly faster than its input, from `few` to five times as many.
///
/// # Panics
/// If it does not, or less is looked at than there is.
#[cfg(debug_assertions)]
#[inline]
pub fn assert_growth(what: &str, few: usize, run: impl Fn(usize)) {
    let [less, more] = [few, 5 * few].map(|count| looks(|| run(count)));
    assert!(less >= few, "{what}: {less} looks at {few} are not all that there is");
    let growth = more as f64 / less as f64;
    println!("{what}: {less} looks at {few}, {growth:.1} times as many at five times as many");
    assert!(growth < MOST, "{what}: {growth:.1} times as many looks");
}
