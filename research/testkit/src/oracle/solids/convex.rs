//! Compares convex bodies as solids with the convex core and with the rule over all pairs of facets, and the
//! bodies with their input points.

use colltrans::solid::SolidCast;
use colltrans::{Bounded, Cast, Clearance, ContactRange, Outcome, Solid};

use super::facets::{rule, triangles};
use super::settings::MotionOutcome;
use super::{encloses, exactly};
use crate::oracle::exact::Ratio;
use crate::oracle::scene::size;
use crate::oracle::settings::{NEARLY_FLAT, Setting};

/// Maximum number of pairs of facets that are judged by the rule.
const MOST_PAIRS: usize = 4_000;
/// Tolerance of agreement, in multiples of the rounding error of a coordinate.
const AGREEMENT: f64 = 512.0;

/// Computes and compares both answers. `None` for bodies without a volume, or so thin that they lose it.
///
/// # Errors
/// A description of the first disagreement.
pub fn as_solids(setting: &Setting) -> Result<Option<MotionOutcome>, String> {
    let bodies = setting.bodies().map_err(|e| e.to_string())?;
    setting.judge_bodies(&bodies).map_err(|e| e.to_string())?;
    let (p, q) = (&bodies.moving, &bodies.fixed);
    if p.dimension() < 3 || q.dimension() < 3 {
        return Ok(None);
    }
    let (Ok(a), Ok(b)) = (Solid::from_convex(p), Solid::from_convex(q)) else { return Ok(None) };
    let (s, t) = (&setting.moving_pose, &setting.fixed_pose);
    let cast = exactly([&a, &b], [*s, *t], setting.direction)?;
    let overlaps = cast.overlaps();
    let found = if overlaps { None } else { Some(cast.clearance().map_err(|e| e.to_string())?) };
    if let Some(found) = &found {
        against_rule(setting, &a, &b, found, cast.exit())?;
    }
    let core = Cast::new(p.at(*s), q.at(*t), setting.direction).map_err(|e| e.to_string())?;
    let limits = Limits {
        noise: coordinate_error(setting, &a, &b),
        dented: NEARLY_FLAT.contains(&setting.family),
    };
    let range = cast.contact_range().map_err(|e| e.to_string())?;
    against_range(&core.contact_range().map_err(|e| e.to_string())?, &range, &limits)?;
    let first = core.first_contact().map_err(|e| e.to_string())?;
    against_core(first, overlaps, found.as_ref(), &limits)
}

/// Checks that first and last contact equal those of the core, if the core is certain that they exist.
fn against_range(
    core: &ContactRange,
    found: &ContactRange<Solid>,
    limits: &Limits,
) -> Result<(), String> {
    let agree = match (core, found) {
        (ContactRange::Contact { first, last }, ContactRange::Contact { first: f, last: l }) => {
            [(first, f), (last, l)].into_iter().all(|(end, solid)| {
                let tolerance = end.certificate.rounding + AGREEMENT * limits.noise;
                let later = solid.translation.value - end.translation;
                later >= -tolerance && (later <= tolerance || limits.dented)
            })
        }
        (ContactRange::Contact { .. }, _) => limits.dented,
        (ContactRange::Separated(_), found) => matches!(found, ContactRange::Separated(_)),
        (ContactRange::Grazing { .. }, _) => true,
    };
    if agree { Ok(()) } else { Err(format!("{found:?}, but the core says {core:?}")) }
}

/// The admissible differences of a convex body as a solid.
struct Limits {
    /// The rounding error of a coordinate, in multiples of the direction.
    noise: f64,
    /// Whether triangles may cut into the body. A solid has the same vertices, so it meets nothing earlier. But
    /// polygons are flat only up to rounding. For a body as thin as that, the triangles form a different body,
    /// which may meet later or miss. Such a body is judged by the rule only.
    dented: bool,
}

/// Returns the rounding error of a coordinate, in multiples of the direction.
fn coordinate_error(setting: &Setting, a: &Solid, b: &Solid) -> f64 {
    let size = size([a.vertices(), b.vertices()], [&setting.moving_pose, &setting.fixed_pose]);
    16.0 * f64::EPSILON * size / setting.direction.length()
}

fn against_rule(
    setting: &Setting,
    a: &Solid,
    b: &Solid,
    found: &Clearance<Solid>,
    exit: Option<Bounded>,
) -> Result<(), String> {
    if a.triangles().len() * b.triangles().len() > MOST_PAIRS {
        return Ok(());
    }
    let placed = |s: &Solid, pose: &colltrans::Pose| {
        triangles(s.vertices(), s.triangles(), (pose.matrix(), pose.translation()))
    };
    let (f, g) = (placed(a, &setting.moving_pose), placed(b, &setting.fixed_pose));
    let right = rule(&f, &g, setting.direction);
    let zero = || Ratio::from_f64(0.0);
    match (exit, right.exit.map(|exit| exit.max(zero()))) {
        (None, None) => {}
        (Some(found), Some(right)) if encloses(&found, &right) => {}
        (found, right) => {
            return Err(format!("exit {found:?}, not {:?}", right.map(|r| r.to_f64())));
        }
    }
    let right = right.stop;
    let tolerance = AGREEMENT * coordinate_error(setting, a, b);
    let agree = match (found, &right) {
        (Clearance::Free(_), None) => true,
        (Clearance::Blocked { distance, contact }, Some(right)) => {
            let place = &contact.translation;
            let near = |found: f64| right.minus(&Ratio::from_f64(found)).is_within(tolerance);
            near(*distance) && near(place.value) && encloses(place, right)
        }
        _ => false,
    };
    let right = right.map(|r| r.to_f64());
    if agree { Ok(()) } else { Err(format!("{found:?}, by the rule {right:?}")) }
}

/// Checks that the solid agrees where the core is certain.
fn against_core(
    core: Outcome,
    overlaps: bool,
    found: Option<&Clearance<Solid>>,
    limits: &Limits,
) -> Result<Option<MotionOutcome>, String> {
    let distance = match found {
        Some(Clearance::Blocked { distance, .. }) => Some(*distance),
        _ => None,
    };
    let seen = match (overlaps, distance) {
        (true, _) => MotionOutcome::Overlapping,
        (false, None) => MotionOutcome::Free,
        (false, Some(0.0)) => MotionOutcome::BlockedNow,
        (false, Some(_)) => MotionOutcome::Blocked,
    };
    let wrong = || Err(format!("{seen:?} at {distance:?}, but the core says {core:?}"));
    match core {
        Outcome::Separated(_) if overlaps || distance.is_some() => wrong(),
        Outcome::Contact(contact) => {
            let tolerance = contact.certificate.rounding + AGREEMENT * limits.noise;
            let ahead = contact.translation > tolerance;
            let early = distance.is_some_and(|d| d < contact.translation - tolerance);
            let late = distance.is_none_or(|d| d > contact.translation + tolerance);
            if ahead && (early || late && !limits.dented) { wrong() } else { Ok(Some(seen)) }
        }
        _ => Ok(Some(seen)),
    }
}
