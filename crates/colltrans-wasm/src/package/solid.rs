//! Solids: how they are built, and questions along a direction.

use colltrans::glam::DVec3;
use colltrans::solid::{SolidCast as _, SolidContact, SolidOptions, StartOverlap};
use colltrans::{Cast, Clearance, Outcome, Placed, Solid, Solver};
use colltrans_mesh::body::{self, BodyOptions, Loaded, cast_between};
use colltrans_mesh::{Mesh, NumberFormat};

use super::answers::{
    Blocked, Contact, ContactRange, Encode as _, FeatureField, FeaturesField, Found, Free,
    Intersection, Overlapping,
};
use super::error::{Failure, Fallible, Kind};
use super::question::{CastOptions, MeshInput, Numbers, Question};

/// A solid.
#[derive(Debug)]
pub(crate) struct Facets {
    pub(crate) body: Solid,
    /// Distance up to which vertices of the input denote the same point.
    pub(crate) precision: f64,
}

impl Facets {
    /// Reads a mesh: the number of points, corners and sizes, whether the surface may be open, and whether the
    /// coordinates are rounded to single precision. Vertices of such coordinates on open edges are merged as those of
    /// a binary STL file.
    pub(crate) fn read(numbers: &mut Numbers<'_>, bytes: &[u8]) -> Fallible<Self> {
        let (points, corners, sizes) = (numbers.count()?, numbers.count()?, numbers.count()?);
        let (open, single) = (numbers.next()? != 0.0, numbers.next()? != 0.0);
        let MeshInput { points, faces } = MeshInput::read(bytes, points, corners, sizes)?;
        let mesh = Mesh::new(points, faces);
        let mesh = if single { mesh.with_merged_vertices(NumberFormat::Single) } else { mesh };
        let Loaded { body, precision, .. } =
            body::solid(&mesh, &BodyOptions::default().with_open(open))
                .map_err(|error| Failure::new(Kind::Build, "faces", error))?;
        Ok(Self { body, precision })
    }
}

/// Returns the properties of a solid, as [`super::convex::properties`] does for convex bodies.
pub(crate) fn properties(body: &Solid) -> Vec<f64> {
    let (bounds, radius) = (body.bounds(), body.radius());
    let counts = [body.vertices().len() as f64, body.triangles().len() as f64];
    let closed = f64::from(u8::from(body.is_closed()));
    let head = [0.0, closed, counts[0], counts[1], radius, body.volume()];
    [&head[..], &(bounds.low - radius).to_array(), &(bounds.high + radius).to_array()].concat()
}

/// Builds the cast of two placed solids.
pub(crate) fn cast<'a>(
    [moving, fixed]: [Placed<'a, Solid>; 2],
    direction: DVec3,
    precisions: [f64; 2],
    options: &CastOptions,
) -> Fallible<Cast<'a, Solid>> {
    let message = "it is an option for convex bodies; solids have tolerance";
    if options.graze_tolerance.is_some() {
        return Err(Failure::input("grazeTolerance", message));
    }
    if options.solver != Solver::Auto {
        return Err(Failure::input("solver", message));
    }
    let start = start_overlap(options);
    let cast = cast_between(moving, fixed, direction, precisions, options.tolerance, start)?;
    if options.min_gap == 0.0 {
        return Ok(cast);
    }
    let of_gap = SolidOptions::default()
        .with_start_overlap(start)
        .with_tolerance(cast.tolerance())
        .with_min_gap(options.min_gap);
    Ok(cast.with_options(of_gap)?)
}

pub(crate) fn start_overlap(options: &CastOptions) -> StartOverlap {
    if options.ignore_start_overlaps { StartOverlap::Ignore } else { StartOverlap::Refuse }
}

/// Answers a question along a direction.
pub(crate) fn answer(question: Question, cast: &Cast<'_, Solid>) -> Fallible<Found> {
    Ok(match question {
        Question::Clearance => match cast.clearance()? {
            Clearance::Free(_) => Free::ANSWER.found(),
            Clearance::Blocked { distance, contact } => Blocked {
                value: distance,
                lower: distance,
                upper: contact.translation.upper.max(0.0),
                normal: contact.normal,
                point: contact.point_on_fixed,
                point_at_start: contact.point_on_moving,
                features: features(&contact, cast),
            }
            .found(),
            Clearance::Overlapping(overlap) => {
                let least_tolerance = overlap.least_tolerance;
                Overlapping { value: None, back: None, on: None, least_tolerance }.found()
            }
        },
        Question::ContactRange => match cast.contact_range()? {
            colltrans::ContactRange::Contact { first, last } => {
                let ([lower, upper], exit) = (first.translation.bounds(), last.exit());
                let [exit_lower, exit_upper] = exit.bounds();
                let (value, normal) = (first.translation.value, first.normal);
                let (exit, overlap) = (exit.value, None);
                ContactRange { value, lower, upper, exit, exit_lower, exit_upper, normal, overlap }
                    .found()
            }
            colltrans::ContactRange::Grazing { first, .. } => match first {},
            colltrans::ContactRange::Separated(_) => Free::ANSWER.found(),
        },
        Question::Intersects => Intersection { meets: cast.intersects()?.meets }.found(),
        _ => match cast.first_contact()? {
            Outcome::Contact(contact) => Contact {
                value: contact.translation.value,
                lower: contact.translation.lower,
                upper: contact.translation.upper,
                normal: contact.normal,
                point: contact.point_on_fixed,
                point_at_start: contact.point_on_moving,
                features: features(&contact, cast),
            }
            .found(),
            Outcome::Grazing(none) => match none {},
            Outcome::Separated(_) => Free::ANSWER.found(),
        },
    })
}

fn features(contact: &SolidContact, cast: &Cast<'_, Solid>) -> FeaturesField {
    [
        FeatureField::from_feature(contact.moving_feature, cast.moving()),
        FeatureField::from_feature(contact.fixed_feature, cast.fixed()),
    ]
}
