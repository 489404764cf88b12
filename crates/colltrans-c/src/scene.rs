//! Scenes: one body against many placed ones.

use colltrans::{ByKind, ObstacleId, Obstacles, SceneQuery, UnknownObstacle};

use crate::COLLTRANS_NO_OBSTACLE;
use crate::answer::{CastAnswer, DistanceAnswer};
use crate::body::{Body, Pose, pose};
use crate::cast::CastOptions;
use crate::error::{
    Failure, Fallible, OfArgument, Output, Status, array, check_room, exclusive, free, guard,
    reference, vector,
};

/// Placed bodies, the obstacles of a moving body. Any number of threads may query a scene while none changes it.
pub struct Scene(Obstacles);

/// Arguments of all queries about a body in a scene.
#[derive(Clone, Copy)]
pub(crate) struct SceneArguments {
    pub(crate) scene: *const Scene,
    pub(crate) body: *const Body,
    pub(crate) pose: *const Pose,
    pub(crate) ignored: *const u64,
    pub(crate) ignored_count: usize,
}

impl SceneArguments {
    /// Runs a query.
    pub(crate) unsafe fn query<T>(
        self,
        options: &CastOptions,
        query: impl FnOnce(&SceneQuery<'_>) -> Fallible<T>,
    ) -> Fallible<T> {
        // SAFETY: the caller keeps the invariants of the crate.
        unsafe {
            let scene = reference(self.scene, "scene")?;
            let placed = reference(self.body, "body")?.body.at(pose(self.pose, "pose")?);
            let ignored = array(self.ignored, self.ignored_count, "ignored")?;
            let is_ignored = |id: ObstacleId| ignored.contains(&id.0);
            // The end of the query holds for all obstacles together.
            let solid = CastOptions { has_before: 0, ..*options }.solid()?;
            let scene_query = SceneQuery::new(placed, &scene.0)?
                .ignoring(&is_ignored)
                .with_options(options.convex()?)?
                .with_solid_options(solid);
            query(&scene_query)
        }
    }
}

fn unknown_obstacle(id: u64) -> Failure {
    let what =
        format_args!("the scene has no obstacle {id}; it was never inserted, or was removed");
    Failure::invalid("obstacle", what)
}

/// Builds an empty scene.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_scene_new(scene: *mut *mut Scene) -> Status {
    guard(|| unsafe {
        Output::new(scene, "scene")?.set_handle(Scene(Obstacles::new()));
        Ok(())
    })
}

/// Frees a scene; null is accepted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_scene_free(scene: *mut Scene) {
    unsafe { free(scene) }
}

/// Inserts a body at a pose, and writes the number of the new obstacle. The body may be freed afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_scene_insert(
    scene: *mut Scene,
    body: *const Body,
    pose: *const Pose,
    obstacle: *mut u64,
) -> Status {
    guard(|| unsafe {
        let obstacle = Output::new(obstacle, "obstacle")?;
        let pose = self::pose(pose, "pose")?;
        let body = reference(body, "body")?.body.clone();
        obstacle.set(exclusive(scene, "scene")?.0.insert(body, pose).0);
        Ok(())
    })
}

/// Moves an obstacle to another pose.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_scene_set_pose(
    scene: *mut Scene,
    obstacle: u64,
    pose: *const Pose,
) -> Status {
    guard(|| unsafe {
        let pose = self::pose(pose, "pose")?;
        let set = exclusive(scene, "scene")?.0.set_pose(ObstacleId(obstacle), pose);
        set.map_err(|_: UnknownObstacle| unknown_obstacle(obstacle))
    })
}

/// Removes an obstacle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_scene_remove(scene: *mut Scene, obstacle: u64) -> Status {
    guard(|| unsafe {
        let removed = exclusive(scene, "scene")?.0.remove(ObstacleId(obstacle));
        removed.map(|_| ()).ok_or_else(|| unknown_obstacle(obstacle))
    })
}

/// Writes the number of obstacles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_scene_size(scene: *const Scene, size: *mut usize) -> Status {
    guard(|| unsafe {
        let size = Output::new(size, "size")?;
        size.set(reference(scene, "scene")?.0.len());
        Ok(())
    })
}

