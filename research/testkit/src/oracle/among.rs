//! Judges scene queries (one body among many obstacles) by queries of each obstacle.
//!
//! - *Selection.* The answer is about the obstacle whose own answer, from a pair or cast, has the smallest
//!   upper bound. If bounds are equal, the answer names the obstacle inserted first. Both are compared bit by
//!   bit.
//! - *Bounds.* For convex bodies the exact distance of each obstacle is at least the lower bound, and at least
//!   one of these distances is at most the upper bound. By the linear programme, no obstacle is met before the
//!   bound of a clearance, unless the bodies slide.
//! - *The tree has no effect.* Obstacles that were inserted, moved and removed yield the same answers as
//!   obstacles inserted in their final poses.
//! - *Proofs.* They are valid, and modified proofs are rejected.

use std::collections::BTreeSet;
use std::sync::Arc;

use colltrans::glam::{DQuat, DVec3};
use colltrans::solid::{SolidCast, SolidPair};
use colltrans::{
    AnyBody, AnyClearance, AnyDistance, AnyPlaced, ByKind, Cast, Clearance, ConvexPolyhedron,
    FreeReason, NearestProof, ObstacleId, Obstacles, Pair, Pose, QueryError, SceneQuery, Solid,
    Within,
};

use super::distance::distance;
use super::exact::{Ratio, place};
use super::scene::Scene;
use super::simplex::collision_translation;
use crate::random::Random;
use crate::shapes::random_hull;
use crate::tally::Tally;

/// The families of scenes.
pub const FAMILIES: [&str; 7] = ["rows", "coincident", "hulls", "thin", "far", "mixed", "rounded"];

/// The linear programme is solved for one setting out of this many.
const PROGRAMME_EVERY: u64 = 8;

/// Columns: numbers of scenes, of obstacles, of obstacles examined for the nearest one, of scenes with an
/// overlap, with equal upper bounds, in which the moving body was stopped, and of modified proofs that were
/// rejected.
pub const COLUMNS: &[&str] =
    &["scenes", "obstacles", "asked", "overlapped", "tied", "stopped", "refused"];

/// Draws a scene, and judges all its queries.
///
/// # Errors
/// A description of the first wrong answer.
pub fn examine(family: &str, seed: u64, tally: &mut Tally) -> Result<(), String> {
    tally.count("scenes");
    Setting::draw(family, seed)?.examine(tally)
}

/// A body, and obstacles that were inserted, moved and removed.
#[derive(Debug, Clone)]
pub struct Setting {
    obstacles: Obstacles,
    moving: AnyBody,
    pose: Pose,
    direction: DVec3,
    length: f64,
    seed: u64,
}

type Answer = (f64, ObstacleId);

/// Returns the message of an error.
fn error_message(error: &dyn std::fmt::Display) -> String {
    error.to_string()
}

macro_rules! require {
    ($condition:expr, $($text:tt)+) => {
        let holds: bool = $condition;
        if !holds {
            return Err(format!($($text)+));
        }
    };
}

impl Setting {
    /// Draws the setting of a family with a seed.
    ///
    /// # Errors
    /// A message if the family is unknown, or the library rejects a body.
    pub fn draw(family: &str, seed: u64) -> Result<Self, String> {
        let which = FAMILIES.iter().position(|name| *name == family).ok_or("no such family")?;
        let random = &mut Random::stream(seed, &[which as u64, 0xa303]);
        let bodies = draw_bodies(family, random)?;
        let count = random.pick(&[0, 1, 2, 5, 9, 14]);
        let mut obstacles = Obstacles::new();
        let mut all = Vec::new();
        for _ in 0..count {
            all.push((bodies[random.index(bodies.len())].clone(), place_for(family, random)?));
        }
        let mut ids = if random.one_in(2) {
            obstacles.insert_all(all)
        } else {
            all.into_iter().map(|(body, pose)| obstacles.insert(body, pose)).collect()
        };
        for _ in 0..random.index(12) {
            change_scene(family, &bodies, &mut obstacles, &mut ids, random)?;
        }
        let pose = place_for(family, random)?;
        let direction = if random.one_in(2) {
            random.pick(&[DVec3::X, DVec3::NEG_Y, DVec3::new(1.0, 1.0, 0.0), DVec3::Z * 3.0])
        } else {
            random.direction() * random.pick(&[1.0, 1e-3, 7.0])
        };
        let any = random.range(0.0, 8.0);
        let length = random.pick(&[0.0, 0.5, 1.0, 2.0, any]);
        let moving = bodies[random.index(bodies.len())].clone();
        Ok(Self { obstacles, moving, pose, direction, length, seed })
    }

