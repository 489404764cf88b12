//! `solid_distance`: how far apart two meshes are, beside `parry3d-f64`'s distance of two triangle meshes.
//!
//! A pair is asked in random rotations: *apart*, by 0.3 to 1 times the sum of the radii beyond balls around them; and
//! at a *gap* of a share of that sum, put there along the normal of their distance. A rod in a nut is asked in the
//! thread, where the clearance is the same all around. Each query is timed alone, both libraries on the same
//! settings, in blocks.

use std::process::ExitCode;

use clap::Parser;
use colltrans::solid::SolidSteps;
use colltrans::{Pair, Pose, Solid};
use colltrans_bench::arguments::Arguments;
use colltrans_bench::meshes::{MeshArguments, solid};
use colltrans_bench::parry::{ParrySetting, triangle_mesh};
use colltrans_bench::report::{self, Times};
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::Mesh;
use colltrans_testkit::solids::{bumpy_ball, perforated_plate, thread};
use colltrans_testkit::timing::Stopwatch;
use glam::{DQuat, DVec3};
use serde_json::{Value, json};

/// Measures distances of solids and of parry3d-f64's triangle meshes on the same settings; prints a table
#[derive(Debug, Parser)]
struct Command {
    #[command(flatten)]
    arguments: Arguments,
    #[command(flatten)]
    meshes: MeshArguments,
}

/// Gaps as shares of the sum of the radii; the first stands for bodies that are apart.
const GAPS: [f64; 4] = [f64::INFINITY, 1e-2, 1e-4, 1e-9];
/// Queries of one library in a row.
const BLOCK: usize = 25;

fn main() -> ExitCode {
    let command = Command::parse();
    let mut rows = Vec::new();
    println!(
        "{:<44} {:>9} {:>11} {:>11} {:>11} {:>6} {:>7} {:>9} {:>8} {:>9}",
        "pair", "facets", "ours", "p99", "parry", "ratio", "mean", "nodes", "leaves", "off"
    );
    let quick = command.arguments.quick;
    for (name, [a, b]) in pairs(&command) {
        for gap in GAPS {
            let count = if quick { 40 } else { 200 };
            let placed = |p: &Solid, q: &Solid| placements([p, q], gap, count);
            let kind = if gap.is_infinite() { "apart".into() } else { format!("gap {gap:e}") };
            rows.push(measure(&format!("{name}, {kind}"), [&a, &b], placed));
        }
    }
    for sides in [24, 48] {
        let name = format!("thread of {sides}, inside");
        if command.meshes.wants(&name) {
            let rod = thread([1.0, 0.1, 0.5], [0.0, 2.0], [sides, 2 * sides], None);
            let nut = thread([1.04, 0.1, 0.5], [0.6, 1.4], [sides, sides], Some(1.5));
            rows.push(measure(&name, [&rod, &nut], |_, _| in_thread(if quick { 10 } else { 60 })));
        }
    }
    report::write("solid_distance", &command.arguments, &rows)
}

/// Two meshes by name.
fn pairs(command: &Command) -> Vec<(String, [Mesh; 2])> {
    let ball = || bumpy_ball(16_000);
    let plate = || perforated_plate([6, 4], 0.4, 32);
    let made = vec![("bumpy balls", [ball(), ball()]), ("perforated plates", [plate(), plate()])];
    let files = [
        ["teapot.stl", "teapot.stl"],
        ["fandisk.obj", "fandisk.obj"],
        ["bunny.ply", "bunny.ply"],
        ["featuretype.STL", "plate_holes.STL"],
        ["angle_block.STL", "plate_holes.STL"],
    ];
    command.meshes.pairs(made, &files)
}

