//! `among`: compares one body among many with `parry3d-f64`, in one run on the same scenes.
//!
//! Boxes of random sizes and orientations are spread uniformly in a cube and fill a share of it. For parry, the
//! same boxes are a `Compound`, which has its own tree (`Bvh`). Queries place a box at random and cast it along
//! random directions. Both libraries answer each query, in turns. The figures are medians of the times and of
//! the queries' ratios. The time to build a scene is processor time of the thread, the mean of nine builds.
//! Then boxes move, slightly and anywhere, and the queries are repeated.
//!
//! `--points N` drops a point and a ball on the N points of a scan instead, and counts the boxes that are visited and
//! the points that are queried. *cube* is the number of points that the cube around the ball does not exclude: those
//! that a proof names.

use std::process::ExitCode;
use std::sync::Arc;

use clap::Args;
use colltrans::{ConvexPolyhedron, ObstacleId, Obstacles, Pose, SceneQuery};
use colltrans_bench::harness::{self, Failure, Run};
use colltrans_bench::parry::{self, ParrySetting};
use colltrans_bench::times::{Clock, Comparison, Times};
use colltrans_testkit::random::Random;
use glam::DVec3;
use parry3d_f64::shape::{Compound, Cuboid};
use serde_json::{Value, json};

const SIZES: [usize; 4] = [100, 1_000, 10_000, 100_000];

/// Number of different boxes.
const SHAPE_COUNT: usize = 16;

/// Number of builds of a scene.
const BUILD_REPETITIONS: u32 = 9;

/// Share of space filled by boxes.
const FILLED_SHARE: f64 = 0.02;

/// Threshold of the proximity query, a length: about that of a box.
const PROXIMITY: f64 = 0.5;

fn main() -> ExitCode {
    let about = "Compares one body among many boxes with parry3d-f64; prints a table";
    harness::run("among", about, |run, own: &OwnArguments| {
        if let Some(points) = own.points {
            let columns = "points:>9; body:<6; radius:>8; cast us:>8.1=ns ÷ 1e3 us; boxes:>7; queried:>8; cube:>7;
                nearest us:>11.1=nearest_ns ÷ 1e3 us; queried:>8=nearest_queried";
            run.table("medians", columns);
            return measure_drops(points, run);
        }
        let columns = "boxes:>9; build ms:>8.2=build_ms; parry:>8.2=parry_build_ms;
            nearest:>8.0=nearest/0; parry:>8.0=nearest/1; ratio:>8.2=nearest/2;
            cast:>8.0=cast/0; parry:>8.0=cast/1; ratio:>8.2=cast/2;
            within:>8.0; move:>8.0; nearest:>8.0=nearest_after; wrong:>8";
        run.table("", columns);
        run.sizes(&SIZES).into_iter().for_each(|n| run.add(measure_row(n, run)));
        Ok(())
    })
}

#[derive(Debug, Args)]
struct OwnArguments {
    /// Drop a point and balls on a scan of N points instead
    #[arg(long, value_name = "N")]
    points: Option<usize>,
}

/// Radii of balls that are dropped on a scan; 0 stands for a point.
const RADII: [f64; 4] = [0.0, 0.01, 0.05, 0.25];

