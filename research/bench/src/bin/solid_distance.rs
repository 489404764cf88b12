//! `solid_distance`: compares the distance of two meshes with the distance of two triangle meshes in
//! `parry3d-f64`.
//!
//! Pairs have random rotations. *Apart*, the balls around the meshes have a distance of 0.3 to 1 times the sum
//! of their radii. At a *gap*, the meshes have a distance of a share of that sum, along the normal of their
//! distance. A rod in a nut is measured in the thread, where the clearance is uniform. Each query is measured
//! alone, with both libraries on the same settings, in blocks.

use std::process::ExitCode;

use colltrans::solid::SolidSteps;
use colltrans::{Pair, Pose, Solid};
use colltrans_bench::harness::{self, merge_objects};
use colltrans_bench::meshes::{MeshArguments, solid_from_mesh};
use colltrans_bench::parry::{ParrySetting, triangle_mesh};
use colltrans_bench::times::Comparison;
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::{Mesh, reach};
use colltrans_testkit::solids::{bumpy_ball, perforated_plate, thread};
use colltrans_testkit::timing::Stopwatch;
use glam::{DQuat, DVec3};
use serde_json::{Value, json};

/// Gaps as shares of the sum of the radii; the first value stands for bodies apart.
const GAPS: [f64; 4] = [f64::INFINITY, 1e-2, 1e-4, 1e-9];
/// Number of queries of one library in a row.
const BLOCK: usize = 25;

fn main() -> ExitCode {
    let about =
        "Compares distances of solids with those of triangle meshes in parry3d-f64; prints a table";
    harness::run("solid_distance", about, |run, meshes: &MeshArguments| {
        let columns = "pair:<44=name; facets:>9; ours:>11.1=median_ns ÷ 1e3 us; p99:>11.0=p99_ns ÷ 1e3 us;
            parry:>11.1=parry_median_ns ÷ 1e3 us; ratio:>6.2=ratio_of_medians; mean:>7.2=ratio; nodes:>9; leaves:>8;
            off:>9.1e";
        run.table("", columns);
        for (name, [a, b]) in mesh_pairs(meshes) {
            for gap in GAPS {
                let count = run.choose(40, 200);
                let placed = |p: &Solid, q: &Solid| draw_poses([p, q], gap, count);
                let kind = if gap.is_infinite() { "apart".into() } else { format!("gap {gap:e}") };
                if let Some(row) = measure_pair(&format!("{name}, {kind}"), [&a, &b], placed) {
                    run.add(row);
                }
            }
        }
        for sides in [24, 48] {
            let name = format!("thread of {sides}, inside");
            let rod = thread([1.0, 0.1, 0.5], [0.0, 2.0], [sides, 2 * sides], None);
            let nut = thread([1.04, 0.1, 0.5], [0.6, 1.4], [sides, sides], Some(1.5));
            let placed = |_: &Solid, _: &Solid| poses_in_thread(run.choose(10, 60));
            let row = meshes
                .is_selected(&name)
                .then(|| measure_pair(&name, [&rod, &nut], placed))
                .flatten();
            if let Some(row) = row {
                run.add(row);
            }
        }
        Ok(())
    })
}

/// Returns the pairs of meshes with their names.
fn mesh_pairs(meshes: &MeshArguments) -> Vec<(String, [Mesh; 2])> {
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
    meshes.pairs(made, &files)
}

/// Draws `count` poses of both bodies, apart or at a gap.
fn draw_poses([p, q]: [&Solid; 2], gap: f64, count: usize) -> Vec<[Pose; 2]> {
    let size = reach(p.vertices()) + reach(q.vertices());
    let mut random = Random::stream(27, &[p.triangles().len() as u64]);
    let mut draw = || -> Option<[Pose; 2]> {
        let at = random.direction() * size * random.range(1.3, 2.0);
        let poses = [
            Pose::new(random.rotation(), at).ok()?,
            Pose::new(random.rotation(), DVec3::ZERO).ok()?,
        ];
        if gap.is_infinite() {
            return Some(poses);
        }
        let found = Pair::new(p.at(poses[0]), q.at(poses[1])).ok()?.distance().ok()?;
        let to = at + found.normal? * (found.upper - gap * size);
        Some([Pose::from_matrix(poses[0].matrix(), to).ok()?, poses[1]])
    };
    (0..count).filter_map(|_| draw()).collect()
}

/// Returns poses of a rod that follows its thread.
fn poses_in_thread(count: usize) -> Vec<[Pose; 2]> {
    let turn = |k: usize| {
        let angle = 0.3 + 0.7 * k as f64;
        let rise = angle / std::f64::consts::TAU * 0.5 % 0.25;
        let angle = rise / 0.5 * std::f64::consts::TAU;
        Pose::new(DQuat::from_rotation_z(angle), DVec3::Z * rise).ok()
    };
    (0..count).filter_map(|k| Some([turn(k)?, Pose::IDENTITY])).collect()
}

/// Measures a pair.
fn measure_pair(
    name: &str,
    meshes: [&Mesh; 2],
    placed: impl Fn(&Solid, &Solid) -> Vec<[Pose; 2]>,
) -> Option<Value> {
    let (p, q) = (solid_from_mesh(meshes[0])?, solid_from_mesh(meshes[1])?);
    let [r, f] = [&p, &q].map(|s| triangle_mesh(s.vertices(), s.triangles()));
    let stopwatch = Stopwatch::new();
    let (mut nodes, mut leaves, mut off) = (0_u64, 0_u64, 0.0_f64);
    let placements = placed(&p, &q);
    let times = Comparison::in_blocks(
        &placements,
        BLOCK,
        |[s, t]| {
            let pair = Pair::new(p.at(*s), q.at(*t)).expect("poses in range");
            let (answer, time) = stopwatch.time(|| pair.distance());
            (answer.map_or((f64::NAN, SolidSteps::default()), |of| (of.upper, of.steps)), time)
        },
        |[s, t]| {
            let setting = ParrySetting::from_poses([s, t], DVec3::Z);
            stopwatch.time(|| setting.distance(&r, &f))
        },
        |(upper, steps), other| {
            (nodes, leaves) = (nodes + u64::from(steps.nodes), leaves + u64::from(steps.leaves));
            off = off.max((other.unwrap_or(f64::NAN) - upper).abs());
        },
    );
    let count = placements.len() as u64;
    let row = json!({
        "name": name, "facets": p.triangles().len() + q.triangles().len(), "settings": count,
        "nodes": nodes / count.max(1), "leaves": leaves / count.max(1), "off": off,
    });
    Some(merge_objects(times.to_json(), row))
}