    /// Builds a setting from a body and obstacles.
    pub fn of(
        obstacles: Obstacles,
        moving: AnyBody,
        pose: Pose,
        direction: DVec3,
        length: f64,
    ) -> Self {
        Self { obstacles, moving, pose, direction, length, seed: 0 }
    }

    /// Builds the scene query.
    ///
    /// # Errors
    /// The errors of [`SceneQuery::new`].
    pub fn asked(&self) -> Result<SceneQuery<'_>, QueryError> {
        SceneQuery::new(self.moving.at(self.pose), &self.obstacles)
    }

    /// Returns the direction and the length of the queries.
    pub const fn questions(&self) -> (DVec3, f64) {
        (self.direction, self.length)
    }

    /// Judges all queries.
    ///
    /// # Errors
    /// A description of the first wrong answer.
    pub fn examine(&self, tally: &mut Tally) -> Result<(), String> {
        let asked = self.asked().map_err(|e| error_message(&e))?;
        tally.add("obstacles", self.obstacles.len() as u64);
        self.judge(&asked, &|_| false, tally)?;
        let ignored = |id: ObstacleId| (id.0 ^ self.seed).is_multiple_of(3);
        self.judge(&asked.ignoring(&ignored), &ignored, &mut Tally::default())?;
        self.compare_anew(&asked)
    }

    /// Returns the obstacles that are not ignored, in the order of their insertion.
    fn all(&self, ignored: &dyn Fn(ObstacleId) -> bool) -> Vec<(ObstacleId, AnyPlaced<'_>)> {
        let mut all: Vec<_> = self
            .obstacles
            .iter()
            .filter(|(id, ..)| !ignored(*id))
            .map(|(id, body, pose)| (id, body.at(pose)))
            .collect();
        all.sort_by_key(|(id, _)| *id);
        all
    }

    /// Judges the queries of the obstacles that are not ignored.
    fn judge(
        &self,
        asked: &SceneQuery,
        ignored: &dyn Fn(ObstacleId) -> bool,
        tally: &mut Tally,
    ) -> Result<(), String> {
        let all = self.all(ignored);
        let own = self.moving.at(self.pose);
        let squares: Vec<Option<Ratio>> =
            all.iter().map(|(_, one)| squared_distance(&own, one)).collect();
        self.judge_nearest(asked, &all, &squares, tally).map_err(|e| format!("nearest: {e}"))?;
        self.judge_within(asked, &all, &squares).map_err(|e| format!("within: {e}"))?;
        self.judge_clearance(asked, &all, tally).map_err(|e| format!("clearance: {e}"))
    }

    /// Judges the nearest obstacle.
    fn judge_nearest(
        &self,
        asked: &SceneQuery,
        all: &[(ObstacleId, AnyPlaced)],
        squares: &[Option<Ratio>],
        tally: &mut Tally,
    ) -> Result<(), String> {
        let mut best: Option<(Answer, AnyDistance)> = None;
        let mut tied = false;
        for (id, one) in all {
            let distance =
                distance_of(self.moving.at(self.pose), *one).map_err(|e| error_message(&e))?;
            let key = (distance.upper(), *id);
            tied |= best.is_some_and(|(first, _)| first.0 == key.0);
            if best.is_none_or(|(first, _)| key < first) {
                best = Some((key, distance));
            }
        }
        tally.count_if("tied", tied);
        let found = asked.certified_nearest().map_err(|e| error_message(&e))?;
        let (Some((answer, proof)), Some(((upper, id), distance))) = (&found, &best) else {
            require!(found.is_none() && best.is_none(), "an answer without obstacles");
            return Ok(());
        };
        require!(answer.obstacle == *id, "{} and not {id}", answer.obstacle);
        require!(answer.distance == *distance, "another distance");
        require!(answer.lower <= answer.distance.lower(), "a lower bound above its own");
        require!(proof.lower <= answer.lower, "the proof has a larger lower bound");
        let noise = answer.distance.upper() - answer.distance.lower();
        require!(answer.lower >= distance.lower() - 2.0 * noise, "a lower bound {}", answer.lower);
        require!(
            proof.lower >= answer.lower - noise,
            "the proof has a smaller lower bound: {}",
            proof.lower
        );
        for ((id, _), square) in all.iter().zip(squares) {
            let Some(square) = square else { continue };
            require!(is_square_below(answer.lower, square), "{id} is nearer than the lower bound");
        }
        if let Some(square) =
            all.iter().position(|(one, _)| one == id).and_then(|k| squares[k].clone())
        {
            require!(!is_square_below(upper.next_up(), &square) || square.is_zero(), "farther");
        }
        tally.add("asked", answer.steps.bodies.into());
        tally.count_if("overlapped", distance.lower() == 0.0);
        asked.verify(proof).map_err(|e| error_message(&e))?;
        tally.add("refused", count_rejected_proofs(asked, proof)?);
        Ok(())
    }

    /// Judges the obstacles within a length.
    fn judge_within(
        &self,
        asked: &SceneQuery,
        all: &[(ObstacleId, AnyPlaced)],
        squares: &[Option<Ratio>],
    ) -> Result<(), String> {
        let (answer, proof) = asked.certified_within(self.length).map_err(|e| error_message(&e))?;
        let closer: BTreeSet<ObstacleId> = answer.closer.iter().map(|(id, _)| *id).collect();
        let undecided: BTreeSet<ObstacleId> = answer.undecided.iter().map(|(id, _)| *id).collect();
        for ((id, one), square) in all.iter().zip(squares) {
            let said = (closer.contains(id), undecided.contains(id));
            let own = is_within(self.moving.at(self.pose), *one, self.length)
                .map_err(|e| error_message(&e))?;
            // The box of an obstacle may decide what rounding leaves open for the pair.
            require!(
                said == own || (own.1 && said == (false, false)),
                "{id}: {said:?}, not {own:?}"
            );
            let Some(square) = square else { continue };
            let is_closer = !is_square_below(self.length.next_up(), square);
            let is_farther = is_square_below(self.length, square);
            require!(!said.0 || is_closer || !is_farther, "{id} is not closer");
            require!(said != (false, false) || is_farther, "{id} is closer");
        }
        require!(closer.len() + undecided.len() <= all.len(), "more than there are");
        asked.verify(&proof).map_err(|e| error_message(&e))?;
        if !proof.closer.is_empty() {
            let mut changed = proof.clone();
            changed.closer.pop();
            require!(
                asked.verify(&changed).is_err(),
                "a proof without a closer obstacle is accepted"
            );
        }
        Ok(())
    }

    /// Judges the clearance.
    fn judge_clearance(
        &self,
        asked: &SceneQuery,
        all: &[(ObstacleId, AnyPlaced)],
        tally: &mut Tally,
    ) -> Result<(), String> {
        let direction = self.direction;
        let mut best: Option<(Answer, AnyClearance)> = None;
        let mut least = f64::INFINITY;
        for (id, one) in all {
            let own = match clearance_of(self.moving.at(self.pose), *one, direction) {
                Err(QueryError::NothingLeft { .. }) => return self.judge_refusal(asked, *id),
                own => own.map_err(|e| error_message(&e))?,
            };
            least = least.min(own.distance().unwrap_or(0.0));
            let key = (upper_of(&own), *id);
            if key.0 < f64::INFINITY && best.is_none_or(|(first, _)| key < first) {
                best = Some((key, own));
            }
        }
        let (answer, proof) =
            asked.certified_clearance(direction).map_err(|e| error_message(&e))?;
        let expected = best.map(|((_, id), own)| (id, own));
        require!(
            answer.stop.map(|(id, _)| id) == expected.map(|(id, _)| id),
            "{:?} and not {:?}",
            answer.stop,
            expected
        );
        if let (Some((_, ByKind::Convex(a))), Some((_, ByKind::Convex(b)))) =
            (answer.stop, expected)
        {
            require!(a == b, "another clearance");
        }
        require!(answer.lower >= least, "{} and not {least}", answer.lower);
        require!(proof.lower <= answer.lower, "the proof has a larger lower bound");
        tally.count_if("stopped", answer.stop.is_some());
        asked.verify(&proof).map_err(|e| error_message(&e))?;
        if proof.lower < f64::INFINITY {
            let [mut higher, mut without] = [proof.clone(), proof.clone()];
            higher.lower = proof.lower * 1.001 + 0.001;
            without.passed.retain(|(id, _)| Some(*id) != proof.stop);
            let refused = [higher, without].map(|changed| asked.verify(&changed).is_err());
            require!(refused == [true; 2], "a modified proof is accepted: {refused:?}");
            tally.add("refused", 2);
        }
        if self.seed.is_multiple_of(PROGRAMME_EVERY) && answer.safe_translation().is_some() {
            self.judge_translations(all, answer.lower)?;
        }
        self.judge_end(asked, &answer)
    }

    /// Checks a query with a solid that vanishes when it is shrunk. If the query examines this obstacle, the
    /// error must name it.
    fn judge_refusal(&self, asked: &SceneQuery, thin: ObstacleId) -> Result<(), String> {
        match asked.certified_clearance(self.direction) {
            Ok(_) => Ok(()),
            Err(QueryError::Obstacle { reason, .. })
                if matches!(*reason, QueryError::NothingLeft { .. }) =>
            {
                Ok(())
            }
            Err(error) => Err(format!("{thin} is too thin, but: {error}")),
        }
    }

    /// Compares the bound with the linear programme.
    fn judge_translations(
        &self,
        all: &[(ObstacleId, AnyPlaced)],
        lower: f64,
    ) -> Result<(), String> {
        for (id, one) in all {
            if let (ByKind::Convex(p), ByKind::Convex(q)) = (self.moving.at(self.pose), *one) {
                self.not_met_before(p, q, lower).map_err(|e| format!("{id}: {e}"))?;
            }
        }
        Ok(())
    }

    /// Checks that a limit on the translation does not change the results before it.
    fn judge_end(
        &self,
        asked: &SceneQuery,
        answer: &colltrans::SceneClearance,
    ) -> Result<(), String> {
        for end in [0.0, 0.5, 1.0, 4.0] {
            let ended =
                asked.clearance_before(self.direction, end).map_err(|e| error_message(&e))?;
            let upper = answer.stop.map_or(f64::INFINITY, |(_, stop)| upper_of(&stop));
            let is_before = ended.stop.map(|(id, _)| id) == answer.stop.map(|(id, _)| id);
            require!(if upper < end { is_before } else { ended.stop.is_none() }, "end {end}");
            require!(ended.lower >= answer.lower.min(end), "end {end}: lower {}", ended.lower);
        }
        Ok(())
    }

    /// Checks that an obstacle is not met between 0 and a translation, unless the bodies slide.
    fn not_met_before(
        &self,
        p: colltrans::Placed,
        q: colltrans::Placed,
        lower: f64,
    ) -> Result<(), String> {
        let cast = Cast::new(p, q, self.direction).map_err(|e| error_message(&e))?;
        let Some(first) = collision_translation(&Scene::from_cast(&cast)) else { return Ok(()) };
        let slides = matches!(cast.clearance(), Ok(Clearance::Free(FreeReason::Slides(_))));
        let is_before = !first.is_negative() && first < Ratio::from_f64(lower.min(1e300));
        require!(!is_before || slides, "met at {:e}, before {lower:e}", first.to_f64());
        Ok(())
    }

    /// Compares with new obstacles in the final poses.
    fn compare_anew(&self, asked: &SceneQuery) -> Result<(), String> {
        let mut all: Vec<_> = self.obstacles.iter().collect();
        all.sort_by_key(|(id, ..)| *id);
        let mut anew = Obstacles::new();
        anew.insert_all(all.iter().map(|(_, body, pose)| ((*body).clone(), *pose)));
        let old = |id: ObstacleId| all[id.0 as usize].0;
        let other =
            SceneQuery::new(self.moving.at(self.pose), &anew).map_err(|e| error_message(&e))?;
        let [a, b] = [asked, &other].map(|asked| asked.nearest().ok().flatten());
        let of = |nearest: colltrans::Nearest| (nearest.distance, nearest.lower);
        require!(
            a.map(of) == b.map(of),
            "with new obstacles, the distance of the nearest one differs"
        );
        require!(
            a.map(|a| a.obstacle) == b.map(|b| old(b.obstacle)),
            "with new obstacles, the nearest one differs"
        );
        let [a, b] =
            [asked, &other].map(|asked| asked.within(self.length).map_err(|e| error_message(&e)));
        let (a, b) = (a?, b?);
        let closer: Vec<_> = b.closer.iter().map(|(id, near)| (old(*id), *near)).collect();
        require!(a.closer == closer, "with new obstacles, the closer ones differ");
        let [a, b] = [asked, &other].map(|asked| asked.clearance(self.direction).ok());
        let of = |answer: colltrans::SceneClearance| answer.stop.map(|(_, stop)| upper_of(&stop));
        require!(a.map(of) == b.map(of), "with new obstacles, the clearance differs");
        Ok(())
    }
}