/// Finds the obstacle that is nearest to a body. `lower` and the outcome hold for all obstacles together, and the
/// features are unknown. Without obstacles, writes `COLLTRANS_NO_OBSTACLE`, the outcome `COLLTRANS_APART` and infinite
/// bounds.
///
/// `ignored` lists obstacles that the query leaves out, for example the parts of a gripper.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_scene_nearest(
    scene: *const Scene,
    body: *const Body,
    pose: *const Pose,
    ignored: *const u64,
    ignored_count: usize,
    obstacle: *mut u64,
    answer: *mut DistanceAnswer,
) -> Status {
    guard(|| unsafe {
        let (obstacle, answer) =
            (Output::new(obstacle, "obstacle")?, Output::new(answer, "answer")?);
        let arguments = SceneArguments { scene, body, pose, ignored, ignored_count };
        let nearest = arguments.query(&CastOptions::DEFAULT, |query| Ok(query.nearest()?))?;
        let (id, found) = match &nearest {
            Some(nearest) => {
                let answer = DistanceAnswer::of_any(&nearest.distance, nearest.lower);
                (nearest.obstacle.0, answer)
            }
            None => (COLLTRANS_NO_OBSTACLE, DistanceAnswer::infinite()),
        };
        obstacle.set(id);
        answer.set(found);
        Ok(())
    })
}

/// Finds the obstacles that are closer to a body than a length. Writes the numbers of the closer ones and then of those
/// that rounding cannot decide, at most `capacity` in all, and how many there are of each.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_scene_within(
    scene: *const Scene,
    body: *const Body,
    pose: *const Pose,
    length: f64,
    ignored: *const u64,
    ignored_count: usize,
    obstacles: *mut u64,
    capacity: usize,
    closer_count: *mut usize,
    undecided_count: *mut usize,
) -> Status {
    guard(|| unsafe {
        let closer_count = Output::new(closer_count, "closer_count")?;
        let undecided_count = Output::new(undecided_count, "undecided_count")?;
        if capacity > 0 {
            check_room(obstacles, capacity, "obstacles")?;
        }
        let arguments = SceneArguments { scene, body, pose, ignored, ignored_count };
        let near = arguments.query(&CastOptions::DEFAULT, |query| Ok(query.within(length)?))?;
        let closer = near.closer.iter().map(|(id, _)| id.0);
        let all = closer.chain(near.undecided.iter().map(|(id, _)| id.0));
        all.take(capacity).enumerate().for_each(|(k, id)| obstacles.add(k).write(id));
        closer_count.set(near.closer.len());
        undecided_count.set(near.undecided.len());
        Ok(())
    })
}

/// Finds how far a body can move along a direction, and the obstacle that stops it, or `COLLTRANS_NO_OBSTACLE`.
/// `distance` holds for all obstacles together, the other numbers for this obstacle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_scene_clearance(
    scene: *const Scene,
    body: *const Body,
    pose: *const Pose,
    direction: *const f64,
    options: *const CastOptions,
    ignored: *const u64,
    ignored_count: usize,
    obstacle: *mut u64,
    answer: *mut CastAnswer,
) -> Status {
    guard(|| unsafe {
        let (obstacle, answer) =
            (Output::new(obstacle, "obstacle")?, Output::new(answer, "answer")?);
        let direction = vector(direction, "direction")?;
        let options = CastOptions::read(options)?;
        let end = options.before()?.unwrap_or(f64::INFINITY);
        let arguments = SceneArguments { scene, body, pose, ignored, ignored_count };
        let (id, found) = arguments.query(options, |query| {
            let found = query.clearance_before(direction, end).of("direction, options")?;
            let distance = found.safe_translation().unwrap_or(f64::NAN);
            let Some((id, clearance)) = &found.stop else {
                return Ok((COLLTRANS_NO_OBSTACLE, CastAnswer::free(distance)));
            };
            let cast = query.cast_with(*id, direction).ok_or_else(|| unknown_obstacle(id.0))?;
            let featured = options.features != 0;
            let mut answer = CastAnswer::NONE;
            match (clearance, &cast) {
                (ByKind::Convex(of), ByKind::Convex(cast)) => {
                    answer.set_clearance(of, cast, featured);
                }
                (ByKind::Solid(of), ByKind::Solid(cast)) => answer.set_solid_clearance(of, cast),
                // The library answers in the kind of the cast.
                _ => {}
            }
            Ok((id.0, CastAnswer { distance, ..answer }))
        })?;
        obstacle.set(id);
        answer.set(found);
        Ok(())
    })
}
