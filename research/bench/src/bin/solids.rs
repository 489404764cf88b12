//! `solids`: meshes that are not convex, beside `parry3d-f64`'s cast of two triangle meshes.
//!
//! Four groups. *Pairs*: random rotations and directions, the moving mesh starting beside the fixed
//! one. *Convex*: the same of convex bodies, beside the cast of convex polyhedra as well. *Growth*: the same bumpy ball in more and more facets. *Flat*: two slabs, of few facets or many in one
//! plane, resting, sliding, parting, with a gap, and passing over each other. Of all each query is timed
//! alone, both libraries on the same settings, fifty at a time in turns: a query of a library behind one of the other
//! would find the caches full of the other's.
//!
//! A pair starts in four ways. *Far*: the moving mesh is 1.05 times the sum of the radii before the fixed
//! one, up to 0.7 times it aside, whether they meet or not. *Near*: of these settings those that meet,
//! the moving mesh put forward to [`NEAR`] times the sum before it meets the fixed one. *Near miss*: those
//! that meet, started as far, the moving mesh put aside along a random axis until it misses the fixed one
//! by at most [`MISS`] times the sum, found by halving between none and twice the sum. *Touching*: put forward until it
//! meets the fixed one, and by [`SUNK`] times the sum more.

use std::process::ExitCode;

use clap::Parser;
use colltrans::solid::{SolidCast, Workspace};
use colltrans::{Cast, Clearance, ConvexPolyhedron, Pose, Solid};
use colltrans_bench::arguments::Arguments;
use colltrans_bench::meshes::{MeshArguments, solid};
use colltrans_bench::parry::{ParrySetting, triangle_mesh};
use colltrans_bench::report::{self, Times};
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::{Mesh, ring_sphere};
use colltrans_testkit::solids::{bolt, bumpy_ball, perforated_plate, slab};
use colltrans_testkit::timing::Stopwatch;
use glam::{DQuat, DVec3};
use serde_json::{Value, json};

/// Measures solids and parry3d-f64's triangle meshes on the same settings; prints a table
#[derive(Debug, Parser)]
struct Command {
    #[command(flatten)]
    arguments: Arguments,
    #[command(flatten)]
    meshes: MeshArguments,
}

/// Two answers agree when they differ by less than this share of the bodies' size.
const AGREEMENT: f64 = 1e-4;
/// Shares of the sum of the radii: how far before they meet bodies start that start near, and the most by
/// which they miss each other narrowly.
const NEAR: f64 = 0.02;
const MISS: f64 = 0.01;
/// The same: how deep bodies overlap that touch.
const SUNK: f64 = 1e-6;
/// Queries of one library in a row.
const BLOCK: usize = 50;

fn main() -> ExitCode {
    let command = Command::parse();
    let mut rows = Vec::new();
    println!(
        "{:<48} {:>9} {:>11} {:>11} {:>9} {:>11} {:>8} {:>5}",
        "what", "facets", "ours", "mean", "p99", "parry", "ratio", "hits"
    );
    for pair in pairs(&command) {
        for start in Start::ALL {
            rows.push(pair.measure(&command.arguments, start));
        }
    }
    if command.meshes.wants("convex") {
        for pair in convex_pairs() {
            rows.extend(Start::ALL.map(|start| pair.measure(&command.arguments, start)));
        }
    }
    if command.meshes.wants("growth") {
        rows.extend(growth(&command.arguments));
    }
    if command.meshes.wants("flat") {
        rows.extend(flat(&command.arguments));
    }
    report::write("solids", &command.arguments, &rows)
}

fn print(row: &Value) {
    let number = |name: &str| row[name].as_f64().unwrap_or(f64::NAN);
    println!(
        "{:<48} {:>9} {:>8.2} us {:>8.2} us {:>6.0} us {:>8.1} us {:>8.2} {:>5}",
        row["name"].as_str().unwrap_or(""),
        row["facets"],
        number("median_ns") / 1e3,
        number("mean_ns") / 1e3,
        number("p99_ns") / 1e3,
        number("parry_median_ns") / 1e3,
        number("ratio_of_medians"),
        row["hits"],
    );
}

/// Two meshes to measure with.
struct Pair {
    group: &'static str,
    name: String,
    bodies: [Mesh; 2],
}

