//! `motions`: first contacts of bodies that turn beside `parry3d-f64`'s nonlinear cast, in the same run on
//! the same settings.
//!
//! Families: random spins to 6 radians past each other, a blade that passes or grazes a tip, a door that
//! closes on its frame face to face, a box that spins above a table, a pin of 48 sides beside a wall. Both
//! libraries answer each setting in turns; a query is timed alone, and the figures are medians. Parry's
//! answer is *missed* where a contact is proven and it has none, *late* if it is more than a millionth after
//! the proven bounds, *false* where none is possible or it is earlier.

use std::f64::consts::TAU;
use std::process::ExitCode;

use clap::Parser;
use colltrans::motion::{Motion, MotionCast, MotionOutcome};
use colltrans::{ConvexPolyhedron, Pose, Solid};
use colltrans_bench::arguments::Arguments;
use colltrans_bench::parry::{self, ParryPolyhedron, Spin};
use colltrans_bench::report::{self, Times};
use colltrans_bench::shapes::Shape;
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::Mesh;
use colltrans_testkit::solids::thread;
use colltrans_testkit::timing::Stopwatch;
use glam::{DQuat, DVec3};
use serde_json::{Value, json};

/// Measures first contacts of bodies that turn beside parry3d-f64; prints a table
#[derive(Debug, Parser)]
struct Command {
    #[command(flatten)]
    arguments: Arguments,
    /// A bolt of 1,200 triangles in a nut of 576 instead
    #[arg(long)]
    threads: bool,
}

/// By how much of the motion parry may be off.
const OFF: f64 = 1e-6;

/// A body that spins about a point of it, which moves evenly, and one at rest.
struct Turning {
    bodies: [ConvexPolyhedron; 2],
    start: Pose,
    center: DVec3,
    velocity: DVec3,
    spin: DVec3,
    there: Pose,
}

fn main() -> ExitCode {
    let Command { arguments, threads } = Command::parse();
    if threads {
        return report::write("threads", &arguments, &bolts(arguments.quick));
    }
    let count = if arguments.quick { 60 } else { 400 };
    let mut rows = Vec::new();
    println!(
        "{:<28} {:>9} {:>9} {:>7} {:>7} {:>6} {:>6} {:>9} {:>7} {:>6} {:>6}",
        "family",
        "ours ns",
        "parry ns",
        "ratio",
        "contact",
        "looks",
        "most",
        "width",
        "missed",
        "late",
        "false"
    );
    for &n in arguments.sizes.as_deref().unwrap_or(&[8, 32, 128, 2_000]) {
        let draw = |random: &mut Random| spinning(n, random);
        rows.push(row(&format!("random {n}"), count, arguments.seed, draw));
    }
    for gap in [1e-3, 1e-6, -1e-3, -1e-6] {
        let draw = |random: &mut Random| blade(gap, random);
        rows.push(row(&format!("blade and tip {gap:e}"), count, arguments.seed, draw));
    }
    rows.push(row("blade through a cube", count, arguments.seed, |random| blade(-0.2, random)));
    rows.push(row("door on its frame", count, arguments.seed, door));
    for gap in [1e-3, 1e-9] {
        let draw = |random: &mut Random| table(gap, random);
        rows.push(row(&format!("box above a table {gap:e}"), count, arguments.seed, draw));
    }
    for gap in [1e-2, 1e-4] {
        let draw = |random: &mut Random| pin(gap, random);
        rows.push(row(&format!("pin beside a wall {gap:e}"), count, arguments.seed, draw));
    }
    report::write("motions", &arguments, &rows)
}

