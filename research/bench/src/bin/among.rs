//! `among`: one body among many beside `parry3d-f64`, in the same run on the same scenes.
//!
//! Boxes of random sizes and orientations, evenly in a cube with a share of it filled; the same boxes are a
//! `Compound` of parry's, which has a tree of its own (`Bvh`). A box is asked about at random places, along
//! random directions. Both answer each query, in turns; figures are medians of times and of the queries' ratios,
//! of building the thread's own time on a processor, the mean of nine.
//! Then boxes move, a little and anywhere, and queries are asked again.

use std::process::ExitCode;
use std::sync::Arc;

use colltrans::{Among, ConvexPolyhedron, ObstacleId, Obstacles, Pose};
use colltrans_bench::harness::{self, Run};
use colltrans_bench::parry::{self, ParrySetting};
use colltrans_bench::times::{Beside, Clock, Times};
use colltrans_testkit::random::Random;
use glam::DVec3;
use parry3d_f64::shape::{Compound, Cuboid};
use serde_json::{Value, json};

const SIZES: [usize; 4] = [100, 1_000, 10_000, 100_000];

/// How many different boxes there are.
const SHAPES: usize = 16;

/// How often a scene is built.
const BUILDS: u32 = 9;

/// The share of space that boxes fill.
const FILLED: f64 = 0.02;

/// Bodies closer than this are asked for, a length: about that of a box.
const CLOSE: f64 = 0.5;

fn main() -> ExitCode {
    let about = "Measures one body among many boxes beside parry3d-f64; prints a table";
    harness::run("among", about, |run, (): &()| {
        let columns = "boxes:>9; build ms:>8.2=build_ms; parry:>8.2=parry_build_ms;
            nearest:>8.0=nearest/0; parry:>8.0=nearest/1; ratio:>8.2=nearest/2;
            cast:>8.0=cast/0; parry:>8.0=cast/1; ratio:>8.2=cast/2;
            within:>8.0; move:>8.0; nearest:>8.0=nearest_after; wrong:>8";
        run.table("", columns);
        run.sizes(&SIZES).into_iter().for_each(|n| run.add(row(n, run)));
        Ok(())
    })
}

/// A scene, for both.
struct Scene {
    side: f64,
    shapes: Vec<Arc<ConvexPolyhedron>>,
    halves: Vec<DVec3>,
    poses: Vec<Pose>,
}

impl Scene {
    fn draw(n: usize, random: &mut Random) -> Self {
        let halves: Vec<DVec3> =
            (0..SHAPES).map(|_| random.vector().abs() * 0.4 + DVec3::splat(0.1)).collect();
        let cuboid = |half: &DVec3| ConvexPolyhedron::cuboid(-*half, *half).expect("a box");
        let volume = |k: usize| 8.0 * halves[k % SHAPES].element_product();
        let side = ((0..n).map(volume).sum::<f64>() / FILLED).cbrt();
        let poses = (0..n).map(|_| anywhere(side, random)).collect();
        let shapes = halves.iter().map(|half| Arc::new(cuboid(half))).collect();
        Self { side, shapes, halves, poses }
    }

    fn ours(&self) -> (Obstacles, Vec<ObstacleId>) {
        let mut obstacles = Obstacles::new();
        let body = |k: usize| self.shapes[k % SHAPES].clone();
        let ids =
            obstacles.insert_all(self.poses.iter().enumerate().map(|(k, pose)| (body(k), *pose)));
        (obstacles, ids)
    }

    fn theirs(&self) -> Compound {
        parry::compound(&self.poses, |k| self.halves[k % SHAPES])
    }
}

fn anywhere(side: f64, random: &mut Random) -> Pose {
    let at = (random.vector() * 0.5 + DVec3::splat(0.5)) * side;
    Pose::new(random.rotation(), at).expect("a pose")
}

