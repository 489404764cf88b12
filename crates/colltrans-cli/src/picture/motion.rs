//! A picture of bodies that turn: the moving one solid at the start, and as ghosts where it first touches and at the end,
//! with the path of its center. The fixed body is shown at the time of the contact, or at the end without one.

use colltrans::Pose;
use colltrans::glam::DVec3;
use colltrans::motion::Motion;
use colltrans::record::{Ending, FeaturesRecord, MotionRecord, TimeRecord};
use colltrans_picture::{GUIDE_WIDTH, MOVING, Stroke};

use super::parts::draw_with_depths;
use super::solid::Solid;
use super::subject::{Subject, short, vector_text};
use super::{PictureBodies, Surface, vertex_mean};
use crate::report::never_statement;

/// Number of segments of the drawn path, so that even twenty turns look round.
const PATH_SEGMENTS: u32 = 480;

/// An answer about motions, and the bodies to draw.
#[derive(Clone, Copy)]
pub(crate) struct MotionPicture<'a> {
    pub(crate) record: &'a MotionRecord,
    /// The motions of the moving body (0) and of the fixed one (1).
    pub(crate) motions: [&'a Motion; 2],
    pub(crate) surface: &'a dyn Fn(usize, &Pose, DVec3) -> Surface,
}

/// Returns the picture of an answer as SVG.
pub(crate) fn draw_motion(picture: MotionPicture<'_>) -> String {
    let MotionPicture { record, motions, surface } = picture;
    let pose =
        |k: usize, time: f64| motions[k].pose_at(time).unwrap_or_else(|_| motions[k].start_pose());
    let stop = match (record.time, record.outcome) {
        (Some(TimeRecord { lower, .. }), _) => lower,
        (None, Ending::Overlapping) => 0.0,
        _ => 1.0,
    };
    let subject = motion_subject(&picture, pose(1, stop));
    let body = |k: usize, time: f64| surface(k, &pose(k, time), subject.origin);
    let solid = |time: f64| {
        let (vertices, triangles) = body(0, time);
        Solid::from_triangles(vertices, &triangles)
    };
    let [(_, moving), (fixed, fixed_triangles)] = [body(0, stop), body(1, stop)];
    let ghosts = [("moving, at the end", 1.0)].into_iter().filter(|(_, time)| *time != stop);
    let ghosts = ghosts.map(|(name, time)| (name, solid(time))).collect();
    let bodies = PictureBodies {
        start: (stop != 0.0).then(|| solid(0.0)),
        stop: solid(stop),
        fixed: Solid::from_triangles(fixed, &fixed_triangles),
        ghosts,
        way: DVec3::ZERO,
        is_broken: false,
    };
    let path = center_path(&bodies, |time| pose(0, time), stop, subject.origin);
    let along = path.first().zip(path.last()).map_or(DVec3::X, |(a, b)| *b - *a);
    let along = along.try_normalize().unwrap_or(DVec3::X);
    draw_with_depths(&bodies, &subject, along, [&moving, &fixed_triangles], |page, eye| {
        let on_page = |p: &DVec3| eye.layout.on_page(eye.view.project(*p));
        let points: Vec<_> = path.iter().map(on_page).collect();
        page.polyline(Stroke::dashed(MOVING.line, GUIDE_WIDTH, "5 4"), &points);
    })
}

/// Returns points on the path of the moving body's center.
fn center_path(
    bodies: &PictureBodies,
    pose: impl Fn(f64) -> Pose,
    stop: f64,
    origin: DVec3,
) -> Vec<DVec3> {
    let middle = bodies.stop.bounding_sphere().0;
    let at_stop = pose(stop);
    let local = at_stop.matrix().transpose() * (middle + origin - at_stop.translation());
    let point_at = |k: u32| {
        let pose = pose(f64::from(k) / f64::from(PATH_SEGMENTS));
        pose.matrix() * local + pose.translation() - origin
    };
    (0..=PATH_SEGMENTS).map(point_at).collect()
}

/// Returns the content of the picture.
fn motion_subject(picture: &MotionPicture<'_>, fixed: Pose) -> Subject {
    let record = picture.record;
    let point = record.point.map(DVec3::from);
    // Without a contact point, the mean of the fixed body's vertices.
    let origin = point.unwrap_or_else(|| vertex_mean(&(picture.surface)(1, &fixed, DVec3::ZERO)));
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
        details: detail_lines(record),
    }
}

/// Returns the headline of the picture.
fn headline(record: &MotionRecord) -> String {
    match (record.outcome, record.time) {
        (Ending::Contact, Some(time)) => format!("Contact at {} of the motion", short(time.lower)),
        (Ending::Blocked, Some(time)) => {
            format!("Free to move for {} of the motion", short(time.lower))
        }
        (Ending::Grazing, Some(time)) => {
            format!("Grazing: perhaps a contact at {} of the motion", short(time.lower))
        }
        (Ending::Undecided, Some(time)) => {
            format!("Undecided: free until {} of the motion", short(time.lower))
        }
        (Ending::Overlapping, _) => {
            "Overlapping: the bodies overlap at the start of the motion".into()
        }
        _ => format!("Free: {} throughout the motion", never_statement(record)),
    }
}

/// Returns the lines below the headline.
fn detail_lines(record: &MotionRecord) -> Vec<String> {
    let mut details = Vec::new();
    if let (Some(FeaturesRecord { moving, fixed }), Some(normal)) =
        (&record.features, record.normal)
    {
        let normal = vector_text(normal.into());
        details.push(format!(
            "{} of the moving body on {} of the fixed body; normal n = {normal}",
            moving.kind, fixed.kind
        ));
    }
    if let Some(TimeRecord { lower, upper: Some(upper) }) = record.time {
        // A floor, because the difference itself depends on the last bits of a search.
        let within = (upper - lower).max(1e-15);
        details.push(format!("proven lower and upper bound of the time agree to {within:.0e}"));
    }
    details
}