/// A bolt in a nut; parry is not asked in a quick run.
fn bolts(quick: bool) -> Vec<Value> {
    let solid = |mesh: &Mesh| Solid::from_mesh(&mesh.vertices, &mesh.faces).expect("a solid");
    let bolt = solid(&thread([1.0, 0.1, 0.5], [0.0, 2.0], [24, 24], None));
    let nut = solid(&thread([1.04, 0.1, 0.5], [0.6, 1.4], [24, 9], Some(1.5)));
    let [a, b] = [&bolt, &nut].map(|s| parry::triangle_mesh(s.vertices(), s.triangles()));
    let stopwatch = Stopwatch::new();
    println!(
        "{:<20} {:>9} {:>9} {:>7} {:>8} {:>7} {:>20} {:>9} {:>20}",
        "bolt and nut",
        "ours ms",
        "parry ms",
        "ratio",
        "nodes",
        "leaves",
        "lower",
        "width",
        "parry"
    );
    let pitches = [("its pitch", 1.0), ("5 % wrong", 0.95), ("no rise", 0.0)];
    pitches
        .into_iter()
        .map(|(name, factor)| {
            let (here, rise) = (Pose::IDENTITY, 0.5 * factor);
            let turn = Motion::screw(here, DVec3::ZERO, DVec3::Z, TAU, rise).expect("a motion");
            let cast = MotionCast::new(bolt.along(&turn), nut.at(here)).expect("a cast");
            let asked = (0..5).map(|_| stopwatch.time(|| cast.first_contact()));
            let (found, ours) = asked.min_by(|a, b| a.1.total_cmp(&b.1)).expect("five answers");
            let found = found.expect("an answer");
            let spin = Spin::new(&here, DVec3::ZERO, DVec3::Z * rise, DVec3::Z * TAU, &here);
            let theirs = (!quick).then(|| stopwatch.time(|| spin.cast(&a, &b)));
            let [lower, upper] = match &found {
                MotionOutcome::Contact(of) => [of.lower, of.upper],
                _ => [1.0, f64::INFINITY],
            };
            let steps = found.steps();
            let (hit, parry) = theirs.unwrap_or((None, f64::NAN));
            let (ratio, width) = (parry / ours, upper - lower);
            println!(
                "{name:<20} {:>9.0} {:>9.0} {ratio:>7.0} {:>8} {:>7} {lower:>20.15} {width:>9.1e} {:>20}",
                ours * 1e-6,
                parry * 1e-6,
                steps.nodes,
                steps.leaves,
                hit.map_or("none".into(), |t| t.to_string()),
            );
            json!({
                "name": name, "ours_ns": ours, "parry_ns": parry, "ratio": ratio, "nodes": steps.nodes,
                "leaves": steps.leaves, "lower": lower, "width": width, "parry": hit,
            })
        })
        .collect()
}

fn row(
    name: &str,
    count: usize,
    seed: u64,
    draw: impl Fn(&mut Random) -> Option<Turning>,
) -> Value {
    let mut random = Random::stream(seed, &[name.len() as u64]);
    let stopwatch = Stopwatch::new();
    let [mut ours, mut parrys, mut ratios] = [(); 3].map(|()| Times::default());
    let (mut looks, mut widths) = (Vec::new(), Vec::new());
    let [mut missed, mut late, mut wrongly] = [0_u32; 3];
    for index in 0..count {
        let Some(turning) = draw(&mut random) else { continue };
        let Turning { bodies: [p, q], start, center, velocity, spin, there } = &turning;
        let Some([a, b]) = parry_bodies([p, q]) else { continue };
        let motion = Motion::thrown(*start, *center, *velocity, *spin).expect("a motion");
        let cast = MotionCast::new(p.along(&motion), q.at(*there)).expect("a cast");
        let spin = Spin::new(start, *center, *velocity, *spin, there);
        let us = || cast.first_contact();
        let ((mine, spent), (other, theirs)) = if index % 2 == 0 {
            let first = stopwatch.time(us);
            (first, stopwatch.time(|| spin.cast(&a, &b)))
        } else {
            let first = stopwatch.time(|| spin.cast(&a, &b));
            (stopwatch.time(us), first)
        };
        let (bounds, steps) = match mine.expect("an answer") {
            MotionOutcome::Contact(found) => (Some([found.lower, found.upper]), found.steps),
            MotionOutcome::Free(free) => (None, free.steps),
            _ => continue,
        };
        looks.push(steps.looks);
        ours.add(spent);
        parrys.add(theirs);
        ratios.add(theirs / spent);
        match (bounds, other) {
            (Some([lower, upper]), other) => {
                widths.push(upper - lower);
                missed += u32::from(other.is_none());
                late += u32::from(other.is_some_and(|t| t > upper + OFF));
                wrongly += u32::from(other.is_some_and(|t| t < lower - OFF));
            }
            (None, other) => wrongly += u32::from(other.is_some()),
        }
    }
    for times in [&mut ours, &mut parrys, &mut ratios] {
        times.sort();
    }
    looks.sort_unstable();
    widths.sort_by(f64::total_cmp);
    let width = widths.get(widths.len() / 2).copied().unwrap_or(f64::NAN);
    let (middle, most) = (looks.get(looks.len() / 2), looks.last());
    let (middle, most) = (middle.copied().unwrap_or(0), most.copied().unwrap_or(0));
    println!(
        "{name:<28} {:>9.0} {:>9.0} {:>7.2} {:>7} {middle:>6} {most:>6} {width:>9.1e} {missed:>7} {late:>6} {wrongly:>6}",
        ours.median(),
        parrys.median(),
        ratios.median(),
        widths.len(),
    );
    json!({
        "family": name, "ours": ours.to_json(), "parry": parrys.to_json(), "ratio": ratios.median(),
        "contacts": widths.len(), "looks": middle, "most_looks": most, "width": width,
        "missed": missed, "late": late, "false": wrongly,
    })
}