/// Convex bodies.
fn convex_pairs() -> Vec<Pair> {
    let cube = || slab(DVec3::splat(-0.5), DVec3::splat(0.5), [1, 1, 1]);
    let block = || slab(DVec3::new(-1.0, -0.4, -0.1), DVec3::new(1.0, 0.4, 0.1), [1, 1, 1]);
    let bodies = [
        ("cubes", [cube(), cube()]),
        ("block x ball of 32", [block(), ring_sphere(6, 5)]),
        ("balls of 500", [ring_sphere(25, 20), ring_sphere(25, 20)]),
        ("balls of 8,000", [ring_sphere(100, 80), ring_sphere(100, 80)]),
    ];
    bodies
        .into_iter()
        .map(|(name, bodies)| Pair { group: "convex", name: name.into(), bodies })
        .collect()
}

fn pairs(command: &Command) -> Vec<Pair> {
    let ball = || bumpy_ball(16_000);
    let plate = || perforated_plate([6, 4], 0.4, 32);
    let made = vec![
        ("bumpy balls", [ball(), ball()]),
        ("perforated plates", [plate(), plate()]),
        ("bolt x perforated plate", [bolt([0.3, 0.6], [0.0, 2.0, 2.5], 48), plate()]),
    ];
    let files = [
        ["teapot.stl", "teapot.stl"],
        ["fandisk.obj", "fandisk.obj"],
        ["bunny.ply", "bunny.ply"],
        ["featuretype.STL", "plate_holes.STL"],
        ["featuretype.STL", "featuretype.STL"],
        ["angle_block.STL", "plate_holes.STL"],
        ["unit_cube.STL", "unit_cube.STL"],
        ["7_8ths_cube.stl", "cylinder.stl"],
        ["../gearbox/key.stl", "../gearbox/gear.stl"],
        ["../gearbox/front_outer.stl", "../gearbox/front_ball_0.stl"],
    ];
    let pairs = command.meshes.pairs(made, &files).into_iter();
    pairs.map(|(name, bodies)| Pair { group: "pairs", name, bodies }).collect()
}

fn radius(mesh: &Mesh) -> f64 {
    mesh.vertices.iter().map(|v| v.length()).fold(0.0, f64::max)
}

/// How a pair starts: see the module's head.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Start {
    Far,
    Near,
    NearMiss,
    Touching,
}

impl Start {
    const ALL: [Self; 4] = [Self::Far, Self::Near, Self::NearMiss, Self::Touching];

    fn name(self) -> &'static str {
        match self {
            Self::Far => "far",
            Self::Near => "near",
            Self::NearMiss => "near miss",
            Self::Touching => "touching",
        }
    }
}

struct Placement {
    poses: [Pose; 2],
    direction: DVec3,
}

impl Placement {
    /// The moving body beside the fixed one, heading for it, more or less.
    fn draw(radii: [f64; 2], random: &mut Random) -> Self {
        let direction = random.direction();
        let reach = radii[0] + radii[1];
        let aside = random.direction().reject_from_normalized(direction);
        let start = -direction * reach * 1.05 + aside * (0.7 * reach * random.unit());
        let pose = |rotation, at| Pose::new(rotation, at).unwrap_or(Pose::IDENTITY);
        let poses = [pose(random.rotation(), start), pose(random.rotation(), DVec3::ZERO)];
        Self { poses, direction }
    }

    /// The distance after which the bodies meet, if they do.
    fn distance(&self, [p, q]: [&Solid; 2], workspace: &mut Workspace) -> Option<f64> {
        let cast = Cast::new(p.at(self.poses[0]), q.at(self.poses[1]), self.direction).ok()?;
        cast.clearance_in(workspace).ok()?.distance().filter(|d| d.is_finite())
    }

    /// Of bodies that meet the same, the moving one put aside until they do not.
    fn missing(&self, aside: DVec3, bodies: [&Solid; 2], workspace: &mut Workspace) -> Self {
        let (mut meets, mut misses) = (0.0, 2.0);
        while misses - meets > MISS {
            let middle = 0.5 * (meets + misses);
            let met = self.moved(aside * middle).distance(bodies, workspace).is_some();
            *(if met { &mut meets } else { &mut misses }) = middle;
        }
        self.moved(aside * misses)
    }

    /// The same with the moving body elsewhere.
    fn moved(&self, by: DVec3) -> Self {
        let [moving, fixed] = self.poses;
        let at = moving.translation() + by;
        let moving = Pose::new(moving.rotation(), at).unwrap_or(moving);
        Self { poses: [moving, fixed], ..*self }
    }
}