/// Modifies a proof in several ways, and returns the number of rejected proofs. All invalid ones must be
/// rejected.
fn count_rejected_proofs(asked: &SceneQuery, proof: &NearestProof) -> Result<u64, String> {
    let changes: [&dyn Fn(&mut NearestProof); 4] = [
        &|proof| proof.lower = proof.lower * 1.001 + 0.001,
        &|proof| proof.lower = f64::NAN,
        &|proof| proof.obstacle = ObstacleId(u64::MAX),
        &|proof| proof.apart.retain(|(one, _)| *one == proof.obstacle),
    ];
    let mut count = 0;
    for (k, change) in changes.into_iter().enumerate() {
        let mut changed = proof.clone();
        change(&mut changed);
        if changed == *proof || (k == 3 && changed.lower == 0.0) {
            continue;
        }
        let refused = asked.verify(&changed).is_err();
        require!(
            refused || k == 3 && boxes_tell(asked, proof),
            "the proof with change {k} is accepted"
        );
        count += u64::from(refused);
    }
    Ok(count)
}

/// Checks whether the boxes exclude all obstacles of a proof, so that it is valid without their entries.
fn boxes_tell(asked: &SceneQuery, proof: &NearestProof) -> bool {
    let mut bare = proof.clone();
    bare.apart.clear();
    asked.verify(&bare).is_ok()
}

