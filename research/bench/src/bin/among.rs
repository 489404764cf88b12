//! `among`: one body among many beside `parry3d-f64`, in the same run on the same scenes.
//!
//! Boxes of random sizes and orientations, evenly in a cube with a share of it filled; the same boxes are a
//! `Compound` of parry's, which has a tree of its own (`Bvh`). A box is asked about at random places, along
//! random directions. Both answer each query, in turns; figures are medians of times and of the queries' ratios,
//! of building the thread's own time on a processor, the mean of nine.
//! Then boxes move, a little and anywhere, and queries are asked again.

use std::process::ExitCode;
use std::sync::Arc;

use clap::Parser;
use colltrans::{Among, ConvexPolyhedron, ObstacleId, Obstacles, Pose};
use colltrans_bench::arguments::Arguments;
use colltrans_bench::parry::{self, ParrySetting};
use colltrans_bench::report::{self, Times};
use colltrans_testkit::random::Random;
use colltrans_testkit::timing::Stopwatch;
use glam::DVec3;
use parry3d_f64::shape::{Compound, Cuboid};
use serde_json::{Value, json};

/// Measures one body among many boxes beside parry3d-f64; prints a table
#[derive(Debug, Parser)]
struct Command {
    #[command(flatten)]
    arguments: Arguments,
}

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
    let Command { arguments } = Command::parse();
    let count = if arguments.quick { 200 } else { 2_000 };
    let mut rows = Vec::new();
    let names =
        ["boxes", "build ms", "parry", "nearest", "parry", "ratio", "cast", "parry", "ratio"];
    let more = ["within", "move", "nearest", "wrong"];
    let heads: Vec<String> =
        names.into_iter().chain(more).map(|name| format!("{name:>9}")).collect();
    println!("{}", heads.concat());
    for &n in arguments.sizes.as_deref().unwrap_or(&SIZES) {
        rows.push(row(n, count, arguments.seed));
    }
    report::write("among", &arguments, &rows)
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
}

fn anywhere(side: f64, random: &mut Random) -> Pose {
    let at = (random.vector() * 0.5 + DVec3::splat(0.5)) * side;
    Pose::new(random.rotation(), at).expect("a pose")
}

/// The times of one kind of query.
#[derive(Default)]
struct Beside {
    ours: Times,
    parry: Times,
    ratio: Times,
}

impl Beside {
    fn add(&mut self, ours: f64, parry: f64) {
        self.ours.add(ours);
        self.parry.add(parry);
        self.ratio.add(parry / ours);
    }

    fn medians(&mut self) -> [f64; 3] {
        [&mut self.ours, &mut self.parry, &mut self.ratio].map(|times| {
            times.sort();
            times.median()
        })
    }
}

fn row(n: usize, count: usize, seed: u64) -> Value {
    let random = &mut Random::stream(seed, &[n as u64]);
    let stopwatch = Stopwatch::new();
    let scene = Scene::draw(n, random);
    let (obstacles, ids) = scene.ours();
    let compound = parry::compound(&scene.poses, |k| scene.halves[k % SHAPES]);
    let ours = spent(stopwatch, || drop(scene.ours())) / 1e6;
    let parrys = || drop(parry::compound(&scene.poses, |k| scene.halves[k % SHAPES]));
    let theirs = spent(stopwatch, parrys) / 1e6;
    let mut obstacles = obstacles;
    let mut asked = Asked { scene: &scene, stopwatch, random, wrong: 0 };
    let [mut nearest, mut cast] = asked.beside(&obstacles, &compound, count);
    let within = asked.within(&obstacles, count);
    let moves = asked.moves(&mut obstacles, &ids, count);
    let after = asked.nearest(&obstacles, count);
    let wrong = asked.wrong;
    let (nearest, cast) = (nearest.medians(), cast.medians());
    println!(
        "{n:>9}{:>9.2}{:>9.2}{:>9.0}{:>9.0}{:>9.2}{:>9.0}{:>9.0}{:>9.2}{within:>9.0}{moves:>9.0}{after:>9.0}{wrong:>9}",
        ours, theirs, nearest[0], nearest[1], nearest[2], cast[0], cast[1], cast[2],
    );
    json!({
        "boxes": n, "build_ms": ours, "parry_build_ms": theirs,
        "nearest": nearest, "cast": cast, "within": within, "move": moves, "nearest_after": after,
        "wrong": wrong,
    })
}

/// What a thread does in nanoseconds on a processor, the mean of nine times: others are on the machine as well.
fn spent(stopwatch: Stopwatch, work: impl Fn()) -> f64 {
    let all = || (0..BUILDS).for_each(|_| work());
    let (before, ((), wall)) = (on_processor(), stopwatch.time(all));
    let own = before.zip(on_processor()).map(|(before, after)| after - before);
    own.unwrap_or(wall) / f64::from(BUILDS)
}

/// For how long this thread has been on a processor, where the system tells.
fn on_processor() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    stat.split(' ').next()?.parse().ok()
}

/// Who asks.
struct Asked<'a> {
    scene: &'a Scene,
    stopwatch: Stopwatch,
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
            let (ours, spent) = self
                .stopwatch
                .time(|| Among::new(shape.at(pose), obstacles).and_then(|a| a.nearest()));
            let (other, theirs) = self.stopwatch.time(|| setting.distance(&cuboid, compound));
            nearest.add(spent, theirs);
            let ours = ours.expect("an answer").expect("there are some");
            let is_off = |x: f64, [lower, upper]: [f64; 2]| x < lower - 1e-6 || x > upper + 1e-6;
            let bounds = [ours.lower, ours.distance.upper()];
            self.wrong += u32::from(other.is_none_or(|x| is_off(x, bounds)));
            let (ours, spent) = self.stopwatch.time(|| {
                Among::new(shape.at(pose), obstacles).and_then(|a| a.clearance(direction))
            });
            let (_, theirs) = self.stopwatch.time(|| setting.cast(&cuboid, compound));
            assert!(ours.is_ok(), "an answer");
            casts.add(spent, theirs);
        }
        [nearest, casts]
    }

    fn nearest(&mut self, obstacles: &Obstacles, count: usize) -> f64 {
        self.median(count, |asked| asked.nearest().is_ok(), obstacles)
    }

    fn within(&mut self, obstacles: &Obstacles, count: usize) -> f64 {
        self.median(count, |asked| asked.within(CLOSE).is_ok(), obstacles)
    }

    fn median(&mut self, count: usize, ask: impl Fn(&Among) -> bool, obstacles: &Obstacles) -> f64 {
        let mut times = Times::default();
        for _ in 0..count {
            let pose = anywhere(self.scene.side, self.random);
            let shape = &self.scene.shapes[0];
            let question = || Among::new(shape.at(pose), obstacles).is_ok_and(|a| ask(&a));
            let (answered, spent) = self.stopwatch.time(question);
            assert!(answered, "an answer");
            times.add(spent);
        }
        times.sort();
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
        let set = || moves.iter().try_for_each(|(id, pose)| obstacles.set_pose(*id, *pose));
        let (before, (moved, wall)) = (on_processor(), self.stopwatch.time(set));
        moved.expect("they are there");
        let own = before.zip(on_processor()).map(|(before, after)| after - before);
        own.unwrap_or(wall) / moves.len() as f64
    }
}
