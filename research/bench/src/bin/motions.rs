//! `motions`: compares first contacts of rotating bodies with the nonlinear cast of `parry3d-f64`, in one run
//! on the same settings.
//!
//! Families: random spins up to 6 radians past each other, a blade that passes or grazes a tip, a door that
//! closes on its frame face to face, a box that spins above a table, a pin with 48 sides near a wall. Both
//! libraries answer each setting in turns. Each query is measured alone; the figures are medians. Parry's
//! answer is *missed* where a contact is proven and it has none. It is *late* if it is more than a millionth
//! after the proven bounds. It is *false* where no contact is possible or it is earlier than the bounds.

use std::f64::consts::TAU;
use std::process::ExitCode;

use clap::Args;
use colltrans::motion::{Motion, MotionCast, MotionOutcome};
use colltrans::{ConvexPolyhedron, Pose, Solid};
use colltrans_bench::harness::{self, Run};
use colltrans_bench::parry::{self, Spin};
use colltrans_bench::shapes::Shape;
use colltrans_bench::times::{Clock, Comparison};
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::Mesh;
use colltrans_testkit::solids::thread;
use glam::{DQuat, DVec3};
use serde_json::{Value, json};

#[derive(Debug, Args)]
struct OwnArguments {
    /// Measure a bolt with 1,200 triangles in a nut with 576 instead
    #[arg(long)]
    threads: bool,
}

/// Accepted error of parry's answer, as a share of the motion.
const ACCEPTED_ERROR: f64 = 1e-6;

/// A body that spins about a uniformly moving point, and a body at rest.
struct Turning {
    bodies: [ConvexPolyhedron; 2],
    start: Pose,
    center: DVec3,
    velocity: DVec3,
    spin: DVec3,
    there: Pose,
}

fn main() -> ExitCode {
    let about = "Compares first contacts of rotating bodies with parry3d-f64; prints a table";
    harness::run("motions", about, |run, own: &OwnArguments| {
        if own.threads {
            measure_bolts(run);
        } else {
            measure_families(run);
        }
        Ok(())
    })
}

/// Measures all families.
fn measure_families(run: &mut Run) {
    let columns = "family:<28; ours ns:>9.0=ours/median_ns; parry ns:>9.0=parry/median_ns; ratio:>7.2; contact:>7=contacts;
        looks:>6; most:>6=most_looks; width:>9.1e; missed:>7; late:>6; false:>6";
    run.table("", columns);
    for n in run.sizes(&[8, 32, 128, 2_000]) {
        run.add(measure_row(&format!("random {n}"), run, |random| draw_spinning(n, random)));
    }
    for gap in [1e-3, 1e-6, -1e-3, -1e-6] {
        run.add(measure_row(&format!("blade and tip {gap:e}"), run, |random| {
            draw_blade(gap, random)
        }));
    }
    run.add(measure_row("blade through a cube", run, |random| draw_blade(-0.2, random)));
    run.add(measure_row("door on its frame", run, draw_door));
    for gap in [1e-3, 1e-9] {
        run.add(measure_row(&format!("box above a table {gap:e}"), run, |random| {
            draw_table(gap, random)
        }));
    }
    for gap in [1e-2, 1e-4] {
        run.add(measure_row(&format!("pin beside a wall {gap:e}"), run, |random| {
            draw_pin(gap, random)
        }));
    }
}

