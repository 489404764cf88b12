//! Finds a proven contact soon after the end of a search.
//!
//! The pieces that end a search may only touch, for example facets in one plane, or an edge that lies in a face. Other
//! pieces may cross a little later. The search samples times at doubling distances after the end. Between the last time
//! without proof and the first time with proof it bisects.

/// Maximum number of doublings of the distance from the end of the search.
const MAX_DOUBLINGS: i32 = 50;
/// First distance, as a time.
const FIRST_DISTANCE: f64 = 4.0 * f64::EPSILON;

/// Distance after which the search stops when the bodies are separated.
const MAX_SEPARATED_TIME: f64 = 1e-6;

/// Width of bounds below which the search stops.
pub(super) const MIN_WIDTH: f64 = 1e-12;

/// State of two bodies at one time.
pub(super) enum ContactState<M> {
    /// The bodies are separated.
    Apart,
    /// Neither separation nor contact is proven.
    Undecided,
    /// The bodies meet, with the proof.
    Met(M),
}

/// Returns the first time found from `from` on at which the bodies meet, with its proof. The search is limited to times
/// before `known_contact`, if given, or else before `end`. It stops when the bodies are separated after an undecided
/// time, or later than [`MAX_SEPARATED_TIME`] after `from`. Returns `None` if it finds no contact, and if
/// `known_contact` is at most [`MIN_WIDTH`] after `from`.
pub(super) fn find_crossing_time<M>(
    from: f64,
    known_contact: Option<f64>,
    end: f64,
    mut state_at: impl FnMut(f64) -> ContactState<M>,
) -> Option<(f64, M)> {
    if known_contact.is_some_and(|met| met - from <= MIN_WIDTH) {
        return None;
    }
    let before = known_contact.unwrap_or(end);
    let (mut last, mut was_undecided) = (from, false);
    let mut found = None;
    for k in -1..MAX_DOUBLINGS {
        let more = if k < 0 { 0.0 } else { FIRST_DISTANCE * 2.0_f64.powi(k) };
        let time = from + more;
        if time >= before {
            break;
        }
        match state_at(time) {
            ContactState::Met(met) => {
                found = Some((time, met));
                break;
            }
            ContactState::Undecided => was_undecided = true,
            ContactState::Apart if was_undecided || more > MAX_SEPARATED_TIME => break,
            ContactState::Apart => {}
        }
        last = time;
    }
    let (mut time, mut met) = found?;
    while time - last > MIN_WIDTH {
        let middle = 0.5 * (last + time);
        match state_at(middle) {
            ContactState::Met(earlier) => (time, met) = (middle, earlier),
            _ => last = middle,
        }
    }
    Some((time, met))
}
