//! Answers that take more than one cast, from whoever runs the casts: one-off, or a tracker.

use glam::DVec3;

use super::Cast;
use crate::answer::{
    Bounded, CentralCast, Clearance, Contact, ContactRange, DirectionalDepth, Grazing,
    Intersection, Outcome, OverlapAhead, WhyFree,
};
use crate::setting::error::QueryError;
use colltrans_kernel::range::MIN_MAGNITUDE;

/// The contact range, from the casts along a direction and against it.
pub fn range_of<'a>(
    cast: &Cast<'a>,
    mut run: impl FnMut(&Cast<'a>) -> Result<Outcome, QueryError>,
) -> Result<ContactRange, QueryError> {
    // Seen backwards the shadows are the same; only the last bits of their overlap may differ.
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

/// Where both ends are one, rounding may have turned the estimates round: then they are one number
/// between the bounds of either end, which have some in common as both are right.
#[inline]
pub fn common_end(first: Bounded, last: Bounded) -> Option<f64> {
    (first.value > last.value).then(|| {
        let [low, high] = [first.lower.max(last.lower), first.upper.min(last.upper)];
        f64::midpoint(first.value, last.value).min(high).max(low)
    })
}

fn order_range_ends(first: &mut Contact, last: &mut Contact) {
    if let Some(both) = common_end(first.bounded(), last.exit()) {
        (first.translation, last.translation) = (both, -both);
    }
}

/// The clearance, from the cast along a direction and, if need be, the one against it.
#[inline]
pub fn clearance_of<'a>(
    cast: &Cast<'a>,
    mut run: impl FnMut(&Cast<'a>) -> Result<Outcome, QueryError>,
) -> Result<Clearance, QueryError> {
    let contact = match run(cast)? {
        Outcome::Contact(contact) => contact,
        Outcome::Grazing(grazing) => return Ok(Clearance::Free(WhyFree::Slides(grazing))),
        Outcome::Separated(separated) => return Ok(Clearance::Free(WhyFree::Separated(separated))),
    };
    if let Some(blocked) = Clearance::blocked_by(&contact) {
        return Ok(blocked);
    }
    Ok(match run(&cast.reversed())? {
        Outcome::Contact(last) => Clearance::beyond_first(contact, last),
        // Seen backwards the shadows are the same; only the last bits of their overlap may differ.
        Outcome::Grazing(grazing) => Clearance::Free(WhyFree::Slides(grazing)),
        Outcome::Separated(separated) => Clearance::Free(WhyFree::Separated(separated)),
    })
}

/// The depth of an overlap, from the clearance.
#[inline]
pub fn depth_of<'a>(
    cast: &Cast<'a>,
    run: impl FnMut(&Cast<'a>) -> Result<Outcome, QueryError>,
) -> Result<DirectionalDepth, QueryError> {
    let clearance = clearance_of(cast, run)?;
    let depth = match &clearance {
        // Safe is what is not less than the true depth.
        Clearance::Overlapping(OverlapAhead { first, .. }) => -first.certificate.lower,
        _ => 0.0,
    };
    Ok(DirectionalDepth { depth, clearance })
}

/// Whether the bodies meet where they are, from a cast along the line through their centres.
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

/// The unit vector from the moving body's centre to the fixed one's; any if they are one.
fn direction_between_centers(cast: &Cast) -> DVec3 {
    let setting = &cast.setting;
    let p = setting.moving_matrix * setting.moving.inertia().center;
    let q = setting.fixed_matrix * setting.fixed.inertia().center;
    let between = (q - p) + setting.offset;
    // Components out of the exact range are rounding noise of zero.
    let significant = |c: f64| if c.abs() < MIN_MAGNITUDE { 0.0 } else { c };
    let unit = between.try_normalize().map(|unit| unit.to_array().map(significant));
    unit.map_or(DVec3::X, DVec3::from_array)
}