/// Measures a bolt in a nut; a quick run leaves parry out.
fn measure_bolts(run: &mut Run) {
    run.program = "threads".into();
    let solid = |mesh: &Mesh| Solid::from_mesh(&mesh.vertices, &mesh.faces).expect("a solid");
    let bolt = solid(&thread([1.0, 0.1, 0.5], [0.0, 2.0], [24, 24], None));
    let nut = solid(&thread([1.04, 0.1, 0.5], [0.6, 1.4], [24, 9], Some(1.5)));
    let [a, b] = [&bolt, &nut].map(|s| parry::triangle_mesh(s.vertices(), s.triangles()));
    let clock = Clock::new(1);
    let columns = "bolt and nut:<20=name; ours ms:>9.0=ours_ns ÷ 1e6; parry ms:>9.0=parry_ns ÷ 1e6; ratio:>7.0; nodes:>8;
        leaves:>7; lower:>20.15; width:>9.1e?inf; parry:>20?none";
    run.table("", columns);
    for (name, factor) in [("its pitch", 1.0), ("5 % wrong", 0.95), ("no rise", 0.0)] {
        let (here, rise) = (Pose::IDENTITY, 0.5 * factor);
        let turn = Motion::screw(here, DVec3::ZERO, DVec3::Z, TAU, rise).expect("a motion");
        let cast = MotionCast::new(bolt.with_motion(&turn), nut.at(here)).expect("a cast");
        let asked = (0..5).map(|_| clock.time(|| cast.first_contact()));
        let (found, ours) = asked.min_by(|a, b| a.1.total_cmp(&b.1)).expect("five answers");
        let found = found.expect("an answer");
        let spin = Spin::new(&here, DVec3::ZERO, DVec3::Z * rise, DVec3::Z * TAU, &here);
        let theirs = run.choose(None, Some(())).map(|()| clock.time(|| spin.cast(&a, &b)));
        let [lower, upper] = match &found {
            MotionOutcome::Contact(of) => [of.lower, of.upper],
            _ => [1.0, f64::INFINITY],
        };
        let steps = found.steps();
        let (hit, parry) = theirs.unwrap_or((None, f64::NAN));
        run.add(json!({
            "name": name, "ours_ns": ours, "parry_ns": parry, "ratio": parry / ours,
            "nodes": steps.nodes, "leaves": steps.leaves, "lower": lower, "width": upper - lower,
            "parry": hit,
        }));
    }
}

/// Measures a family.
fn measure_row(name: &str, run: &Run, draw: impl Fn(&mut Random) -> Option<Turning>) -> Value {
    let mut random = run.random(&[name.len() as u64]);
    let (clock, mut times) = (Clock::new(1), Comparison::default());
    let (mut looks, mut widths) = (Vec::new(), Vec::new());
    let [mut missed, mut late, mut wrongly] = [0_u32; 3];
    for turn in 0..run.choose(60, 400) {
        let Some(turning) = draw(&mut random) else { continue };
        let Turning { bodies: [p, q], start, center, velocity, spin, there } = &turning;
        let [Some(a), Some(b)] = [p, q].map(parry::convert_body) else { continue };
        let motion = Motion::free_flight(*start, *center, *velocity, *spin).expect("a motion");
        let cast = MotionCast::new(p.with_motion(&motion), q.at(*there)).expect("a cast");
        let spin = Spin::new(start, *center, *velocity, *spin, there);
        let ((mine, ours), (other, theirs)) =
            clock.time_both(turn, || cast.first_contact(), || spin.cast(&a, &b));
        let (bounds, steps) = match mine.expect("an answer") {
            MotionOutcome::Contact(found) => (Some([found.lower, found.upper]), found.steps),
            MotionOutcome::Free(free) => (None, free.steps),
            _ => continue,
        };
        looks.push(steps.looks);
        times.add(ours, theirs);
        match (bounds, other) {
            (Some([lower, upper]), other) => {
                widths.push(upper - lower);
                missed += u32::from(other.is_none());
                late += u32::from(other.is_some_and(|t| t > upper + ACCEPTED_ERROR));
                wrongly += u32::from(other.is_some_and(|t| t < lower - ACCEPTED_ERROR));
            }
            (None, other) => wrongly += u32::from(other.is_some()),
        }
    }
    looks.sort_unstable();
    widths.sort_by(f64::total_cmp);
    json!({
        "family": name, "ours": times.ours, "parry": times.theirs, "ratio": times.ratios.median(),
        "contacts": widths.len(), "looks": looks.get(looks.len() / 2).unwrap_or(&0),
        "most_looks": looks.last().unwrap_or(&0), "width": widths.get(widths.len() / 2),
        "missed": missed, "late": late, "false": wrongly,
    })
}

