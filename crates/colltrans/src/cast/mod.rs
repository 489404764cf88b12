//! The public queries, each a one-off function.

use glam::DVec3;

use crate::answer::{Clearance, ContactRange, Grazing, Outcome};
use crate::body::ConvexPolyhedron;
use crate::body::Pose;
use crate::error::QueryError;
use crate::number::range::MIN_MAGNITUDE;
use crate::setting::Setting;
use crate::solve::observe::{Nobody, Observer};
use crate::solve::options::{Focus, Options};
use crate::solve::{WarmStart, search};

/// How far `moving` can translate along `direction` before it touches `fixed`.
///
/// The poses place both bodies in the world; `direction` is a vector of the world of any length,
/// and translations are in multiples of it. See
/// [`Contact::translation`](crate::Contact::translation) for negative answers, and
/// [`clearance`] for "from here on". Takes `O(log n)` steps in practice and allocates nothing.
///
/// # Errors
/// A direction that is zero, not finite or out of range; bounds that could not be closed.
///
/// ```
/// # use colltrans::glam::DVec3;
/// # use colltrans::{ConvexPolyhedron, Outcome, Pose, cast};
/// # let corners: Vec<DVec3> = (0..8)
/// #     .map(|i| DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64))
/// #     .collect();
/// let cube = ConvexPolyhedron::from_points(&corners)?; // from (0, 0, 0) to (1, 1, 1)
/// let start = Pose::from_translation(DVec3::new(-3.0, 0.5, 0.0))?;
/// let Outcome::Contact(contact) = cast(&cube, &start, &cube, &Pose::IDENTITY, DVec3::X)? else {
///     unreachable!("half of the cube is in the way")
/// };
/// assert_eq!(contact.translation, 2.0);
/// assert_eq!(contact.normal, DVec3::X);
/// assert_eq!((contact.moving_feature.kind(), contact.fixed_feature.kind()), ("face", "face"));
///
/// let beside = Pose::from_translation(DVec3::new(-3.0, 1.5, 0.0))?;
/// let outcome = cast(&cube, &beside, &cube, &Pose::IDENTITY, DVec3::X)?;
/// assert!(matches!(outcome, Outcome::Separated(_)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn cast(
    moving: &ConvexPolyhedron,
    moving_pose: &Pose,
    fixed: &ConvexPolyhedron,
    fixed_pose: &Pose,
    direction: DVec3,
) -> Result<Outcome, QueryError> {
    cast_with(moving, moving_pose, fixed, fixed_pose, direction, &Options::default())
}

/// [`cast`] with [`Options`].
///
/// # Errors
/// As [`cast`], and a graze tolerance that is negative or not finite.
///
/// ```
/// # use colltrans::glam::DVec3;
/// # use colltrans::{ConvexPolyhedron, Options, Outcome, Pose, Solver, cast_with};
/// # let corners: Vec<DVec3> = (0..8)
/// #     .map(|i| DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64))
/// #     .collect();
/// let cube = ConvexPolyhedron::from_points(&corners)?; // from (0, 0, 0) to (1, 1, 1)
/// // A slide with a thousandth of overlap: contact, or grazing for those who tolerate as much.
/// let start = Pose::from_translation(DVec3::new(-3.0, 0.999, 0.0))?;
/// let slide = |options: &Options| {
///     cast_with(&cube, &start, &cube, &Pose::IDENTITY, DVec3::X, options)
/// };
/// assert!(matches!(slide(&Options::default())?, Outcome::Contact(_)));
/// let Outcome::Grazing(grazing) =
///     slide(&Options { graze_tolerance: 0.01, ..Options::default() })?
/// else {
///     unreachable!("they overlap by less than tolerated")
/// };
/// assert!((grazing.overlap - 0.001).abs() < 1e-12);
/// assert_eq!(grazing.contact.translation, 2.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn cast_with(
    moving: &ConvexPolyhedron,
    moving_pose: &Pose,
    fixed: &ConvexPolyhedron,
    fixed_pose: &Pose,
    direction: DVec3,
    options: &Options,
) -> Result<Outcome, QueryError> {
    cast_observed(moving, moving_pose, fixed, fixed_pose, direction, options, &mut Nobody)
}