fn parry_bodies(bodies: [&ConvexPolyhedron; 2]) -> Option<[ParryPolyhedron; 2]> {
    let [a, b] = bodies.map(parry::body);
    Some([a?, b?])
}

fn cuboid(half: [f64; 3]) -> Option<ConvexPolyhedron> {
    let half = DVec3::from_array(half);
    ConvexPolyhedron::cuboid(-half, half).ok()
}

/// Ellipsoids that pass each other, one of them turning.
fn spinning(n: usize, random: &mut Random) -> Option<Turning> {
    let bodies = [(); 2].map(|()| Shape::Ellipsoid.draw(n, random).expect("a body"));
    let from = random.direction() * random.range(3.0, 5.0);
    let start = Pose::new(random.rotation(), from).ok()?;
    let there = Pose::new(random.rotation(), DVec3::ZERO).ok()?;
    let velocity = (random.vector() * 1.2 - from) * random.range(1.0, 2.0);
    let spin = random.direction() * random.range(0.5, 6.0);
    Some(Turning { bodies, start, center: from, velocity, spin, there })
}

/// A blade turns past a tip, or into it; deep cuts are of a cube.
fn blade(gap: f64, random: &mut Random) -> Option<Turning> {
    let half = [1.0, random.range(0.02, 0.1), random.range(0.1, 0.3)];
    let reach = (half[0] * half[0] + half[1] * half[1]).sqrt();
    let blade = cuboid(half)?;
    let tip = if gap < -0.1 {
        ConvexPolyhedron::cuboid(DVec3::new(0.0, -0.2, -0.2), DVec3::new(0.4, 0.2, 0.2)).ok()?
    } else {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.3, 0.2], [1.0, -0.3, 0.2], [1.0, 0.0, -0.3]];
        ConvexPolyhedron::from_points(&corners.map(DVec3::from_array)).ok()?
    };
    let turn = DQuat::from_rotation_z(random.range(1.0, 2.5));
    let there = Pose::new(turn, turn * DVec3::X * (reach + gap)).ok()?;
    let spin = DVec3::Z * random.range(2.6, 3.0);
    let [center, velocity] = [DVec3::ZERO; 2];
    Some(Turning { bodies: [blade, tip], start: Pose::IDENTITY, center, velocity, spin, there })
}

/// A door closes on its frame, face to face.
fn door(random: &mut Random) -> Option<Turning> {
    let door = cuboid([1.0, random.range(0.02, 0.06), 2.0])?;
    let frame = cuboid([0.05, 0.05, 2.2])?;
    let y = -(random.range(0.07, 0.1) + 0.05);
    let open = DQuat::from_rotation_z(random.range(0.5, 2.5));
    let start = Pose::new(open, open * DVec3::X).ok()?;
    let there = Pose::from_translation(DVec3::new(1.9, y, 0.0)).ok()?;
    let (center, velocity, spin) = (DVec3::ZERO, DVec3::ZERO, DVec3::NEG_Z * 3.0);
    Some(Turning { bodies: [door, frame], start, center, velocity, spin, there })
}

/// A box spins above a table.
fn table(gap: f64, random: &mut Random) -> Option<Turning> {
    let bodies = [cuboid([0.5, 0.3, 0.25])?, cuboid([3.0, 3.0, 0.5])?];
    let start = Pose::new(DQuat::from_rotation_z(random.range(0.0, 1.0)), DVec3::ZERO).ok()?;
    let there = Pose::from_translation(DVec3::Z * -(0.75 + gap)).ok()?;
    let (center, velocity) = (random.vector() * DVec3::new(0.3, 0.3, 0.0), DVec3::ZERO);
    Some(Turning { bodies, start, center, velocity, spin: DVec3::Z * 6.0, there })
}

/// A pin of 48 sides turns beside a wall.
fn pin(gap: f64, random: &mut Random) -> Option<Turning> {
    let pin = Shape::Prism.draw(96, random).ok()?;
    let reach = |v: &DVec3| v.truncate().length();
    let radius = pin.vertices().iter().map(reach).fold(0.0, f64::max);
    let wall = cuboid([1.0, 5.0, 5.0])?;
    let there = Pose::from_translation(DVec3::X * (1.0 + radius + gap)).ok()?;
    let (start, center, velocity) = (Pose::IDENTITY, DVec3::ZERO, DVec3::ZERO);
    Some(Turning { bodies: [pin, wall], start, center, velocity, spin: DVec3::Z * 6.0, there })
}
