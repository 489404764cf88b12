//! A picture of two bodies where they are: the shortest way between them, or out of each other.

use colltrans::glam::DVec3;
use colltrans::record::{DepthRecord, DistanceRecord, Ending, FeaturesRecord, Record};

use super::parts::draw_seen;
use super::solid::Solid;
use super::subject::{Subject, components, short};
use super::{Cast, Surface, middle_of};

/// The SVG file of an answer about bodies where they are; `surface` is that of the moving body (0) and of the fixed one
/// (1), relative to a point.
pub(crate) fn draw_pair(record: &Record, surface: &dyn Fn(usize, DVec3) -> Surface) -> String {
    // Without points the middle of the fixed body.
    let middle = || middle_of(&surface(1, DVec3::ZERO));
    let subject = match record {
        Record::Distance(of) => of_distance(of, middle),
        Record::Depth(of) => of_depth(of, middle()),
        _ => return String::new(),
    };
    let surfaces = [0, 1].map(|k| surface(k, subject.origin));
    let [moving, fixed] = surfaces.each_ref().map(|(v, t)| Solid::of_triangles(v.clone(), t));
    // The way that a depth is long, or the one that is looked along.
    let way = if subject.normal == DVec3::ZERO { DVec3::X } else { subject.normal };
    let cast = Cast::placed(&moving, fixed, way, &subject);
    let triangles = surfaces.each_ref().map(|(_, triangles)| &triangles[..]);
    draw_seen(&cast, &subject, way, triangles, |_, _| ())
}

fn of_distance(record: &DistanceRecord, middle: impl FnOnce() -> DVec3) -> Subject {
    let points = record.points.map(|points| points.map(DVec3::from));
    let origin = points.map_or_else(middle, |[a, b]| a.midpoint(b));
    let meets = record.outcome == Ending::Meeting || record.upper == Some(0.0);
    let apart = points.filter(|[a, b]| a != b && !meets);
    let length = record.upper.map_or(String::new(), short);
    let told = if record.lower.is_some() { "distance" } else { "at most" };
    let headline = match record.outcome {
        Ending::Apart => format!("Apart: {length} between the nearest points"),
        Ending::Meeting => "Meeting: the bodies touch or overlap".into(),
        Ending::Closer => format!("Closer: at most {length} apart"),
        Ending::Farther => {
            format!("Farther: at least {} apart", short(record.lower.unwrap_or_default()))
        }
        _ => format!("Undecided: {length} apart, as the length is"),
    };
    let mut details = Vec::new();
    if let (Some(FeaturesRecord { moving, fixed }), Some(normal)) =
        (&record.features, record.normal)
    {
        details.push(format!(
            "{} of the moving body, {} of the fixed body; normal n = {}",
            moving.kind,
            fixed.kind,
            components(normal.into())
        ));
    }
    details.extend(agreement(record.lower, record.upper));
    Subject {
        origin,
        stop: 0.0,
        normal: record.normal.map_or(DVec3::ZERO, DVec3::from),
        touches: false,
        marks: None,
        margin: None,
        link: apart.map(|ends| (ends.map(|end| end - origin), format!("{told} {length}"))),
        meets: points.is_some() && meets,
        is_still: true,
        way: format!("depth {length}"),
        headline,
        details,
    }
}

fn of_depth(record: &DepthRecord, origin: DVec3) -> Subject {
    let stop = record.upper.unwrap_or_default();
    let length = record.upper.map_or(String::new(), short);
    let headline = match record.outcome {
        Ending::Apart => "Apart: the bodies have no point in common".into(),
        Ending::Touching => "Touching: rounding cannot tell more".into(),
        _ if record.upper.is_some() => {
            format!("Overlapping: parted by a translation of {length}")
        }
        _ => "Overlapping: the parts overlap now".into(),
    };
    let mut details = Vec::new();
    if let Some(direction) = record.direction {
        details.push(format!("shortest way out along {}", components(direction.into())));
    }
    details.extend(agreement(record.lower, record.upper));
    if let Some(overlap) = record.start_overlaps.first() {
        let depth = overlap.least_tolerance.map_or("none".into(), short);
        details.push(format!("tolerance that would part them: {depth}"));
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

/// How near the bounds are to each other.
fn agreement(lower: Option<f64>, upper: Option<f64>) -> Option<String> {
    let (lower, upper) = (lower?, upper.filter(|upper| *upper > 0.0)?);
    // The difference itself changes with the last bits of a search.
    let within = (upper - lower).max(1e-15 * upper);
    Some(format!("proven lower and upper bound agree to {within:.0e}"))
}
