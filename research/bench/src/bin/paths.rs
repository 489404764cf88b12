//! `paths`: measures a six-axis arm on a path with 1,000 rows among 50 obstacles, with the proof and its check.
//!
//! Links are ellipsoids with 100 vertices. Obstacles are ellipsoids with 50 vertices, or non-convex bumpy balls
//! with 1,000 triangles, 0.5 to 1.3 m from the base of the arm. An obstacle that the path meets is replaced by another
//! one, until the path is free of 50 obstacles. That path is measured. There is no comparison, because no other
//! library answers between samples.

use std::process::ExitCode;

use colltrans::motion::path::{
    Frame, Joint, JointPath, Mechanism, PathBody, PathCast, PathError, PathOutcome,
};
use colltrans::{AnyBody, ConvexPolyhedron, Pose, Solid};
use colltrans_bench::harness::{self, with_name};
use colltrans_bench::times::Clock;
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::random_hull;
use colltrans_testkit::solids::bumpy_ball;
use colltrans_testkit::timing;
use glam::DVec3;
use serde_json::{Value, json};

/// Number of rows of the path, of obstacles, and of measurements.
const ROWS: usize = 1_000;
const OBSTACLES: usize = 50;
const TIMES: usize = 11;

fn main() -> ExitCode {
    let about = "Measures a six-axis arm on a path among obstacles, with the proof and its check; prints a table";
    harness::run("paths", about, |run, (): &()| {
        run.table(
            "",
            "obstacles:<10; pairs:>8; looks:>8; planes:>8; ms:>10.1; check, ms:>10.1=check_ms",
        );
        for (name, solids) in [("convex", false), ("solids", true)] {
            run.add(measure_scene(name, solids, run.choose(3, TIMES)).map_err(with_name(name))?);
        }
        Ok(())
    })
}

/// Measures a scene.
fn measure_scene(name: &str, solids: bool, times: usize) -> Result<Value, PathError> {
    let mut random = Random::new(5);
    let (arm, links) = (build_arm()?, build_links(&mut random));
    let path = JointPath::at_unit_times(path_rows())?;
    let mut obstacles: Vec<(AnyBody, Pose)> = Vec::new();
    loop {
        while obstacles.len() < OBSTACLES {
            obstacles.push(draw_obstacle(solids, &mut random));
        }
        let cast = build_cast(&arm, &path, &links, &obstacles)?;
        let outcome = cast.first_contact()?;
        match &outcome {
            PathOutcome::Contact(of) | PathOutcome::Grazing(of) | PathOutcome::Overlapping(of) => {
                // Links do not meet each other on this path.
                let hit = of.pair[1] - links.len();
                drop(outcome);
                drop(cast);
                obstacles.remove(hit);
            }
            _ => {
                let median = |call: &dyn Fn()| {
                    let all = (0..times).map(|_| Clock::new(1).time(call).1);
                    1e-6 * timing::median(&all.collect::<Vec<_>>())
                };
                return Ok(json!({
                    "obstacles": name, "pairs": cast.pairs().len(), "looks": outcome.steps().looks,
                    "planes": outcome.proof().plane_count(),
                    "ms": median(&|| drop(cast.first_contact())),
                    "check_ms": median(&|| drop(cast.verify(outcome.proof()))),
                }));
            }
        }
    }
}

/// Builds an arm whose joints turn about z, y, y, y, z and y. Offsets are in metres.
fn build_arm() -> Result<Mechanism, PathError> {
    let (turns, tips) = (Joint::Turning(DVec3::Z), Joint::Turning(DVec3::Y));
    let frames = [
        ([0.0, 0.0, 0.1], turns),
        ([0.0, 0.14, 0.0], tips),
        ([0.0, -0.12, 0.425], tips),
        ([0.0, 0.0, 0.39], tips),
        ([0.0, 0.09, 0.0], turns),
        ([0.0, 0.0, 0.095], tips),
    ];
    let frame = |(k, (at, joint)): (usize, ([f64; 3], Joint))| {
        let origin = Pose::from_translation(DVec3::from_array(at))?;
        Ok(Frame { parent: k.checked_sub(1), origin, joint })
    };
    Mechanism::new(frames.into_iter().enumerate().map(frame).collect::<Result<_, PathError>>()?)
}

/// Builds the links.
fn build_links(random: &mut Random) -> Vec<AnyBody> {
    [0.1, 0.425, 0.39, 0.05, 0.08, 0.1]
        .map(|length| {
            let points = random_hull(100, random).vertices;
            let along = |v: &DVec3| DVec3::new(v.x * 0.06, v.y * 0.06, (v.z + 1.0) * 0.5 * length);
            let points: Vec<DVec3> = points.iter().map(along).collect();
            ConvexPolyhedron::from_points(&points).expect("a link").into()
        })
        .into()
}

/// Returns the rows of the path.
fn path_rows() -> Vec<Vec<f64>> {
    let row = |k: usize| {
        let t = std::f64::consts::TAU * k as f64 / ROWS as f64;
        let twice = (2.0 * t).sin();
        vec![t, 0.7 * twice, 0.9 * (3.0 * t).cos(), twice, t, (5.0 * t).sin()]
    };
    (0..ROWS).map(row).collect()
}

/// Draws an obstacle.
fn draw_obstacle(solids: bool, random: &mut Random) -> (AnyBody, Pose) {
    let size = random.range(0.03, 0.1);
    let body = if solids {
        let mesh = bumpy_ball(1_000).mapped(|v| v * size).triangulated();
        Solid::from_mesh(&mesh.vertices, &mesh.faces).expect("a solid").into()
    } else {
        let points: Vec<DVec3> =
            random_hull(50, random).vertices.iter().map(|v| *v * size).collect();
        ConvexPolyhedron::from_points(&points).expect("a body").into()
    };
    let (way, far) = (random.direction(), random.range(0.5, 1.3));
    let at = DVec3::new(way.x, way.y, way.z.abs()) * far;
    (body, Pose::new(random.rotation(), at).expect("a pose"))
}

/// Builds the cast of all links against all obstacles, and against each other except for neighbours and links of
/// the wrist.
fn build_cast<'a>(
    arm: &'a Mechanism,
    path: &'a JointPath,
    links: &'a [AnyBody],
    obstacles: &'a [(AnyBody, Pose)],
) -> Result<PathCast<'a>, PathError> {
    let carried = links.iter().enumerate();
    let carried = carried.map(|(k, body)| PathBody::carried_by(k, body.at(Pose::IDENTITY)));
    let bodies =
        carried.chain(obstacles.iter().map(|(body, pose)| PathBody::at_rest(body.at(*pose))));
    let (own, all) = (links.len(), links.len() + obstacles.len());
    let pairs = (0..own).flat_map(|a| (own..all).map(move |b| [a, b]));
    // The links of the wrist are built into each other.
    let apart = [[0, 2], [0, 3], [0, 4], [0, 5], [1, 3], [1, 4], [1, 5], [2, 4], [2, 5]];
    PathCast::new(arm, path, bodies.collect(), pairs.chain(apart).collect())
}
