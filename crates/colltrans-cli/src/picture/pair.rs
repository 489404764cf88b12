//! A picture of two bodies where they are: the shortest way between them, or out of each other.

use colltrans::glam::DVec3;
use colltrans::record::{Ending, FeaturesRecord, PairQuestion, Record};

use super::parts::draw_seen;
use super::solid::Solid;
use super::subject::{Subject, components, short};
use super::{Cast, Surface, middle_of};

/// What is drawn.
#[derive(Clone, Copy)]
pub(crate) struct Shown<'a> {
    pub(crate) question: PairQuestion,
    pub(crate) record: &'a Record,
    /// Of the moving body (0) and of the fixed one (1).
    pub(crate) surface: &'a dyn Fn(usize, DVec3) -> Surface,
}

/// The SVG file of an answer.
pub(crate) fn draw_pair(shown: Shown<'_>) -> String {
    let subject = subject(&shown);
    let surfaces = [0, 1].map(|k| (shown.surface)(k, subject.origin));
    let [moving, fixed] = surfaces.each_ref().map(|(v, t)| Solid::of_triangles(v.clone(), t));
    // The way that a depth is long, or the one that is looked along.
    let way = shown.record.direction.or(shown.record.normal).map_or(DVec3::X, DVec3::from);
    let cast = Cast::placed(&moving, fixed, way, &subject);
    let triangles = surfaces.each_ref().map(|(_, triangles)| &triangles[..]);
    draw_seen(&cast, &subject, way, triangles, |_, _| ())
}

/// What the picture has to tell.
fn subject(shown: &Shown<'_>) -> Subject {
    let record = shown.record;
    let points = record.points.map(|points| points.map(DVec3::from));
    let middle = points.map(|[a, b]| a.midpoint(b));
    // Without points the middle of the fixed body.
    let origin = middle.unwrap_or_else(|| middle_of(&(shown.surface)(1, DVec3::ZERO)));
    let is_depth = shown.question == PairQuestion::Depth;
    let stop = record.upper.filter(|_| is_depth).unwrap_or_default();
    let meets = record.outcome == Ending::Meeting || record.upper == Some(0.0);
    let apart = points.filter(|[a, b]| a != b && !meets);
    let length = record.upper.map_or(String::new(), short);
    let told = if record.lower.is_some() { "distance" } else { "at most" };
    Subject {
        origin,
        stop,
        normal: record.normal.or(record.direction).map_or(DVec3::ZERO, DVec3::from),
        touches: false,
        marks: None,
        margin: None,
        link: apart.map(|ends| (ends.map(|end| end - origin), format!("{told} {length}"))),
        meets: middle.is_some() && meets,
        is_still: !is_depth || stop == 0.0,
        way: format!("depth {length}"),
        headline: headline(record, &length, is_depth),
        details: details(record),
    }
}

fn headline(record: &Record, length: &str, is_depth: bool) -> String {
    match record.outcome {
        Ending::Apart if is_depth => "Apart: the bodies have no point in common".into(),
        Ending::Apart => format!("Apart: {length} between the nearest points"),
        Ending::Touching => "Touching: rounding cannot tell more".into(),
        Ending::Meeting => "Meeting: the bodies touch or overlap".into(),
        Ending::Closer => format!("Closer: at most {length} apart"),
        Ending::Farther => {
            format!("Farther: at least {} apart", short(record.lower.unwrap_or_default()))
        }
        Ending::Undecided => format!("Undecided: {length} apart, as the length is"),
        _ if record.upper.is_some() => {
            format!("Overlapping: parted by a translation of {length}")
        }
        _ => "Overlapping: the parts overlap now".into(),
    }
}

fn details(record: &Record) -> Vec<String> {
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
    if let Some(direction) = record.direction {
        details.push(format!("shortest way out along {}", components(direction.into())));
    }
    if let (Some(lower), Some(upper)) = (record.lower, record.upper)
        && upper > 0.0
    {
        // The difference itself changes with the last bits of a search.
        let within = (upper - lower).max(1e-15 * upper);
        details.push(format!("proven lower and upper bound agree to {within:.0e}"));
    }
    if let Some(overlap) = record.start_overlaps.first() {
        let depth = overlap.least_tolerance.map_or("none".into(), short);
        details.push(format!("tolerance that would part them: {depth}"));
    }
    details
}