/// [`cast_with`], with somebody who looks on.
///
/// # Errors
/// As [`cast_with`].
pub fn cast_observed<O: Observer>(
    moving: &ConvexPolyhedron,
    moving_pose: &Pose,
    fixed: &ConvexPolyhedron,
    fixed_pose: &Pose,
    direction: DVec3,
    options: &Options,
    observer: &mut O,
) -> Result<Outcome, QueryError> {
    let setting = Setting::new(moving, moving_pose, fixed, fixed_pose, direction)?;
    search(&setting, moving_pose, options, &Focus::NONE, &mut WarmStart::default(), observer)
}

/// All translations along `direction` at which the bodies meet, both ends certified.
///
/// Frames and units as for [`cast`]. Two casts, along the direction and against it.
///
/// # Errors
/// As [`cast_with`].
///
/// ```
/// # use colltrans::glam::DVec3;
/// # use colltrans::{ConvexPolyhedron, Options, Pose, contact_range};
/// # let corners: Vec<DVec3> = (0..8)
/// #     .map(|i| DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64))
/// #     .collect();
/// let cube = ConvexPolyhedron::from_points(&corners)?; // from (0, 0, 0) to (1, 1, 1)
/// let start = Pose::from_translation(DVec3::new(-3.0, 0.5, 0.0))?;
/// let direction = DVec3::X * 0.5;
/// let range =
///     contact_range(&cube, &start, &cube, &Pose::IDENTITY, direction, &Options::default())?;
/// assert_eq!(range.interval(), Some([4.0, 8.0])); // in multiples of the direction
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn contact_range(
    moving: &ConvexPolyhedron,
    moving_pose: &Pose,
    fixed: &ConvexPolyhedron,
    fixed_pose: &Pose,
    direction: DVec3,
    options: &Options,
) -> Result<ContactRange, QueryError> {
    let run = |direction| cast_with(moving, moving_pose, fixed, fixed_pose, direction, options);
    range_of(direction, run)
}

/// The contact range, from the casts along a direction and against it.
pub(crate) fn range_of(
    direction: DVec3,
    mut run: impl FnMut(DVec3) -> Result<Outcome, QueryError>,
) -> Result<ContactRange, QueryError> {
    // Seen backwards the shadows are the same; only the last bits of their overlap may differ.
    Ok(match (run(direction)?, run(-direction)?) {
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
    })
}

/// How far `moving` can move along `direction` from where it is.
///
/// Contacts behind and grazing slides do not block. Bodies that touch now, to within rounding,
/// block each other if the motion would make them overlap, and do not if it takes them apart.
/// Frames and units as for [`cast`].
///
/// # Errors
/// As [`cast_with`].
///
/// ```
/// # use colltrans::glam::DVec3;
/// # use colltrans::{Clearance, ConvexPolyhedron, Options, Pose, clearance};
/// # let corners: Vec<DVec3> = (0..8)
/// #     .map(|i| DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64))
/// #     .collect();
/// let cube = ConvexPolyhedron::from_points(&corners)?; // from (0, 0, 0) to (1, 1, 1)
/// // One cube upon another: it can go up, and aside, but not down.
/// let (above, world) = (Pose::from_translation(DVec3::Z)?, Pose::IDENTITY);
/// let free = |direction| clearance(&cube, &above, &cube, &world, direction, &Options::default());
/// assert_eq!(free(DVec3::Z)?, Clearance::Free);
/// assert_eq!(free(DVec3::X)?, Clearance::Free);
/// let Clearance::Blocked { distance, .. } = free(DVec3::NEG_Z)? else {
///     unreachable!("the other cube is below")
/// };
/// assert_eq!(distance, 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn clearance(
    moving: &ConvexPolyhedron,
    moving_pose: &Pose,
    fixed: &ConvexPolyhedron,
    fixed_pose: &Pose,
    direction: DVec3,
    options: &Options,
) -> Result<Clearance, QueryError> {
    let run = |direction| cast_with(moving, moving_pose, fixed, fixed_pose, direction, options);
    clearance_of(direction, run)
}