/// Returns the bodies from which obstacles of a scene are drawn.
fn draw_bodies(family: &str, random: &mut Random) -> Result<Vec<AnyBody>, String> {
    let cuboid = |low: DVec3, high: DVec3| {
        ConvexPolyhedron::cuboid(low, high).map(AnyBody::from).map_err(|e| error_message(&e))
    };
    let points = |points: &[DVec3]| {
        ConvexPolyhedron::from_points(points).map(AnyBody::from).map_err(|e| error_message(&e))
    };
    let cube = cuboid(DVec3::ZERO, DVec3::ONE)?;
    let mut hull = |count| points(&random_hull(count, random).vertices);
    Ok(match family {
        "rows" | "coincident" => vec![cube, cuboid(DVec3::splat(-0.5), DVec3::new(1.5, 0.5, 0.5))?],
        "hulls" | "far" => vec![hull(4)?, hull(12)?, hull(50)?],
        "thin" => vec![
            cube,
            points(&[DVec3::ZERO])?,
            points(&[DVec3::ZERO, DVec3::X])?,
            points(&[DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(1.0, 1.0, 0.0)])?,
            cuboid(DVec3::ZERO, DVec3::new(1.0, 1.0, 1e-9))?,
        ],
        "rounded" => {
            let corners = random_hull(8, random).vertices;
            let bodies = [
                ConvexPolyhedron::sphere(DVec3::ZERO, 0.5),
                ConvexPolyhedron::capsule([DVec3::ZERO, DVec3::X], 0.25),
                ConvexPolyhedron::from_points(&corners).and_then(|hull| hull.rounded(0.125)),
            ];
            let mut all = vec![cube];
            for body in bodies {
                all.push(body.map_err(|e| error_message(&e))?.into());
            }
            all
        }
        _ => {
            let post = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::new(1.0, 1.0, 2.0));
            let bar = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::new(2.0, 1.0, 1.0));
            let (post, bar) =
                (post.map_err(|e| error_message(&e))?, bar.map_err(|e| error_message(&e))?);
            let step = Solid::from_pieces([&post, &bar]).map_err(|e| error_message(&e))?;
            vec![cube, AnyBody::from(Arc::new(step)), hull(8)?]
        }
    })
}

