//! Answers that need more than one cast. A closure runs the casts, from scratch or by a tracker.

use glam::DVec3;

use super::Cast;
use crate::answer::{
    Bounded, CentralCast, Clearance, Contact, ContactRange, DirectionalDepth, FreeReason, Grazing,
    Intersection, Outcome, OverlapAhead,
};
use crate::setting::error::QueryError;
use colltrans_kernel::range::MIN_MAGNITUDE;

/// Computes the contact range from the casts along a direction and against it.
///
/// # Errors
/// Returns the errors of `run`.
pub fn contact_range_by_casts<'a>(
    cast: &Cast<'a>,
    mut run: impl FnMut(&Cast<'a>) -> Result<Outcome, QueryError>,
) -> Result<ContactRange, QueryError> {
    // The shadows do not depend on the sign of the direction; only the last bits of their overlap may differ.
    let mut range: ContactRange = match (run(cast)?, run(&cast.reversed())?) {
        (Outcome::Separated(separated), _) | (_, Outcome::Separated(separated)) => {
            ContactRange::Separated(separated)
        }
        (Outcome::Contact(first), Outcome::Contact(last)) => ContactRange::Contact { first, last },
        (Outcome::Grazing(first), Outcome::Contact(last)) => {
            ContactRange::Grazing { first, last: Grazing { contact: last, ..first } }
        }
        (Outcome::Contact(first), Outcome::Grazing(last)) => {
            ContactRange::Grazing { first: Grazing { contact: first, ..last }, last }
        }
        (Outcome::Grazing(first), Outcome::Grazing(last)) => ContactRange::Grazing { first, last },
    };
    match &mut range {
        ContactRange::Contact { first, last } => order_range_ends(first, last),
        ContactRange::Grazing { first, last } => {
            order_range_ends(&mut first.contact, &mut last.contact);
        }
        ContactRange::Separated(_) => {}
    }
    Ok(range)
}

/// Returns one translation for both ends of a range if rounding has reversed their order, otherwise `None`.
///
/// It is the mean of the estimates, clamped to the intersection of both ends' bounds. This intersection is
/// not empty, because both are correct bounds of the same translation.
#[inline]
pub fn common_translation(first: Bounded, last: Bounded) -> Option<f64> {
    (first.value > last.value).then(|| {
        let [low, high] = [first.lower.max(last.lower), first.upper.min(last.upper)];
        f64::midpoint(first.value, last.value).min(high).max(low)
    })
}

/// Replaces estimates in the wrong order by their common translation.
fn order_range_ends(first: &mut Contact, last: &mut Contact) {
    if let Some(both) = common_translation(first.bounded(), last.exit()) {
        (first.translation, last.translation) = (both, -both);
    }
}

/// Computes the clearance from the cast along a direction and, if the first contact lies behind, the one
/// against it.
///
/// # Errors
/// Returns the errors of `run`.
#[inline]
pub fn clearance_by_casts<'a>(
    cast: &Cast<'a>,
    mut run: impl FnMut(&Cast<'a>) -> Result<Outcome, QueryError>,
) -> Result<Clearance, QueryError> {
    let contact = match run(cast)? {
        Outcome::Contact(contact) => contact,
        Outcome::Grazing(grazing) => return Ok(Clearance::Free(FreeReason::Slides(grazing))),
        Outcome::Separated(separated) => {
            return Ok(Clearance::Free(FreeReason::Separated(separated)));
        }
    };
    if let Some(blocked) = Clearance::blocked_by(&contact) {
        return Ok(blocked);
    }
    Ok(match run(&cast.reversed())? {
        Outcome::Contact(last) => Clearance::beyond_first(contact, last),
        // The shadows do not depend on the sign of the direction; only the last bits of their overlap may
        // differ.
        Outcome::Grazing(grazing) => Clearance::Free(FreeReason::Slides(grazing)),
        Outcome::Separated(separated) => Clearance::Free(FreeReason::Separated(separated)),
    })
}

/// Computes the depth of an overlap along the direction, from the clearance.
///
/// # Errors
/// Returns the errors of `run`.
#[inline]
pub fn directional_depth_by_casts<'a>(
    cast: &Cast<'a>,
    run: impl FnMut(&Cast<'a>) -> Result<Outcome, QueryError>,
) -> Result<DirectionalDepth, QueryError> {
    let clearance = clearance_by_casts(cast, run)?;
    let depth = match &clearance {
        // The lower bound of the first contact gives a value that is not less than the true depth.
        Clearance::Overlapping(OverlapAhead { first, .. }) => -first.certificate.lower,
        _ => 0.0,
    };
    Ok(DirectionalDepth { depth, clearance })
}

/// Checks whether the bodies meet in their current poses, by a cast along the line through their centres.
///
/// # Errors
/// Returns the errors of `run`.
#[inline]
pub fn intersection_by_casts<'a>(
    cast: &Cast<'a>,
    mut run: impl FnMut(&Cast<'a>) -> Result<Outcome, QueryError>,
) -> Result<Intersection, QueryError> {
    let direction = direction_between_centers(cast);
    let through = cast.along(direction)?;
    let outcome = run(&through)?;
    let meets = match &outcome {
        Outcome::Contact(contact) | Outcome::Grazing(Grazing { contact, .. }) => {
            contact.translation <= contact.certificate.rounding
        }
        Outcome::Separated(_) => false,
    };
    Ok(Intersection { meets, evidence: CentralCast { direction, outcome } })
}

/// Returns the unit vector from the moving body's centre to the fixed one's, or the x axis if the centres
/// coincide.
fn direction_between_centers(cast: &Cast) -> DVec3 {
    let setting = &cast.setting;
    let p = setting.moving_matrix * setting.moving.inertia().center;
    let q = setting.fixed_matrix * setting.fixed.inertia().center;
    let between = (q - p) + setting.offset;
    // Components below the exact range are rounding errors of zero.
    let significant = |c: f64| if c.abs() < MIN_MAGNITUDE { 0.0 } else { c };
    let unit = between.try_normalize().map(|unit| unit.to_array().map(significant));
    unit.map_or(DVec3::X, DVec3::from_array)
}