/// The clearance, from the casts along a direction and, if need be, against it.
pub(crate) fn clearance_of(
    direction: DVec3,
    mut run: impl FnMut(DVec3) -> Result<Outcome, QueryError>,
) -> Result<Clearance, QueryError> {
    let Outcome::Contact(contact) = run(direction)? else { return Ok(Clearance::Free) };
    if contact.translation >= -contact.certificate.tolerance {
        let distance = contact.translation.max(0.0);
        return Ok(Clearance::Blocked { distance, contact });
    }
    Ok(match run(-direction)? {
        Outcome::Contact(last) if last.translation < -last.certificate.tolerance => {
            Clearance::Overlapping { range: [contact.translation, -last.translation] }
        }
        _ => Clearance::Free,
    })
}

/// Whether the bodies, as closed sets and to within rounding error, have a point in common where
/// they are.
///
/// The moving body is cast along the line through both centres, which passes the deepest
/// part of the Minkowski difference, so the answer is as well conditioned as the question.
///
/// # Errors
/// As [`cast`].
///
/// ```
/// # use colltrans::glam::DVec3;
/// # use colltrans::{ConvexPolyhedron, Pose, intersects};
/// # let corners: Vec<DVec3> = (0..8)
/// #     .map(|i| DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64))
/// #     .collect();
/// let cube = ConvexPolyhedron::from_points(&corners)?; // from (0, 0, 0) to (1, 1, 1)
/// let at = |x| Pose::from_translation(DVec3::new(x, 0.0, 0.0));
/// let meets = |x| Ok::<_, Box<dyn std::error::Error>>(
///     intersects(&cube, &at(x)?, &cube, &Pose::IDENTITY)?
/// );
/// assert!(meets(0.5)?);
/// assert!(meets(1.0)?); // they touch
/// assert!(!meets(1.001)?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn intersects(
    moving: &ConvexPolyhedron,
    moving_pose: &Pose,
    fixed: &ConvexPolyhedron,
    fixed_pose: &Pose,
) -> Result<bool, QueryError> {
    let center = |body: &ConvexPolyhedron, pose: &Pose| pose.matrix() * body.inertia().center;
    let between = (center(fixed, fixed_pose) - center(moving, moving_pose))
        + (fixed_pose.translation() - moving_pose.translation());
    let Some(unit) = between.try_normalize() else { return Ok(true) };
    // Components out of the exact range are rounding noise of zero.
    let significant = |c: f64| if c.abs() < MIN_MAGNITUDE { 0.0 } else { c };
    let direction = DVec3::from_array(unit.to_array().map(significant));
    Ok(match cast(moving, moving_pose, fixed, fixed_pose, direction)? {
        Outcome::Contact(contact) | Outcome::Grazing(Grazing { contact, .. }) => {
            contact.translation <= contact.certificate.tolerance
        }
        Outcome::Separated(_) => false,
    })
}

/// How far `moving`, where it overlaps `fixed`, has to go back along `-direction` until they only
/// touch, in multiples of `direction`; 0 if they do not overlap.
///
/// # Errors
/// As [`cast_with`].
///
/// ```
/// # use colltrans::glam::DVec3;
/// # use colltrans::{ConvexPolyhedron, Options, Pose, directional_depth};
/// # let corners: Vec<DVec3> = (0..8)
/// #     .map(|i| DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64))
/// #     .collect();
/// let cube = ConvexPolyhedron::from_points(&corners)?; // from (0, 0, 0) to (1, 1, 1)
/// let inside = Pose::from_translation(DVec3::new(-0.75, 0.0, 0.0))?;
/// let depth = |direction| {
///     directional_depth(&cube, &inside, &cube, &Pose::IDENTITY, direction, &Options::default())
/// };
/// assert_eq!(depth(DVec3::X)?, 0.25);
/// assert_eq!(depth(DVec3::NEG_X)?, 1.75);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn directional_depth(
    moving: &ConvexPolyhedron,
    moving_pose: &Pose,
    fixed: &ConvexPolyhedron,
    fixed_pose: &Pose,
    direction: DVec3,
    options: &Options,
) -> Result<f64, QueryError> {
    Ok(match clearance(moving, moving_pose, fixed, fixed_pose, direction, options)? {
        Clearance::Overlapping { range } => -range[0],
        Clearance::Free | Clearance::Blocked { .. } => 0.0,
    })
}