/// So many poses of both bodies, apart or at a gap.
fn placements([p, q]: [&Solid; 2], gap: f64, count: usize) -> Vec<[Pose; 2]> {
    let radius = |s: &Solid| s.vertices().iter().map(|v| v.length()).fold(0.0, f64::max);
    let reach = radius(p) + radius(q);
    let mut random = Random::stream(27, &[p.triangles().len() as u64]);
    let mut draw = || -> Option<[Pose; 2]> {
        let at = random.direction() * reach * random.range(1.3, 2.0);
        let poses = [
            Pose::new(random.rotation(), at).ok()?,
            Pose::new(random.rotation(), DVec3::ZERO).ok()?,
        ];
        if gap.is_infinite() {
            return Some(poses);
        }
        let found = Pair::new(p.at(poses[0]), q.at(poses[1])).ok()?.distance().ok()?;
        let to = at + found.normal? * (found.upper - gap * reach);
        Some([Pose::from_matrix(poses[0].matrix(), to).ok()?, poses[1]])
    };
    (0..count).filter_map(|_| draw()).collect()
}

/// A rod turned and moved on as its thread asks.
fn in_thread(count: usize) -> Vec<[Pose; 2]> {
    let turn = |k: usize| {
        let angle = 0.3 + 0.7 * k as f64;
        let rise = angle / std::f64::consts::TAU * 0.5 % 0.25;
        let angle = rise / 0.5 * std::f64::consts::TAU;
        Pose::new(DQuat::from_rotation_z(angle), DVec3::Z * rise).ok()
    };
    (0..count).filter_map(|k| Some([turn(k)?, Pose::IDENTITY])).collect()
}

fn measure(
    name: &str,
    meshes: [&Mesh; 2],
    placed: impl Fn(&Solid, &Solid) -> Vec<[Pose; 2]>,
) -> Value {
    let (Some(p), Some(q)) = (solid(meshes[0]), solid(meshes[1])) else { return Value::Null };
    let [r, f] = [&p, &q].map(|s| triangle_mesh(s.vertices(), s.triangles()));
    let stopwatch = Stopwatch::new();
    let (mut ours, mut theirs, mut off) = (Times::default(), Times::default(), 0.0_f64);
    let (mut nodes, mut leaves) = (0_u64, 0_u64);
    let placements = placed(&p, &q);
    for block in placements.chunks(BLOCK) {
        let mut answers = Vec::with_capacity(BLOCK);
        for [s, t] in block {
            let Ok(pair) = Pair::new(p.at(*s), q.at(*t)) else { continue };
            let (answer, time) = stopwatch.time(|| pair.distance());
            ours.add(time);
            let (upper, steps) =
                answer.map_or((f64::NAN, SolidSteps::default()), |of| (of.upper, of.steps));
            (nodes, leaves) = (nodes + u64::from(steps.nodes), leaves + u64::from(steps.leaves));
            answers.push(upper);
        }
        for ([s, t], answer) in block.iter().zip(answers) {
            let setting = ParrySetting::placed([s, t], DVec3::Z);
            let (other, time) = stopwatch.time(|| setting.distance(&r, &f));
            theirs.add(time);
            off = off.max((other.unwrap_or(f64::NAN) - answer).abs());
        }
    }
    ours.sort();
    theirs.sort();
    let (facets, count) = (p.triangles().len() + q.triangles().len(), placements.len() as u64);
    let ratios = [theirs.median() / ours.median(), theirs.mean() / ours.mean()];
    println!(
        "{name:<44} {facets:>9} {:>8.1} us {:>8.0} us {:>8.1} us {:>6.2} {:>7.2} {:>9} {:>8} {off:>9.1e}",
        ours.median() / 1e3,
        ours.quantile(0.99) / 1e3,
        theirs.median() / 1e3,
        ratios[0],
        ratios[1],
        nodes / count.max(1),
        leaves / count.max(1),
    );
    let mut row = ours.to_json();
    row.insert("name".into(), json!(name));
    row.insert("facets".into(), json!(facets));
    row.insert("settings".into(), json!(count));
    row.insert("parry_median_ns".into(), json!(theirs.median()));
    row.insert("ratio_of_medians".into(), json!(ratios[0]));
    row.insert("ratio".into(), json!(ratios[1]));
    Value::Object(row)
}