impl Pair {
    /// So many settings.
    fn placements(
        &self,
        bodies: [&Solid; 2],
        start: Start,
        count: usize,
        seed: u64,
    ) -> Vec<Placement> {
        let radii = [radius(&self.bodies[0]), radius(&self.bodies[1])];
        let reach = radii[0] + radii[1];
        let facets = bodies[0].triangles().len();
        let mut random = Random::stream(seed, &[self.name.len() as u64, facets as u64]);
        let mut workspace = Workspace::default();
        let mut draw = || {
            let placement = Placement::draw(radii, &mut random);
            if start == Start::Far {
                return Some(placement);
            }
            let distance = placement.distance(bodies, &mut workspace)?;
            let forward =
                |by: f64| Some(placement.moved(placement.direction * (distance + by * reach)));
            match start {
                Start::Near => return forward(-NEAR),
                Start::Touching => return forward(SUNK),
                Start::Far | Start::NearMiss => {}
            }
            let aside = random.direction().reject_from_normalized(placement.direction);
            Some(placement.missing(aside.normalize_or_zero() * reach, bodies, &mut workspace))
        };
        // Not all that are drawn meet.
        (0..100 * count).filter_map(|_| draw()).take(count).collect()
    }

    fn measure(&self, arguments: &Arguments, start: Start) -> Value {
        let [a, b] = &self.bodies;
        let (Some(p), Some(q)) = (solid(a), solid(b)) else { return Value::Null };
        let count = if arguments.quick || start != Start::Far { 60 } else { 300 };
        let name = match start {
            Start::Far => self.name.clone(),
            _ => format!("{}, {}", self.name, start.name()),
        };
        let placements = self.placements([&p, &q], start, count, arguments.seed);
        let mut row = compare(self.group, &name, [&p, &q], &placements);
        row["start"] = json!(start.name());
        if self.group == "convex" {
            as_convex(&mut row, [&p, &q], &placements);
        }
        row
    }
}

/// Times both libraries on the same settings; the row is printed too.
fn compare(group: &str, name: &str, [p, q]: [&Solid; 2], placements: &[Placement]) -> Value {
    let meshes = [p, q].map(|body| triangle_mesh(body.vertices(), body.triangles()));
    let size: f64 = [p, q].map(|body| body.bounds().size().length()).into_iter().sum();
    let stopwatch = Stopwatch::new();
    let (mut ours, mut theirs) = (Times::default(), Times::default());
    let (mut hits, mut apart) = (0, 0);
    let mut workspace = Workspace::default();
    // What a solid prepares in its first query is no part of the others.
    placements.first().and_then(|first| first.distance([p, q], &mut workspace));
    for block in placements.chunks(BLOCK) {
        let mut distances = Vec::with_capacity(BLOCK);
        for Placement { poses: [s, t], direction } in block {
            let Ok(cast) = Cast::new(p.at(*s), q.at(*t), *direction) else {
                distances.push(None);
                continue;
            };
            let (answer, time) = stopwatch.time(|| cast.clearance_in(&mut workspace));
            ours.add(time);
            let distance = match answer {
                Ok(Clearance::Overlapping(_)) => Some(0.0),
                Ok(answer) => answer.distance().filter(|d| d.is_finite()),
                Err(_) => None,
            };
            distances.push(distance);
        }
        for (Placement { poses: [s, t], direction }, distance) in block.iter().zip(distances) {
            let placed = ParrySetting::placed([s, t], *direction);
            let (other, time) = stopwatch.time(|| placed.cast(&meshes[0], &meshes[1]));
            theirs.add(time);
            hits += usize::from(distance.is_some());
            let agree = match (distance, other) {
                (Some(x), Some(y)) => (x - y).abs() <= AGREEMENT * size,
                (None, None) => true,
                _ => false,
            };
            apart += usize::from(!agree);
        }
    }
    ours.sort();
    theirs.sort();
    let mut row = ours.to_json();
    row.insert("group".into(), json!(group));
    row.insert("name".into(), json!(name));
    row.insert("facets".into(), json!(p.triangles().len() + q.triangles().len()));
    row.insert("settings".into(), json!(placements.len()));
    row.insert("hits".into(), json!(hits));
    row.insert("answers_apart".into(), json!(apart));
    row.insert("parry_median_ns".into(), json!(theirs.median()));
    row.insert("parry_mean_ns".into(), json!(theirs.mean()));
    row.insert("ratio".into(), json!(theirs.mean() / ours.mean()));
    row.insert("ratio_of_medians".into(), json!(theirs.median() / ours.median()));
    let row = Value::Object(row);
    print(&row);
    row
}