/// Builds a box.
fn box_body(half: [f64; 3]) -> Option<ConvexPolyhedron> {
    let half = DVec3::from_array(half);
    ConvexPolyhedron::cuboid(-half, half).ok()
}

/// Draws ellipsoids that pass each other, one of them rotating.
fn draw_spinning(n: usize, random: &mut Random) -> Option<Turning> {
    let bodies = [(); 2].map(|()| Shape::Ellipsoid.draw(n, random).expect("a body"));
    let from = random.direction() * random.range(3.0, 5.0);
    let start = Pose::new(random.rotation(), from).ok()?;
    let there = Pose::new(random.rotation(), DVec3::ZERO).ok()?;
    let velocity = (random.vector() * 1.2 - from) * random.range(1.0, 2.0);
    let spin = random.direction() * random.range(0.5, 6.0);
    Some(Turning { bodies, start, center: from, velocity, spin, there })
}

/// Draws a blade that turns past a tip or into it. For deep cuts, the other body is a cube.
fn draw_blade(gap: f64, random: &mut Random) -> Option<Turning> {
    let half = [1.0, random.range(0.02, 0.1), random.range(0.1, 0.3)];
    let reach = (half[0] * half[0] + half[1] * half[1]).sqrt();
    let blade = box_body(half)?;
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

/// Draws a door that closes on its frame, face to face.
fn draw_door(random: &mut Random) -> Option<Turning> {
    let door = box_body([1.0, random.range(0.02, 0.06), 2.0])?;
    let frame = box_body([0.05, 0.05, 2.2])?;
    let y = -(random.range(0.07, 0.1) + 0.05);
    let open = DQuat::from_rotation_z(random.range(0.5, 2.5));
    let start = Pose::new(open, open * DVec3::X).ok()?;
    let there = Pose::from_translation(DVec3::new(1.9, y, 0.0)).ok()?;
    let (center, velocity, spin) = (DVec3::ZERO, DVec3::ZERO, DVec3::NEG_Z * 3.0);
    Some(Turning { bodies: [door, frame], start, center, velocity, spin, there })
}

/// Draws a box that spins above a table.
fn draw_table(gap: f64, random: &mut Random) -> Option<Turning> {
    let bodies = [box_body([0.5, 0.3, 0.25])?, box_body([3.0, 3.0, 0.5])?];
    let start = Pose::new(DQuat::from_rotation_z(random.range(0.0, 1.0)), DVec3::ZERO).ok()?;
    let there = Pose::from_translation(DVec3::Z * -(0.75 + gap)).ok()?;
    let (center, velocity) = (random.vector() * DVec3::new(0.3, 0.3, 0.0), DVec3::ZERO);
    Some(Turning { bodies, start, center, velocity, spin: DVec3::Z * 6.0, there })
}

/// Draws a pin with 48 sides that turns near a wall.
fn draw_pin(gap: f64, random: &mut Random) -> Option<Turning> {
    let pin = Shape::Prism.draw(96, random).ok()?;
    let reach = |v: &DVec3| v.truncate().length();
    let radius = pin.vertices().iter().map(reach).fold(0.0, f64::max);
    let wall = box_body([1.0, 5.0, 5.0])?;
    let there = Pose::from_translation(DVec3::X * (1.0 + radius + gap)).ok()?;
    let (start, center, velocity) = (Pose::IDENTITY, DVec3::ZERO, DVec3::ZERO);
    Some(Turning { bodies: [pin, wall], start, center, velocity, spin: DVec3::Z * 6.0, there })
}
