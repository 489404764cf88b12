//! Judges first contacts of rotating solids: by exact decisions about solids at times on the way, by the convex
//! search if both bodies are convex, and by exchanging the bodies.

use colltrans::motion::{Motion, MotionCast, MotionClearance, MotionOutcome, SolidMotionProof};
use colltrans::solid::SolidCast;
use colltrans::{Cast, ConvexPolyhedron, Pose, QueryError, Solid};
use glam::DVec3;

use super::nearest;
use crate::random::Random;
use crate::shapes::random_hull;
use crate::solids::{pin, thread, washer};

/// The families in addition to those of distances: hulls compared with the convex search, pins in holes,
/// threads in nuts.
pub const FAMILIES: [&str; 3] = ["hulls", "pins", "threads"];

/// Number of times before a contact at which solids are checked.
const TIMES: u32 = 100;

/// Minimum ratio of the distance from the origin to the size for bodies to count as far.
const FAR: f64 = 16.0;

/// Maximum number of pairs of facets of a setting.
const MOST_PAIRS: usize = 400_000;

/// Tolerance for contacts of convex bodies and of the same bodies as solids, in addition to their bounds, for
/// bodies of size 1. Solids are slightly shrunk.
const AGREEMENT: f64 = 1e-7;

/// The outcome, for statistics.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum TurningOutcome {
    /// The bodies overlap at the start of the motion.
    Overlapping,
    /// The bodies never meet.
    Free,
    /// The bodies come nearer than rounding can decide.
    Grazing,
    /// The bodies meet.
    Contact,
}

/// Two solids and their motions.
#[derive(Debug, Clone)]
pub struct Turning {
    solids: [Solid; 2],
    motions: [Motion; 2],
    tolerance: Option<f64>,
    min_gap: f64,
    convex: Option<[ConvexPolyhedron; 2]>,
}

/// Computes the answers, and judges them; `None` for bodies that are not solids.
///
/// # Errors
/// A description of the first disagreement.
pub fn examine(family: &str, seed: u64) -> Result<Option<TurningOutcome>, String> {
    let Some(turning) = Turning::draw(family, seed)? else { return Ok(None) };
    if turning.solids.iter().map(|s| s.triangles().len()).product::<usize>() > MOST_PAIRS {
        return Ok(None);
    }
    turning.examine()
}

impl Turning {
    /// Draws the setting of a family with a seed.
    ///
    /// # Errors
    /// A message if the family is unknown, or the library rejects a body.
    pub fn draw(family: &str, seed: u64) -> Result<Option<Self>, String> {
        let random = &mut Random::stream(seed, &[family.len() as u64, 0x7047]);
        match family {
            "hulls" => draw_hulls(random).map(Some),
            "pins" => draw_pin_in_hole(random).map(Some),
            "threads" => draw_bolt_in_nut(random).map(Some),
            _ => {
                let Some(setting) = nearest::Setting::draw(family, seed)? else { return Ok(None) };
                let nearest::Setting { solids, poses } = setting;
                let size =
                    solids.iter().map(|s| s.bounds().side_lengths().length()).fold(0.0, f64::max);
                let way = poses[1].translation() - poses[0].translation();
                let moving = draw_motion(poses[0], way, size, random)?;
                let fixed = if random.one_in(3) {
                    draw_motion(poses[1], -way, size, random)?
                } else {
                    Motion::at_rest(poses[1])
                };
                let tolerance = random.one_in(4).then(|| size * random.pick(&[1e-9, 1e-4, 1e-2]));
                let min_gap =
                    if random.one_in(6) { size * random.pick(&[1e-6, 1e-2]) } else { 0.0 };
                let motions = [moving, fixed];
                Ok(Some(Self { solids, motions, tolerance, min_gap, convex: None }))
            }
        }
    }