/// Measures drops on a scan of a wavy square with sides of 2.
fn measure_drops(count: usize, run: &mut Run) -> Result<(), Failure> {
    let random = &mut run.random(&[count as u64, 0x5ca]);
    let point = Arc::new(ConvexPolyhedron::from_points(&[DVec3::ZERO])?);
    let on_scan = |[x, y, _]: [f64; 3]| {
        let height = 0.1 * (5.0 * x).sin() * (4.0 * y).cos();
        Pose::from_translation(DVec3::new(x, y, height))
    };
    let scan = (0..count).map(|_| on_scan(random.vector().to_array()));
    let scan = scan.collect::<Result<Vec<Pose>, _>>()?;
    let mut obstacles = Obstacles::new();
    obstacles.insert_all(scan.into_iter().map(|pose| (point.clone(), pose)));
    for radius in RADII {
        let ball = ConvexPolyhedron::sphere(DVec3::ZERO, radius)?;
        let [mut times, mut boxes, mut queried, mut cube] = <[Times; 4]>::default();
        let [mut nearest_times, mut nearest_queried] = <[Times; 2]>::default();
        for _ in 0..run.choose(100, 1_000) {
            let at = random.vector() * 0.9;
            let start = Pose::from_translation(DVec3::new(at.x, at.y, 1.0))?;
            let direction = DVec3::new(0.25 * at.z, 0.125, -1.0);
            let query = SceneQuery::new(ball.at(start), &obstacles)?;
            let (found, spent) = Clock::new(1).time(|| query.clearance(direction));
            let steps = found?.steps;
            times.add(spent);
            boxes.add(f64::from(steps.boxes));
            queried.add(f64::from(steps.bodies));
            cube.add(query.certified_clearance(direction)?.1.passed.len() as f64);
            let (nearest, spent) = Clock::new(1).time(|| query.nearest());
            nearest_times.add(spent);
            nearest_queried.add(nearest?.map_or(0.0, |nearest| f64::from(nearest.steps.bodies)));
        }
        run.add(json!({
            "points": count, "body": if radius == 0.0 { "point" } else { "ball" }, "radius": radius,
            "ns": times.median(), "boxes": boxes.median(), "queried": queried.median(), "cube": cube.median(),
            "nearest_ns": nearest_times.median(), "nearest_queried": nearest_queried.median(),
        }));
    }
    Ok(())
}

/// A scene, for both libraries.
struct Scene {
    side: f64,
    shapes: Vec<Arc<ConvexPolyhedron>>,
    halves: Vec<DVec3>,
    poses: Vec<Pose>,
}

impl Scene {
    fn draw(n: usize, random: &mut Random) -> Self {
        let halves: Vec<DVec3> =
            (0..SHAPE_COUNT).map(|_| random.vector().abs() * 0.4 + DVec3::splat(0.1)).collect();
        let cuboid = |half: &DVec3| ConvexPolyhedron::cuboid(-*half, *half).expect("a box");
        let volume = |k: usize| 8.0 * halves[k % SHAPE_COUNT].element_product();
        let side = ((0..n).map(volume).sum::<f64>() / FILLED_SHARE).cbrt();
        let poses = (0..n).map(|_| random_pose(side, random)).collect();
        let shapes = halves.iter().map(|half| Arc::new(cuboid(half))).collect();
        Self { side, shapes, halves, poses }
    }

    /// Builds the scene in this library.
    fn ours(&self) -> (Obstacles, Vec<ObstacleId>) {
        let mut obstacles = Obstacles::new();
        let body = |k: usize| self.shapes[k % SHAPE_COUNT].clone();
        let ids =
            obstacles.insert_all(self.poses.iter().enumerate().map(|(k, pose)| (body(k), *pose)));
        (obstacles, ids)
    }

    /// Builds the scene in parry.
    fn theirs(&self) -> Compound {
        parry::compound(&self.poses, |k| self.halves[k % SHAPE_COUNT])
    }
}

/// Draws a pose in a cube.
fn random_pose(side: f64, random: &mut Random) -> Pose {
    let at = (random.vector() * 0.5 + DVec3::splat(0.5)) * side;
    Pose::new(random.rotation(), at).expect("a pose")
}

/// Measures the row of a size.
fn measure_row(n: usize, run: &Run) -> Value {
    let count = run.choose(200, 2_000);
    let random = &mut run.random(&[n as u64]);
    let clock = Clock::new(1);
    let scene = Scene::draw(n, random);
    let (mut obstacles, ids) = scene.ours();
    let compound = scene.theirs();
    let build = |build: &dyn Fn()| {
        own_time(clock, || (0..BUILD_REPETITIONS).for_each(|_| build()))
            / f64::from(BUILD_REPETITIONS)
            / 1e6
    };
    let ours = build(&|| drop(scene.ours()));
    let theirs = build(&|| drop(scene.theirs()));
    let mut asked = QueryRunner { scene: &scene, clock, random, wrong: 0 };
    let [nearest, cast] = asked.beside(&obstacles, &compound, count);
    let within = asked.median(count, &obstacles, |asked| asked.within(PROXIMITY).is_ok());
    let moves = asked.moves(&mut obstacles, &ids, count);
    let after = asked.median(count, &obstacles, |asked| asked.nearest().is_ok());
    json!({
        "boxes": n, "build_ms": ours, "parry_build_ms": theirs, "nearest": nearest.medians(),
        "cast": cast.medians(), "within": within, "move": moves, "nearest_after": after,
        "wrong": asked.wrong,
    })
}

