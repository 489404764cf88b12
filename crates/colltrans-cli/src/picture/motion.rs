//! A picture of bodies that turn: the moving one at the start and at the end as ghosts, and where it first touches,
//! with the way of its middle. The other one is where it is then.

use colltrans::Pose;
use colltrans::glam::DVec3;
use colltrans::motion::Motion;
use colltrans::record::{Ending, FeaturesRecord, MotionRecord, TimeRecord};
use colltrans_picture::{MOVING, Stroke};

use super::parts::draw_seen;
use super::solid::Solid;
use super::subject::{Subject, components, short};
use super::{Cast, Surface, middle_of};
use crate::report::never;

/// Pieces of the way that is drawn: one turn of them is round, and so are twenty.
const WAY: u32 = 480;

/// What is drawn.
#[derive(Clone, Copy)]
pub(crate) struct Moved<'a> {
    pub(crate) record: &'a MotionRecord,
    /// Of the moving body (0) and of the fixed one (1).
    pub(crate) motions: [&'a Motion; 2],
    pub(crate) surface: &'a dyn Fn(usize, &Pose, DVec3) -> Surface,
}

/// The SVG file of an answer.
pub(crate) fn draw_motion(moved: Moved<'_>) -> String {
    let Moved { record, motions, surface } = moved;
    let place = |k: usize, time: f64| motions[k].at(time).unwrap_or_else(|_| motions[k].start());
    let stop = match (record.time, record.outcome) {
        (Some(TimeRecord { lower, .. }), _) => lower,
        (None, Ending::Overlapping) => 0.0,
        _ => 1.0,
    };
    let subject = subject(&moved, place(1, stop));
    let body = |k: usize, time: f64| surface(k, &place(k, time), subject.origin);
    let solid = |time: f64| {
        let (vertices, triangles) = body(0, time);
        Solid::of_triangles(vertices, &triangles)
    };
    let [(_, moving), (fixed, fixed_triangles)] = [body(0, stop), body(1, stop)];
    let ends = [("the start", 0.0), ("the end", 1.0)].into_iter().filter(|(_, time)| *time != stop);
    let ghosts = ends.map(|(name, time)| (name, solid(time))).collect();
    let cast = Cast {
        start: None,
        stop: solid(stop),
        fixed: Solid::of_triangles(fixed, &fixed_triangles),
        ghosts,
        way: DVec3::ZERO,
        is_broken: false,
    };
    let way = way(&cast, |time| place(0, time), stop, subject.origin);
    let along = way.first().zip(way.last()).map_or(DVec3::X, |(a, b)| *b - *a);
    let along = along.try_normalize().unwrap_or(DVec3::X);
    draw_seen(&cast, &subject, along, [&moving, &fixed_triangles], |page, eye| {
        let on_page = |p: &DVec3| eye.layout.on_page(eye.view.project(*p));
        let seen: Vec<_> = way.iter().map(on_page).collect();
        page.polyline(Stroke::dashed(MOVING.line, 1.1, "5 4"), &seen);
    })
}

/// Points on the way of the moving body's middle.
fn way(cast: &Cast, place: impl Fn(f64) -> Pose, stop: f64, origin: DVec3) -> Vec<DVec3> {
    let middle = cast.stop.ball().0;
    let at_stop = place(stop);
    let own = at_stop.matrix().transpose() * (middle + origin - at_stop.translation());
    let at = |k: u32| {
        let pose = place(f64::from(k) / f64::from(WAY));
        pose.matrix() * own + pose.translation() - origin
    };
    (0..=WAY).map(at).collect()
}

/// What the picture has to tell.
fn subject(moved: &Moved<'_>, fixed: Pose) -> Subject {
    let record = moved.record;
    let point = record.point.map(DVec3::from);
    // Without a point the middle of the fixed body.
    let origin = point.unwrap_or_else(|| middle_of(&(moved.surface)(1, &fixed, DVec3::ZERO)));
    Subject {
        origin,
        stop: 0.0,
        normal: record.normal.map_or(DVec3::ZERO, DVec3::from),
        touches: point.is_some() && record.normal.is_some(),
        marks: None,
        margin: None,
        link: None,
        meets: false,
        is_still: true,
        way: String::new(),
        headline: headline(record),
        details: details(record),
    }
}

fn headline(record: &MotionRecord) -> String {
    match (record.outcome, record.time) {
        (Ending::Contact, Some(time)) => format!("Contact at {} of the motion", short(time.lower)),
        (Ending::Blocked, Some(time)) => format!("Free to go {} of the motion", short(time.lower)),
        (Ending::Grazing, Some(time)) => {
            format!("Grazing: perhaps a contact at {} of the motion", short(time.lower))
        }
        (Ending::Undecided, Some(time)) => {
            format!("Undecided: free until {} of the motion", short(time.lower))
        }
        (Ending::Overlapping, _) => "Overlapping: the bodies overlap when it begins".into(),
        _ => format!("Free: {} throughout the motion", never(record)),
    }
}

fn details(record: &MotionRecord) -> Vec<String> {
    let mut details = Vec::new();
    if let (Some(FeaturesRecord { moving, fixed }), Some(normal)) =
        (&record.features, record.normal)
    {
        let normal = components(normal.into());
        details.push(format!(
            "{} of the moving body on {} of the fixed body; normal n = {normal}",
            moving.kind, fixed.kind
        ));
    }
    if let Some(TimeRecord { lower, upper: Some(upper) }) = record.time {
        // The difference itself changes with the last bits of a search.
        let within = (upper - lower).max(1e-15);
        details.push(format!("proven lower and upper bound of the time agree to {within:.0e}"));
    }
    details
}