    fn cast(&self, swapped: bool) -> Result<Option<MotionCast<'_, Solid>>, String> {
        let [a, b] = [0, 1].map(|k| self.solids[k].with_motion(&self.motions[k]));
        let [moving, fixed] = if swapped { [b, a] } else { [a, b] };
        let cast = MotionCast::<Solid>::new(moving, fixed)
            .and_then(|cast| cast.with_min_gap(self.min_gap));
        let cast = cast.map_err(|e| e.to_string())?;
        // A body may vanish when it is shrunk by the tolerance.
        let tolerance = self.tolerance.unwrap_or_else(|| cast.tolerance());
        Ok(cast.with_tolerance(tolerance).ok())
    }

    fn examine(&self) -> Result<Option<TurningOutcome>, String> {
        let Some(cast) = self.cast(false)? else { return Ok(None) };
        let plain = cast.first_contact().map_err(|e| e.to_string())?;
        let outcome = cast.certified_first_contact().map_err(|e| e.to_string())?;
        let [lower, upper] = cast.verify(outcome.proof()).map_err(|e| e.to_string())?;
        let claimed = time_bounds(&outcome);
        if claimed != [lower, upper] {
            return Err(format!("proven {lower} to {upper}, claimed {claimed:?}"));
        }
        check_agreement(time_bounds(&plain), claimed, 0.0)
            .map_err(|e| format!("with its proof: {e}"))?;
        let swapped = self.cast(true)?.ok_or("swapped, nothing is left")?;
        let swapped = swapped.first_contact().map_err(|e| e.to_string())?;
        check_agreement(time_bounds(&swapped), claimed, 1e-9)
            .map_err(|e| format!("swapped: {e}"))?;
        self.on_the_way(&outcome, [lower, upper])?;
        self.how_far(&cast, &plain)?;
        if let Some([p, q]) = &self.convex {
            let [a, b] = &self.motions;
            let cast =
                MotionCast::new(p.with_motion(a), q.with_motion(b)).map_err(|e| e.to_string())?;
            let found = cast.first_contact().map_err(|e| e.to_string())?;
            check_agreement(time_bounds(&found), claimed, AGREEMENT)
                .map_err(|e| format!("convex: {e}"))?;
        }
        Ok(Some(match outcome {
            MotionOutcome::Overlapping(_) => TurningOutcome::Overlapping,
            MotionOutcome::Free(_) => TurningOutcome::Free,
            MotionOutcome::Grazing(_) => TurningOutcome::Grazing,
            _ => TurningOutcome::Contact,
        }))
    }

    /// Checks the clearance: it extends to the contact of the shrunk bodies, not before the nominal contact,
    /// and as far as for convex bodies.
    fn how_far(&self, cast: &MotionCast<Solid>, first: &MotionOutcome<()>) -> Result<(), String> {
        let found = cast.clearance().map_err(|e| format!("clearance: {e}"))?;
        let object = |what: &str| Err(format!("clearance up to {:?}: {what}", found.time()));
        let (time, contact) = match (&found, first) {
            (MotionClearance::Overlapping(_), MotionOutcome::Overlapping(_))
            | (MotionClearance::Free(_), MotionOutcome::Free(_)) => return Ok(()),
            (
                MotionClearance::Blocked { time, contact },
                MotionOutcome::Contact(_) | MotionOutcome::Grazing(_),
            ) => (*time, contact),
            _ => return object("not what the first contact says"),
        };
        let (place, shrunk) = (contact.time, [contact.shrunk.lower, contact.shrunk.upper]);
        if shrunk != time_bounds(first) {
            return object("the shrunk bodies meet at another time");
        }
        let is_bound = time == place.lower.min(shrunk[0]) && time >= 0.0;
        if !is_bound
            || place.lower > place.value
            || place.value > place.upper
            || place.upper > shrunk[1]
        {
            return object("no bounds");
        }
        let Some([p, q]) = &self.convex else { return Ok(()) };
        let [a, b] = &self.motions;
        let convex =
            MotionCast::new(p.with_motion(a), q.with_motion(b)).and_then(|cast| cast.clearance());
        match convex.map_err(|e| format!("clearance, convex: {e}"))? {
            MotionClearance::Blocked { contact, .. } => {
                check_agreement(contact.time.bounds(), place.bounds(), AGREEMENT)
                    .map_err(|e| format!("clearance, convex: {e}"))
            }
            // Solids are slightly smaller.
            other if place.upper < 1.0 - AGREEMENT => Err(format!("clearance, convex: {other:?}")),
            _ => Ok(()),
        }
    }

    /// Checks exact decisions about solids at times before the contact, and at it.
    fn on_the_way(
        &self,
        outcome: &MotionOutcome<SolidMotionProof>,
        [lower, upper]: [f64; 2],
    ) -> Result<(), String> {
        if matches!(outcome, MotionOutcome::Overlapping(_)) {
            return Ok(());
        }
        // Far from the origin, poses in the world have a large rounding error. There, the check that the bodies do not
        // overlap has a larger tolerance, and the check that they meet is left out.
        let far = self.motions.iter().map(|motion| {
            let ends =
                [0.0, lower].map(|t| motion.pose_at(t).map_or(0.0, |at| at.translation().length()));
            ends[0].max(ends[1])
        });
        let size =
            self.solids.iter().map(|s| s.bounds().side_lengths().length()).fold(0.0, f64::max);
        let (far, tolerance) = (far.fold(0.0, f64::max), outcome.proof().tolerance);
        let is_near = far <= FAR * size;
        let more = if is_near { tolerance } else { tolerance + 32.0 * f64::EPSILON * far };
        let overlaps = |time: f64, tolerance: f64| -> Result<bool, String> {
            let [a, b] = [0, 1].map(|k| self.motions[k].pose_at(time).map_err(|e| e.to_string()));
            let cast = Cast::new(self.solids[0].at(a?), self.solids[1].at(b?), DVec3::Z);
            let cast =
                cast.and_then(|cast| cast.with_tolerance(tolerance)?.with_min_gap(self.min_gap));
            match cast {
                Err(QueryError::NothingLeft { .. }) => Ok(false),
                cast => Ok(cast.map_err(|e| e.to_string())?.overlaps()),
            }
        };
        for k in 0..=TIMES {
            let time = lower * f64::from(k) / f64::from(TIMES);
            if overlaps(time, more)? {
                return Err(format!("free up to {lower}, but an overlap at {time}"));
            }
        }
        // With a gap, rounding decides whether the bodies are nearer.
        if upper <= 1.0 && self.min_gap == 0.0 && is_near && !overlaps(upper, tolerance)? {
            return Err(format!("met at {upper}, but no overlap"));
        }
        Ok(())
    }
}