/// Returns the processor time of this thread for some work, in nanoseconds. Other programs do not
/// count, except on systems that only report wall-clock time.
fn own_time(clock: Clock, work: impl FnMut()) -> f64 {
    let (before, ((), wall)) = (on_processor(), clock.time(work));
    before.zip(on_processor()).map_or(wall, |(before, after)| after - before)
}

/// Returns the processor time of this thread until now, where the system reports it.
fn on_processor() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    stat.split(' ').next()?.parse().ok()
}

/// Queries on a scene.
struct QueryRunner<'a> {
    scene: &'a Scene,
    clock: Clock,
    random: &'a mut Random,
    /// Number of parry's answers outside our bounds by more than a millionth.
    wrong: u32,
}

impl QueryRunner<'_> {
    /// Measures nearest bodies and casts in both libraries.
    fn beside(
        &mut self,
        obstacles: &Obstacles,
        compound: &Compound,
        count: usize,
    ) -> [Comparison; 2] {
        let [mut nearest, mut casts] = <[Comparison; 2]>::default();
        let (shape, half) = (&self.scene.shapes[0], self.scene.halves[0]);
        let cuboid = Cuboid::new(parry::convert_vector(half));
        for _ in 0..count {
            let pose = random_pose(self.scene.side, self.random);
            let direction = self.random.direction();
            let setting = ParrySetting::from_poses([&pose, &Pose::IDENTITY], direction);
            let (ours, other) = nearest.compare_query(
                self.clock,
                || SceneQuery::new(shape.at(pose), obstacles).and_then(|a| a.nearest()),
                || setting.distance(&cuboid, compound),
            );
            let ours = ours.expect("an answer").expect("there are some");
            let is_off = |x: f64| x < ours.lower - 1e-6 || x > ours.distance.upper() + 1e-6;
            self.wrong += u32::from(other.is_none_or(is_off));
            let (ours, _) = casts.compare_query(
                self.clock,
                || SceneQuery::new(shape.at(pose), obstacles).and_then(|a| a.clearance(direction)),
                || setting.cast(&cuboid, compound),
            );
            assert!(ours.is_ok(), "an answer");
        }
        [nearest, casts]
    }

    /// Returns the median time of a query.
    fn median(
        &mut self,
        count: usize,
        obstacles: &Obstacles,
        ask: impl Fn(&SceneQuery) -> bool,
    ) -> f64 {
        let mut times = Times::default();
        for _ in 0..count {
            let pose = random_pose(self.scene.side, self.random);
            let shape = &self.scene.shapes[0];
            let question = || SceneQuery::new(shape.at(pose), obstacles).is_ok_and(|a| ask(&a));
            let (answered, spent) = self.clock.time(question);
            assert!(answered, "an answer");
            times.add(spent);
        }
        times.median()
    }

    /// Moves boxes, half of them by a tenth of a box and half anywhere, at least as often as there are boxes.
    /// Returns the mean time of a move.
    fn moves(&mut self, obstacles: &mut Obstacles, ids: &[ObstacleId], count: usize) -> f64 {
        let moves: Vec<(ObstacleId, Pose)> = (0..count.max(ids.len()))
            .map(|k| {
                let id = ids[self.random.index(ids.len())];
                let pose = obstacles.get(id).expect("it is there").1;
                let by = self.random.vector() * 0.1;
                let near = pose.translated_by(by).expect("a pose");
                (id, if k % 2 == 0 { near } else { random_pose(self.scene.side, self.random) })
            })
            .collect();
        let set = || {
            for (id, pose) in &moves {
                obstacles.set_pose(*id, *pose).expect("it is there");
            }
        };
        own_time(self.clock, set) / moves.len() as f64
    }
}
