//! Counter of visited points, faces and pairs, for tests of asymptotic work.
//!
//! Loops whose length depends on the input call [`count_visits`]. It counts only with debug assertions and does
//! nothing in optimised builds. The tests use no clock, so that the load of the machine does not affect them.

/// Adds a number of visited points, faces or pairs to the counter.
#[inline(always)]
#[expect(clippy::inline_always, reason = "empty in optimised builds")]
pub fn count_visits(visits: usize) {
    #[cfg(debug_assertions)]
    VISITS.set(VISITS.get() + visits);
    #[cfg(not(debug_assertions))]
    let _ = visits;
}

#[cfg(debug_assertions)]
thread_local! {
    static VISITS: std::cell::Cell<usize> = const { std::cell::Cell::new(0) };
}

/// Runs a closure and returns the number of visits on this thread.
#[cfg(debug_assertions)]
#[inline]
pub fn visits_during(run: impl FnOnce()) -> usize {
    let before = VISITS.get();
    run();
    VISITS.get() - before
}

/// Maximum factor between the visits of an input and of an input five times as large. `n log n` has a factor
/// of 6 to 7, the ear clipping of jagged polygons 11, a quadratic algorithm 25.
#[cfg(debug_assertions)]
const MAX_GROWTH: f64 = 15.0;

/// Asserts that the number of visits grows by a factor below 15 from inputs of size `few` to inputs of five times
/// that size.
///
/// # Panics
/// If the growth is larger, or an input of size `few` has fewer than `few` visits.
#[cfg(debug_assertions)]
#[inline]
pub fn assert_growth(what: &str, few: usize, run: impl Fn(usize)) {
    let [less, more] = [few, 5 * few].map(|count| visits_during(|| run(count)));
    assert!(less >= few, "{what}: {less} visits of {few} items; at least {few} are expected");
    let growth = more as f64 / less as f64;
    println!(
        "{what}: {less} visits of {few} items, {growth:.1} times as many of five times the items"
    );
    assert!(
        growth < MAX_GROWTH,
        "{what}: {growth:.1} times as many visits of five times the items; limit {MAX_GROWTH}"
    );
}