/// Returns the bounds of an answer's time.
fn time_bounds<P>(outcome: &MotionOutcome<P>) -> [f64; 2] {
    match outcome {
        MotionOutcome::Contact(of)
        | MotionOutcome::Grazing(of)
        | MotionOutcome::Overlapping(of) => [of.lower, of.upper],
        _ => [1.0, f64::INFINITY],
    }
}

/// Checks whether two enclosures of a time have a common point, up to a tolerance.
fn check_agreement(one: [f64; 2], other: [f64; 2], within: f64) -> Result<(), String> {
    let apart = one[0] > other[1] + within || other[0] > one[1] + within;
    // Only one of both may be free.
    let free = |bounds: [f64; 2]| bounds == [1.0, f64::INFINITY];
    let meets = |bounds: [f64; 2]| bounds[1] <= 1.0 - within;
    if apart || free(one) && meets(other) || free(other) && meets(one) {
        return Err(format!("{one:?}, not {other:?}"));
    }
    Ok(())
}

/// Draws a rotation, a screw motion, a translation, a throw or a motion through poses, of a body of about this
/// size.
fn draw_motion(pose: Pose, way: DVec3, size: f64, random: &mut Random) -> Result<Motion, String> {
    let at = pose.translation();
    let axis = if random.one_in(2) { random.pick(&DVec3::AXES) } else { random.direction() };
    let point = if random.one_in(3) { at } else { at + random.vector() * size };
    let angle = random.range(-1.0, 1.0) * random.pick(&[1e-6, 1.0, 6.0, 6.0, 30.0]);
    match random.index(5) {
        0 => Motion::rotation_about(pose, point, axis, angle),
        1 => Motion::screw(pose, point, axis, angle, random.range(-1.0, 1.0) * size),
        2 => Motion::translation(pose, way * random.range(-2.0, 2.0) + random.vector() * size),
        3 => {
            let velocity = way * random.range(0.0, 2.0) + random.vector() * size;
            Motion::free_flight(pose, point, velocity, axis * angle)
        }
        _ => {
            let next = |random: &mut Random| {
                Pose::new(random.rotation(), at + random.vector() * size * 2.0)
            };
            let poses = [next(random), next(random)].map(|pose| pose.map_err(|e| e.to_string()));
            let [a, b] = poses;
            Motion::through_poses(&[pose, a?, b?])
        }
    }
    .map_err(|e| e.to_string())
}