/// Times the same bodies as solids and as convex polyhedra, in turns, and adds that to a row.
fn as_convex(row: &mut Value, [p, q]: [&Solid; 2], placements: &[Placement]) {
    let hull = |body: &Solid| ConvexPolyhedron::from_points(body.vertices());
    let (Ok(a), Ok(b)) = (hull(p), hull(q)) else { return };
    let stopwatch = Stopwatch::new();
    let (mut solids, mut polyhedra) = (Times::default(), Times::default());
    let mut workspace = Workspace::default();
    for block in placements.chunks(BLOCK) {
        for Placement { poses: [s, t], direction } in block {
            let Ok(cast) = Cast::new(p.at(*s), q.at(*t), *direction) else { continue };
            solids.add(stopwatch.time(|| cast.clearance_in(&mut workspace)).1);
        }
        for Placement { poses: [s, t], direction } in block {
            let Ok(cast) = Cast::new(a.at(*s), b.at(*t), *direction) else { continue };
            polyhedra.add(stopwatch.time(|| cast.clearance()).1);
        }
    }
    solids.sort();
    polyhedra.sort();
    row["convex_median_ns"] = json!(polyhedra.median());
    row["times_convex"] = json!(solids.median() / polyhedra.median());
    let [ours, theirs] = [&solids, &polyhedra].map(|times| times.median() / 1e3);
    println!(
        "    as solids {ours:.2} us, as convex polyhedra {theirs:.2} us: {:.1}",
        ours / theirs
    );
}

/// The same body in more and more facets.
fn growth(arguments: &Arguments) -> Vec<Value> {
    let sizes: &[usize] =
        if arguments.quick { &[16_000, 1_000_000] } else { &[16_000, 64_000, 256_000, 1_000_000] };
    let stopwatch = Stopwatch::new();
    let mut rows = Vec::new();
    for &size in sizes {
        let mesh = bumpy_ball(size);
        let (body, build) = stopwatch.time(|| solid(&mesh));
        let Some(body) = body else { continue };
        let mut random = Random::stream(arguments.seed, &[7]);
        let count = if arguments.quick { 20 } else { 100 };
        let placements: Vec<Placement> =
            (0..count).map(|_| Placement::draw([1.2, 1.2], &mut random)).collect();
        let mut row = compare("growth", "bumpy ball", [&body, &body], &placements);
        let bytes = body.memory_bytes() as f64 / body.triangles().len() as f64;
        println!("    built in {:.1} ms, {bytes:.0} bytes a facet", build / 1e6);
        row["build_ns"] = json!(build);
        row["bytes_per_facet"] = json!(bytes);
        rows.push(row);
    }
    rows
}

/// A slab on another one, at random places.
fn flat(arguments: &Arguments) -> Vec<Value> {
    let oblique = DQuat::from_xyzw(0.1, 0.7, -0.2, 0.3).normalize();
    let cases = [
        ("resting", 0.25, DVec3::NEG_Z),
        ("sliding", 0.25, DVec3::X),
        ("sliding aslant", 0.25, DVec3::new(0.6, 0.8, 0.0)),
        ("parting", 0.25, DVec3::Z),
        ("gap 1", 1.25, DVec3::NEG_Z),
        ("gap 1e-3", 0.251, DVec3::NEG_Z),
        ("passing over at 1e-6", 0.250_001, DVec3::X),
    ];
    let mut rows = Vec::new();
    for parts in [[1, 1, 1], [4, 4, 1], [40, 40, 2], [180, 180, 4]] {
        let mesh = slab(DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 0.25), parts);
        let Some(body) = solid(&mesh) else { continue };
        for (name, height, direction) in cases {
            for (turned, rotation) in [("", DQuat::IDENTITY), (", turned", oblique)] {
                let mut random = Random::stream(arguments.seed, &[9]);
                let pose = |at| Pose::new(rotation, rotation * at).unwrap_or(Pose::IDENTITY);
                let mut aside = || random.range(-0.4, 0.4);
                let placements: Vec<Placement> = (0..if arguments.quick { 50 } else { 200 })
                    .map(|_| Placement {
                        poses: [pose(DVec3::new(aside(), aside(), height)), pose(DVec3::ZERO)],
                        direction: rotation * direction,
                    })
                    .collect();
                rows.push(compare("flat", &format!("{name}{turned}"), [&body; 2], &placements));
            }
        }
    }
    rows
}