/// Draws a pose, on a grid in families with ties.
fn place_for(family: &str, random: &mut Random) -> Result<Pose, String> {
    let quarter = DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2);
    let (rotation, at) = match family {
        "rows" => (DQuat::IDENTITY, random.grid(-3, 3) * random.pick(&[0.5, 1.0])),
        "coincident" => (DQuat::IDENTITY, random.grid(0, 1)),
        "thin" if random.one_in(2) => (quarter, random.grid(-2, 2)),
        "thin" => (random.rotation(), random.grid(-2, 2)),
        "far" => (random.rotation(), DVec3::splat(1e6) + random.vector() * 4.0),
        "mixed" | "rounded" if random.one_in(2) => (quarter, random.grid(-3, 3)),
        _ => (random.rotation(), random.vector() * 4.0),
    };
    Pose::new(rotation, at).map_err(|e| error_message(&e))
}

/// Inserts, moves or removes an obstacle.
fn change_scene(
    family: &str,
    bodies: &[AnyBody],
    obstacles: &mut Obstacles,
    ids: &mut Vec<ObstacleId>,
    random: &mut Random,
) -> Result<(), String> {
    let pose = place_for(family, random)?;
    if ids.is_empty() || random.one_in(4) {
        ids.push(obstacles.insert(bodies[random.index(bodies.len())].clone(), pose));
        return Ok(());
    }
    let which = random.index(ids.len());
    if random.one_in(3) {
        let id = ids.remove(which);
        require!(obstacles.remove(id).is_some() && obstacles.remove(id).is_none(), "not removed");
        require!(obstacles.set_pose(id, pose).is_err(), "moved though it has gone");
        return Ok(());
    }
    let moved = if random.one_in(2) {
        obstacles.set_pose(ids[which], pose)
    } else {
        obstacles.set_poses(&ids.iter().take(which + 1).map(|id| (*id, pose)).collect::<Vec<_>>())
    };
    moved.map_err(|e| error_message(&e))
}

