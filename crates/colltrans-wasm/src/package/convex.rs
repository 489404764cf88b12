//! Convex bodies: how they are built, their properties, and questions along a direction.

use colltrans::glam::DVec3;
use colltrans::{
    Aabb, Cast, Clearance, ConvexPolyhedron, FreeReason, Grazing as GrazingBodies, Outcome,
    OverlapAhead, Placed, Separated as SeparatedBodies,
};

use super::answers::{
    Behind, Blocked, Contact, ContactRange, Encode as _, FeatureField, FeaturesField, Found,
    Grazing, Intersection, Overlapping, Separated, Slides,
};
use super::error::{Failure, Fallible};
use super::question::{CastOptions, MeshInput, Numbers, Question, points};

/// Tolerance of the convexity of a mesh, in multiples of the largest coordinate: that of single precision.
const CONVEX_TOLERANCE: f64 = 4.0 / (1 << 23) as f64;

/// Builds the body of a question.
pub(crate) fn build(
    question: Question,
    numbers: &mut Numbers<'_>,
    bytes: &[u8],
) -> Fallible<Option<ConvexPolyhedron>> {
    Ok(Some(match question {
        Question::Hull => ConvexPolyhedron::from_points(&points(bytes))
            .map_err(|e| Failure::from(e).of("points"))?,
        Question::Mesh => {
            let (count, corners, sizes) = (numbers.count()?, numbers.count()?, numbers.count()?);
            let MeshInput { points, faces } = MeshInput::read(bytes, count, corners, sizes)?;
            let largest = points.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
            let tolerance = CONVEX_TOLERANCE * largest;
            ConvexPolyhedron::from_mesh(&points, &faces, tolerance)
                .map_err(|e| Failure::from(e).of("faces"))?
        }
        Question::Cuboid => {
            let (low, high) = (numbers.vector()?, numbers.vector()?);
            ConvexPolyhedron::cuboid(low, high).map_err(|e| Failure::from(e).of("low, high"))?
        }
        _ => return Ok(None),
    }))
}

/// Returns the properties of a body: whether it is convex and closed, the numbers of its vertices and triangles, its
/// radius, its volume, and the corners of its box.
pub(crate) fn properties(body: &ConvexPolyhedron) -> Vec<f64> {
    let Aabb { low, high } = Aabb::from_points(body.vertices().iter().copied());
    let counts = [body.vertices().len() as f64, triangles(body).len() as f64];
    let head = [1.0, 1.0, counts[0], counts[1], body.radius(), body.volume()];
    let radius = body.radius();
    [&head[..], &(low - radius).to_array(), &(high + radius).to_array()].concat()
}

/// Returns the faces as fans of triangles.
pub(crate) fn triangles(body: &ConvexPolyhedron) -> Vec<[u32; 3]> {
    let mut triangles = Vec::new();
    for face in 0..body.face_count() as u32 {
        let corners: Vec<u32> = body.face_vertices(face).collect();
        triangles.extend(corners.windows(2).skip(1).map(|edge| [corners[0], edge[0], edge[1]]));
    }
    triangles
}

/// Builds the cast of two placed bodies.
pub(crate) fn cast<'a>(
    [moving, fixed]: [Placed<'a>; 2],
    direction: DVec3,
    options: &CastOptions,
) -> Fallible<Cast<'a>> {
    options.for_convex()?;
    Ok(Cast::new(moving, fixed, direction)?.with_options(options.convex())?)
}

/// Answers a question along a direction.
pub(crate) fn answer(question: Question, cast: &Cast<'_>) -> Fallible<Found> {
    Ok(match question {
        Question::Clearance => clearance(&cast.clearance()?, cast),
        Question::ContactRange => range(&cast.contact_range()?),
        Question::Intersects => Intersection { meets: cast.intersects()?.meets }.found(),
        _ => outcome(&cast.first_contact()?, cast),
    })
}

fn features(contact: &colltrans::Contact, cast: &Cast<'_>) -> FeaturesField {
    let features = contact.features(cast);
    [
        FeatureField::from_feature(features.moving, cast.moving()),
        FeatureField::from_feature(features.fixed, cast.fixed()),
    ]
}

fn outcome(outcome: &Outcome, cast: &Cast<'_>) -> Found {
    match outcome {
        Outcome::Contact(contact) => {
            let points = contact.witness_points(cast);
            let [lower, upper] = contact.bounded().bounds();
            Contact {
                value: contact.translation,
                lower,
                upper,
                normal: contact.normal,
                point: points.on_fixed,
                point_at_start: points.on_moving,
                features: features(contact, cast),
            }
            .found()
        }
        Outcome::Grazing(GrazingBodies { contact, overlap, separating_direction, .. }) => {
            let [lower, upper] = contact.bounded().bounds();
            Grazing {
                value: contact.translation,
                lower,
                upper,
                overlap: *overlap,
                separating_direction: *separating_direction,
                normal: contact.normal,
                point: contact.witness_points(cast).on_fixed,
                features: features(contact, cast),
            }
            .found()
        }
        Outcome::Separated(of) => separated(of),
    }
}

fn separated(of: &SeparatedBodies) -> Found {
    let infinite = f64::INFINITY;
    let (margin, normal) = (of.certificate.margin, of.certificate.normal);
    Separated { value: infinite, lower: infinite, upper: infinite, margin, normal }.found()
}

fn range(range: &colltrans::ContactRange) -> Found {
    let (first, last, overlap) = match range {
        colltrans::ContactRange::Contact { first, last } => (first, last, None),
        colltrans::ContactRange::Grazing { first, last } => {
            (&first.contact, &last.contact, Some(first.overlap))
        }
        colltrans::ContactRange::Separated(of) => return separated(of),
    };
    let ([lower, upper], exit) = (first.bounded().bounds(), last.exit());
    let [exit_lower, exit_upper] = exit.bounds();
    let (value, normal, exit) = (first.translation, first.normal, exit.value);
    ContactRange { value, lower, upper, exit, exit_lower, exit_upper, normal, overlap }.found()
}

fn clearance(clearance: &Clearance, cast: &Cast<'_>) -> Found {
    let infinite = f64::INFINITY;
    match clearance {
        Clearance::Blocked { distance, contact } => {
            let points = contact.witness_points(cast);
            Blocked {
                value: *distance,
                lower: *distance,
                upper: contact.bounded().bounds()[1].max(0.0),
                normal: contact.normal,
                point: points.on_fixed,
                point_at_start: points.on_moving,
                features: features(contact, cast),
            }
            .found()
        }
        Clearance::Free(FreeReason::Slides(of)) => Slides {
            value: infinite,
            lower: infinite,
            upper: infinite,
            overlap: of.overlap,
            separating_direction: of.separating_direction,
        }
        .found(),
        Clearance::Free(FreeReason::Behind(last)) => {
            let exit = last.exit().value;
            Behind { value: infinite, lower: infinite, upper: infinite, exit }.found()
        }
        Clearance::Free(FreeReason::Separated(of)) => separated(of),
        Clearance::Overlapping(OverlapAhead { first, last }) => {
            let [back, on] = [first, last].map(|contact| Some(-contact.certificate.lower));
            Overlapping { value: None, back, on, least_tolerance: None }.found()
        }
    }
}