/// Draws convex bodies that pass each other.
fn draw_hulls(random: &mut Random) -> Result<Turning, String> {
    let body = |random: &mut Random| {
        let n = random.pick(&[4, 8, 16, 40]);
        ConvexPolyhedron::from_points(&random_hull(n, random).vertices).map_err(|e| e.to_string())
    };
    let convex = [body(random)?, body(random)?];
    let from = random.direction() * random.range(2.5, 5.0);
    let pose = Pose::new(random.rotation(), from).map_err(|e| e.to_string())?;
    let way = (random.vector() * 1.5 - from) * random.range(0.5, 2.0);
    let spin = random.direction() * random.range(0.1, 6.0);
    let moving = Motion::free_flight(pose, from, way, spin).map_err(|e| e.to_string())?;
    let still =
        Motion::at_rest(Pose::new(random.rotation(), DVec3::ZERO).map_err(|e| e.to_string())?);
    let fixed =
        if random.one_in(3) { draw_motion(Pose::IDENTITY, from, 2.0, random)? } else { still };
    let solid = |body: &ConvexPolyhedron| Solid::from_convex(body).map_err(|e| e.to_string());
    let solids = [solid(&convex[0])?, solid(&convex[1])?];
    Ok(Turning {
        solids,
        motions: [moving, fixed],
        tolerance: None,
        min_gap: 0.0,
        convex: Some(convex),
    })
}

/// Draws a pin that rotates in a hole, and may leave it or tip over.
fn draw_pin_in_hole(random: &mut Random) -> Result<Turning, String> {
    let sides = random.int(3, 24) as usize;
    let hole = random.pick(&[1.0, 1.01, 1.1, 1.5]);
    let of = |mesh: crate::shapes::Mesh| {
        Solid::from_mesh(&mesh.vertices, &mesh.faces).map_err(|e| e.to_string())
    };
    let solids = [
        of(pin(1.0, [-1.0, random.range(0.2, 1.5)], sides))?,
        of(washer([hole, 2.0], [-0.5, 0.5], random.pick(&[sides, 16, 24])))?,
    ];
    let (pose, rise) = (Pose::IDENTITY, random.pick(&[0.0, 0.0, 1.0, 3.0]));
    let angle = random.range(-1.0, 1.0) * random.pick(&[0.1, 1.0, 6.0]);
    let tips = random.one_in(3);
    let axis = if tips { DVec3::Z + random.vector() * random.pick(&[1e-6, 0.1]) } else { DVec3::Z };
    let moving = Motion::screw(pose, DVec3::ZERO, axis, angle, rise).map_err(|e| e.to_string())?;
    let tolerance = random.one_in(2).then(|| random.pick(&[1e-6, 0.01, 0.05]));
    let motions = [moving, Motion::at_rest(pose)];
    Ok(Turning { solids, motions, tolerance, min_gap: 0.0, convex: None })
}

/// Draws a bolt in a nut, with the matching or a different pitch.
fn draw_bolt_in_nut(random: &mut Random) -> Result<Turning, String> {
    let sides = random.int(6, 14) as usize;
    let of = |mesh: crate::shapes::Mesh| {
        Solid::from_mesh(&mesh.vertices, &mesh.faces).map_err(|e| e.to_string())
    };
    let gap = random.pick(&[0.02, 0.05, 0.1]);
    let solids = [
        of(thread([1.0, 0.1, 0.5], [0.0, 2.0], [sides, 16], None))?,
        of(thread([1.0 + gap, 0.1, 0.5], [0.6, 1.4], [sides, 6], Some(1.5)))?,
    ];
    let turns = random.range(-0.6, 0.6);
    let pitch = 0.5 * random.pick(&[1.0, 1.0, 0.95, 1.1, 0.0]);
    let angle = turns * std::f64::consts::TAU;
    let pose = Pose::IDENTITY;
    let moving = Motion::screw(pose, DVec3::ZERO, DVec3::Z, angle, turns * pitch);
    let tolerance = random.one_in(2).then(|| random.pick(&[1e-3, 0.03]));
    let motions = [moving.map_err(|e| e.to_string())?, Motion::at_rest(pose)];
    Ok(Turning { solids, motions, tolerance, min_gap: 0.0, convex: None })
}