fn row(n: usize, run: &Run) -> Value {
    let count = run.choose(200, 2_000);
    let random = &mut run.random(&[n as u64]);
    let clock = Clock::new(1);
    let scene = Scene::draw(n, random);
    let (mut obstacles, ids) = scene.ours();
    let compound = scene.theirs();
    let build = |build: &dyn Fn()| {
        own_time(clock, || (0..BUILDS).for_each(|_| build())) / f64::from(BUILDS) / 1e6
    };
    let ours = build(&|| drop(scene.ours()));
    let theirs = build(&|| drop(scene.theirs()));
    let mut asked = Asked { scene: &scene, clock, random, wrong: 0 };
    let [nearest, cast] = asked.beside(&obstacles, &compound, count);
    let within = asked.median(count, &obstacles, |asked| asked.within(CLOSE).is_ok());
    let moves = asked.moves(&mut obstacles, &ids, count);
    let after = asked.median(count, &obstacles, |asked| asked.nearest().is_ok());
    json!({
        "boxes": n, "build_ms": ours, "parry_build_ms": theirs, "nearest": nearest.medians(),
        "cast": cast.medians(), "within": within, "move": moves, "nearest_after": after,
        "wrong": asked.wrong,
    })
}

/// Returns for how long this thread is on a processor with some work, in nanoseconds; others are on the machine as well.
fn own_time(clock: Clock, work: impl FnMut()) -> f64 {
    let (before, ((), wall)) = (on_processor(), clock.time(work));
    before.zip(on_processor()).map_or(wall, |(before, after)| after - before)
}

/// Returns for how long this thread has been on a processor, where the system tells.
fn on_processor() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    stat.split(' ').next()?.parse().ok()
}

/// Who asks.
struct Asked<'a> {
    scene: &'a Scene,
    clock: Clock,
    random: &'a mut Random,
    /// Answers of parry's that are not between our bounds, by more than a millionth.
    wrong: u32,
}

impl Asked<'_> {
    /// Nearest ones and casts, beside parry.
    fn beside(&mut self, obstacles: &Obstacles, compound: &Compound, count: usize) -> [Beside; 2] {
        let [mut nearest, mut casts] = <[Beside; 2]>::default();
        let (shape, half) = (&self.scene.shapes[0], self.scene.halves[0]);
        let cuboid = Cuboid::new(parry::vector(half));
        for _ in 0..count {
            let pose = anywhere(self.scene.side, self.random);
            let direction = self.random.direction();
            let setting = ParrySetting::placed([&pose, &Pose::IDENTITY], direction);
            let (ours, other) = nearest.ask(
                self.clock,
                || Among::new(shape.at(pose), obstacles).and_then(|a| a.nearest()),
                || setting.distance(&cuboid, compound),
            );
            let ours = ours.expect("an answer").expect("there are some");
            let is_off = |x: f64| x < ours.lower - 1e-6 || x > ours.distance.upper() + 1e-6;
            self.wrong += u32::from(other.is_none_or(is_off));
            let (ours, _) = casts.ask(
                self.clock,
                || Among::new(shape.at(pose), obstacles).and_then(|a| a.clearance(direction)),
                || setting.cast(&cuboid, compound),
            );
            assert!(ours.is_ok(), "an answer");
        }
        [nearest, casts]
    }

    fn median(&mut self, count: usize, obstacles: &Obstacles, ask: impl Fn(&Among) -> bool) -> f64 {
        let mut times = Times::default();
        for _ in 0..count {
            let pose = anywhere(self.scene.side, self.random);
            let shape = &self.scene.shapes[0];
            let question = || Among::new(shape.at(pose), obstacles).is_ok_and(|a| ask(&a));
            let (answered, spent) = self.clock.time(question);
            assert!(answered, "an answer");
            times.add(spent);
        }
        times.median()
    }

    /// Moves, half of them by a tenth of a box and half anywhere: as many as there are boxes, at least; the
    /// mean time of one.
    fn moves(&mut self, obstacles: &mut Obstacles, ids: &[ObstacleId], count: usize) -> f64 {
        let moves: Vec<(ObstacleId, Pose)> = (0..count.max(ids.len()))
            .map(|k| {
                let id = ids[self.random.index(ids.len())];
                let pose = obstacles.get(id).expect("it is there").1;
                let by = self.random.vector() * 0.1;
                let near = pose.translated(by).expect("a pose");
                (id, if k % 2 == 0 { near } else { anywhere(self.scene.side, self.random) })
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
