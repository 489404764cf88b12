//! Where bodies that stop are proven to meet, soon after.
//!
//! What stops a search may be two pieces that only touch there: facets in one plane, an edge along a face. Others cross
//! a little later. Times after the stop are looked at, each twice as far from it as the one before; between the last one
//! without proof and the first with one the interval is halved.

/// How often a time after a stop is doubled, from so many roundings on.
const BEYOND: i32 = 50;
const FIRST: f64 = 4.0 * f64::EPSILON;

/// How long after a stop bodies that are apart are looked at further.
const SOON: f64 = 1e-6;

/// Bounds on when they meet that are closer than this are close enough.
const CLOSE: f64 = 1e-12;

/// What bodies are at a time.
pub(super) enum Seen<M> {
    Apart,
    /// Neither is proven.
    Open,
    /// They meet, and what proves it.
    Met(M),
}

/// The first time found, from one on, at which they meet: before that at which they are known to, or else before the end.
pub(super) fn soon<M>(
    from: f64,
    known: Option<f64>,
    end: f64,
    mut seen: impl FnMut(f64) -> Seen<M>,
) -> Option<(f64, M)> {
    if known.is_some_and(|met| met - from <= CLOSE) {
        return None;
    }
    let before = known.unwrap_or(end);
    let (mut last, mut was_open) = (from, false);
    let mut found = None;
    for k in -1..BEYOND {
        let more = if k < 0 { 0.0 } else { FIRST * 2.0_f64.powi(k) };
        let time = from + more;
        if time >= before {
            break;
        }
        match seen(time) {
            Seen::Met(met) => {
                found = Some((time, met));
                break;
            }
            Seen::Open => was_open = true,
            Seen::Apart if was_open || more > SOON => break,
            Seen::Apart => {}
        }
        last = time;
    }
    let (mut time, mut met) = found?;
    while time - last > CLOSE {
        let middle = 0.5 * (last + time);
        match seen(middle) {
            Seen::Met(earlier) => (time, met) = (middle, earlier),
            _ => last = middle,
        }
    }
    Some((time, met))
}