/// Builds the pair of two bodies of either kind.
fn build_pair<'a>(
    p: AnyPlaced<'a>,
    q: AnyPlaced<'a>,
) -> Result<ByKind<Pair<'a>, Pair<'a, Solid>>, QueryError> {
    Ok(match (p, q) {
        (ByKind::Convex(p), ByKind::Convex(q)) => ByKind::Convex(Pair::new(p, q)?),
        (ByKind::Convex(p), ByKind::Solid(q)) => ByKind::Solid(Pair::between(p, q)?),
        (ByKind::Solid(p), ByKind::Convex(q)) => ByKind::Solid(Pair::between(p, q)?),
        (ByKind::Solid(p), ByKind::Solid(q)) => ByKind::Solid(Pair::between(p, q)?),
    })
}

/// Returns the distance of two bodies.
fn distance_of(p: AnyPlaced, q: AnyPlaced) -> Result<AnyDistance, QueryError> {
    Ok(match build_pair(p, q)? {
        ByKind::Convex(pair) => ByKind::Convex(pair.distance()?),
        ByKind::Solid(pair) => ByKind::Solid(pair.distance()?),
    })
}

/// Returns whether the bodies are closer than a length, and whether that is undecided.
fn is_within(p: AnyPlaced, q: AnyPlaced, length: f64) -> Result<(bool, bool), QueryError> {
    Ok(match build_pair(p, q)? {
        ByKind::Convex(pair) => match pair.within(length)? {
            Within::Closer(_) => (true, false),
            Within::Farther(_) => (false, false),
            Within::Undecided(_) => (false, true),
        },
        ByKind::Solid(pair) => match pair.within(length)? {
            Within::Closer(_) => (true, false),
            Within::Farther(_) => (false, false),
            Within::Undecided(_) => (false, true),
        },
    })
}

