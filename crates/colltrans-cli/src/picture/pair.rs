//! A picture of two placed bodies, with the shortest way between them or out of each other.

use colltrans::glam::DVec3;
use colltrans::record::{DepthRecord, DistanceRecord, Ending, FeaturesRecord, Record};

use super::parts::draw_with_depths;
use super::solid::Solid;
use super::subject::{Subject, short, vector_text};
use super::{PictureBodies, Surface, vertex_mean};

/// Returns the picture of an answer about placed bodies as SVG. `surface` returns the surface of the moving body (0) or of
/// the fixed one (1), relative to a point. Returns an empty string for other answers.
pub(crate) fn draw_pair(record: &Record, surface: &dyn Fn(usize, DVec3) -> Surface) -> String {
    // Without nearest points, the mean of the fixed body's vertices.
    let fixed_mean = || vertex_mean(&surface(1, DVec3::ZERO));
    let subject = match record {
        Record::Distance(of) => distance_subject(of, fixed_mean),
        Record::Depth(of) => depth_subject(of, fixed_mean()),
        _ => return String::new(),
    };
    let surfaces = [0, 1].map(|k| surface(k, subject.origin));
    let [moving, fixed] = surfaces.each_ref().map(|(v, t)| Solid::from_triangles(v.clone(), t));
    // The translation of a depth, or the direction that the view shows.
    let way = if subject.normal == DVec3::ZERO { DVec3::X } else { subject.normal };
    let bodies = PictureBodies::place(&moving, fixed, way, &subject);
    let triangles = surfaces.each_ref().map(|(_, triangles)| &triangles[..]);
    draw_with_depths(&bodies, &subject, way, triangles, |_, _| ())
}

/// Returns the content of the picture of a distance. `fixed_mean` is its origin without nearest points.
fn distance_subject(record: &DistanceRecord, fixed_mean: impl FnOnce() -> DVec3) -> Subject {
    let points = record.points.map(|points| points.map(DVec3::from));
    let origin = points.map_or_else(fixed_mean, |[a, b]| a.midpoint(b));
    let meets = record.outcome == Ending::Meeting || record.upper == Some(0.0);
    let apart = points.filter(|[a, b]| a != b && !meets);
    let length = record.upper.map_or(String::new(), short);
    let label = if record.lower.is_some() { "distance" } else { "at most" };
    let headline = match record.outcome {
        Ending::Apart => format!("Apart: {length} between the nearest points"),
        Ending::Meeting => "Meeting: the bodies touch or overlap".into(),
        Ending::Closer => format!("Closer: at most {length} apart"),
        Ending::Farther => {
            format!("Farther: at least {} apart", short(record.lower.unwrap_or_default()))
        }
        _ => format!("Undecided: {length} apart, nearly the length"),
    };
    let mut details = Vec::new();
    if let (Some(FeaturesRecord { moving, fixed }), Some(normal)) =
        (&record.features, record.normal)
    {
        details.push(format!(
            "{} of the moving body, {} of the fixed body; normal n = {}",
            moving.kind,
            fixed.kind,
            vector_text(normal.into())
        ));
    }
    details.extend(bound_agreement(record.lower, record.upper));
    Subject {
        origin,
        stop: 0.0,
        normal: record.normal.map_or(DVec3::ZERO, DVec3::from),
        touches: false,
        marks: None,
        margin: None,
        link: apart.map(|ends| (ends.map(|end| end - origin), format!("{label} {length}"))),
        meets: points.is_some() && meets,
        is_still: true,
        way: format!("depth {length}"),
        headline,
        details,
    }
}

/// Returns the content of the picture of a depth.
fn depth_subject(record: &DepthRecord, origin: DVec3) -> Subject {
    let stop = record.upper.unwrap_or_default();
    let length = record.upper.map_or(String::new(), short);
    let headline = match record.outcome {
        Ending::Apart => "Apart: the bodies have no common point".into(),
        Ending::Touching => "Touching: an overlap is not resolved by rounding".into(),
        _ if record.upper.is_some() => {
            format!("Overlapping: separated by a translation of {length}")
        }
        _ => "Overlapping: the parts overlap now".into(),
    };
    let mut details = Vec::new();
    if let Some(direction) = record.direction {
        details.push(format!("shortest way out along {}", vector_text(direction.into())));
    }
    details.extend(bound_agreement(record.lower, record.upper));
    if let Some(overlap) = record.start_overlaps.first() {
        let depth = overlap.least_tolerance.map_or("none".into(), short);
        details.push(format!("tolerance that would separate them: {depth}"));
    }
    Subject {
        origin,
        stop,
        normal: record.direction.map_or(DVec3::ZERO, DVec3::from),
        touches: false,
        marks: None,
        margin: None,
        link: None,
        meets: false,
        is_still: stop == 0.0,
        way: format!("depth {length}"),
        headline,
        details,
    }
}

/// Returns a line about the difference of two bounds; `None` without two positive ones.
fn bound_agreement(lower: Option<f64>, upper: Option<f64>) -> Option<String> {
    let (lower, upper) = (lower?, upper.filter(|upper| *upper > 0.0)?);
    // A floor, because the difference itself depends on the last bits of a search.
    let within = (upper - lower).max(1e-15 * upper);
    Some(format!("proven lower and upper bound agree to {within:.0e}"))
}