/// Returns the clearance of two bodies.
fn clearance_of(p: AnyPlaced, q: AnyPlaced, d: DVec3) -> Result<AnyClearance, QueryError> {
    Ok(match (p, q) {
        (ByKind::Convex(p), ByKind::Convex(q)) => ByKind::Convex(Cast::new(p, q, d)?.clearance()?),
        (ByKind::Convex(p), ByKind::Solid(q)) => {
            ByKind::Solid(Cast::between(p, q, d)?.clearance()?)
        }
        (ByKind::Solid(p), ByKind::Convex(q)) => {
            ByKind::Solid(Cast::between(p, q, d)?.clearance()?)
        }
        (ByKind::Solid(p), ByKind::Solid(q)) => ByKind::Solid(Cast::between(p, q, d)?.clearance()?),
    })
}

/// Returns the upper bound of the blocking contact; negative infinity for an overlap, infinity if the body is
/// free.
fn upper_of(clearance: &AnyClearance) -> f64 {
    match clearance {
        ByKind::Convex(Clearance::Blocked { contact, .. }) => contact.certificate.upper,
        ByKind::Solid(Clearance::Blocked { contact, .. }) => contact.translation.upper,
        _ if clearance.distance().is_none() => f64::NEG_INFINITY,
        _ => f64::INFINITY,
    }
}

/// Returns the exact squared distance of two convex bodies; `None` for solids and rounded bodies.
fn squared_distance(p: &AnyPlaced, q: &AnyPlaced) -> Option<Ratio> {
    let (ByKind::Convex(p), ByKind::Convex(q)) = (p, q) else { return None };
    if p.body.radius() + q.body.radius() != 0.0 {
        return None;
    }
    let [p, q] =
        [p, q].map(|one| place(one.pose.matrix(), one.pose.translation(), one.body.vertices()));
    Some(distance(&p, &q).square)
}

/// Checks whether a length is at most the root of a square.
fn is_square_below(length: f64, square: &Ratio) -> bool {
    let length = Ratio::from_f64(length);
    length.times(&length) <= *square
}
