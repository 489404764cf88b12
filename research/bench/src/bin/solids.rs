//! `solids`: compares casts of non-convex meshes with the cast of two triangle meshes in `parry3d-f64`.
//!
//! There are four groups. *Pairs* have random rotations and directions. *Convex* measures pairs of convex
//! bodies, also with the cast of convex polyhedra. *Growth* measures the same bumpy ball with more and more
//! facets. *Flat* measures two slabs with few or many facets in one plane: resting, sliding, parting, with a
//! gap, or passing over each other. Both libraries answer the same settings. Each query is timed alone. The libraries
//! alternate after blocks of 50 queries, so that the caches contain mostly their own data.
//!
//! A pair has four kinds of starts. *Far*: the moving mesh is 1.05 times the sum of the radii before the fixed
//! one and up to 0.7 times to the side. *Near*: the meshes meet, and the start is [`NEAR`] times the sum before
//! the contact. *Near miss*: a far start of a meeting pair is shifted along a random axis until the meshes miss
//! each other by at most [`MISS`] times the sum (bisection). *Touching*: the moving mesh starts
//! [`TOUCHING_DEPTH`] times the sum beyond the contact.

use std::process::ExitCode;

use colltrans::solid::{SolidCast, Workspace};
use colltrans::{Cast, Clearance, ConvexPolyhedron, Pose, Solid};
use colltrans_bench::harness::{self, Run, merge_objects};
use colltrans_bench::meshes::{MeshArguments, solid_from_mesh};
use colltrans_bench::parry::{ParrySetting, triangle_mesh};
use colltrans_bench::times::Comparison;
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::{Mesh, reach, ring_sphere};
use colltrans_testkit::solids::{bolt, bumpy_ball, perforated_plate, slab};
use colltrans_testkit::timing::Stopwatch;
use glam::{DQuat, DVec3};
use serde_json::{Value, json};

/// Two answers agree if they differ by less than this share of the bodies' size.
const AGREEMENT: f64 = 1e-4;
/// Shares of the sum of the radii: the distance of near starts from the contact, and the largest gap of a near
/// miss.
const NEAR: f64 = 0.02;
const MISS: f64 = 0.01;
/// Depth of touching starts, as a share of the sum of the radii.
const TOUCHING_DEPTH: f64 = 1e-6;
/// Number of queries of one library in a row.
const BLOCK: usize = 50;

fn main() -> ExitCode {
    let about =
        "Compares solids with triangle meshes in parry3d-f64 on the same settings; prints a table";
    harness::run("solids", about, |run, meshes: &MeshArguments| {
        let columns = "what:<48=name; facets:>9; ours:>11.2=median_ns ÷ 1e3 us; mean:>11.2=mean_ns ÷ 1e3 us;
            p99:>9.0=p99_ns ÷ 1e3 us; parry:>11.1=parry_median_ns ÷ 1e3 us; ratio:>8.2=ratio_of_medians; hits:>5";
        run.table("", columns);
        let convex = meshes.is_selected("convex").then(convex_pairs).into_iter().flatten();
        for pair in mesh_pairs(meshes).into_iter().chain(convex) {
            for start in Start::ALL {
                pair.measure(start, run);
            }
        }
        if meshes.is_selected("growth") {
            measure_growth(run);
        }
        if meshes.is_selected("flat") {
            measure_slabs(run);
        }
        Ok(())
    })
}

/// A pair of meshes.
struct Pair {
    group: &'static str,
    name: String,
    bodies: [Mesh; 2],
}

/// Returns the convex pairs.
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

/// Returns the pairs that are not convex.
fn mesh_pairs(meshes: &MeshArguments) -> Vec<Pair> {
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
    let pairs = meshes.pairs(made, &files).into_iter();
    pairs.map(|(name, bodies)| Pair { group: "pairs", name, bodies }).collect()
}

/// The kind of start of a pair; see the module documentation.
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
    /// Draws a far start: the moving body beyond the reach of the fixed one, directed roughly towards it.
    fn draw(radii: [f64; 2], random: &mut Random) -> Self {
        let direction = random.direction();
        let reach = radii[0] + radii[1];
        let aside = random.direction().reject_from_normalized(direction);
        let start = -direction * reach * 1.05 + aside * (0.7 * reach * random.unit());
        let pose = |rotation, at| Pose::new(rotation, at).unwrap_or(Pose::IDENTITY);
        let poses = [pose(random.rotation(), start), pose(random.rotation(), DVec3::ZERO)];
        Self { poses, direction }
    }

    /// Returns the cast of two bodies from this placement.
    fn cast<'a>(&self, p: &'a Solid, q: &'a Solid) -> Cast<'a, Solid> {
        let [moving, fixed] = self.poses;
        Cast::new(p.at(moving), q.at(fixed), self.direction).expect("poses in range")
    }

    /// Returns the distance until the bodies meet, if they meet.
    fn distance(&self, [p, q]: [&Solid; 2], workspace: &mut Workspace) -> Option<f64> {
        self.cast(p, q).clearance_in(workspace).ok()?.distance().filter(|d| d.is_finite())
    }

    /// Shifts the moving body of a meeting pair sideways until it misses the other one.
    fn missing(&self, aside: DVec3, bodies: [&Solid; 2], workspace: &mut Workspace) -> Self {
        let (mut meets, mut misses) = (0.0, 2.0);
        while misses - meets > MISS {
            let middle = 0.5 * (meets + misses);
            let met = self.moved(aside * middle).distance(bodies, workspace).is_some();
            *(if met { &mut meets } else { &mut misses }) = middle;
        }
        self.moved(aside * misses)
    }

    /// Returns the placement with the moving body translated.
    fn moved(&self, by: DVec3) -> Self {
        let [moving, fixed] = self.poses;
        let at = moving.translation() + by;
        let moving = Pose::new(moving.rotation(), at).unwrap_or(moving);
        Self { poses: [moving, fixed], ..*self }
    }
}

impl Pair {
    /// Draws `count` placements.
    fn placements(
        &self,
        bodies: [&Solid; 2],
        start: Start,
        count: usize,
        run: &Run,
    ) -> Vec<Placement> {
        let radii = self.bodies.each_ref().map(|mesh| reach(&mesh.vertices));
        let size = radii[0] + radii[1];
        let facets = bodies[0].triangles().len();
        let mut random = run.random(&[self.name.len() as u64, facets as u64]);
        let mut workspace = Workspace::default();
        let mut draw = || {
            let placement = Placement::draw(radii, &mut random);
            if start == Start::Far {
                return Some(placement);
            }
            let distance = placement.distance(bodies, &mut workspace)?;
            let forward =
                |by: f64| Some(placement.moved(placement.direction * (distance + by * size)));
            match start {
                Start::Near => return forward(-NEAR),
                Start::Touching => return forward(TOUCHING_DEPTH),
                Start::Far | Start::NearMiss => {}
            }
            let aside = random.direction().reject_from_normalized(placement.direction);
            Some(placement.missing(aside.normalize_or_zero() * size, bodies, &mut workspace))
        };
        // Not all drawn placements meet.
        (0..100 * count).filter_map(|_| draw()).take(count).collect()
    }

    /// Measures the pair from a kind of start.
    fn measure(&self, start: Start, run: &mut Run) {
        let (Some(p), Some(q)) =
            (solid_from_mesh(&self.bodies[0]), solid_from_mesh(&self.bodies[1]))
        else {
            return;
        };
        let count = if start == Start::Far { run.choose(60, 300) } else { 60 };
        let name = match start {
            Start::Far => self.name.clone(),
            _ => format!("{}, {}", self.name, start.name()),
        };
        let placements = self.placements([&p, &q], start, count, run);
        let row = compare_libraries(self.group, &name, [&p, &q], &placements);
        let mut row = merge_objects(row, json!({ "start": start.name() }));
        let convex = (self.group == "convex").then(|| as_convex([&p, &q], &placements)).flatten();
        let Some(times) = convex else { return run.add(row) };
        let [ours, theirs] = [&times.ours, &times.theirs].map(|times| times.median() / 1e3);
        row["convex_median_ns"] = json!(times.theirs.median());
        row["times_convex"] = json!(ours / theirs);
        run.add(row);
        println!(
            "    as solids {ours:.2} us, as convex polyhedra {theirs:.2} us: {:.1}",
            ours / theirs
        );
    }
}

/// Measures both libraries on the same settings.
fn compare_libraries(
    group: &str,
    name: &str,
    [p, q]: [&Solid; 2],
    placements: &[Placement],
) -> Value {
    let meshes = [p, q].map(|body| triangle_mesh(body.vertices(), body.triangles()));
    let size: f64 = [p, q].map(|body| body.bounds().side_lengths().length()).into_iter().sum();
    let stopwatch = Stopwatch::new();
    let (mut hits, mut apart) = (0, 0);
    let mut workspace = Workspace::default();
    // The preparation of a solid in its first query does not count.
    placements.first().and_then(|first| first.distance([p, q], &mut workspace));
    let times = Comparison::in_blocks(
        placements,
        BLOCK,
        |placement| {
            let cast = placement.cast(p, q);
            let (answer, time) = stopwatch.time(|| cast.clearance_in(&mut workspace));
            let distance = match answer {
                Ok(Clearance::Overlapping(_)) => Some(0.0),
                Ok(answer) => answer.distance().filter(|d| d.is_finite()),
                Err(_) => None,
            };
            (distance, time)
        },
        |Placement { poses: [s, t], direction }| {
            let placed = ParrySetting::from_poses([s, t], *direction);
            stopwatch.time(|| placed.cast(&meshes[0], &meshes[1]))
        },
        |distance, other| {
            hits += usize::from(distance.is_some());
            let agree = match (distance, other) {
                (Some(x), Some(y)) => (x - y).abs() <= AGREEMENT * size,
                (None, None) => true,
                _ => false,
            };
            apart += usize::from(!agree);
        },
    );
    let row = json!({
        "group": group, "name": name, "facets": p.triangles().len() + q.triangles().len(),
        "settings": placements.len(), "hits": hits, "answers_apart": apart,
    });
    merge_objects(times.to_json(), row)
}

/// Measures the same bodies as solids and as convex polyhedra.
fn as_convex([p, q]: [&Solid; 2], placements: &[Placement]) -> Option<Comparison> {
    let hull = |body: &Solid| ConvexPolyhedron::from_points(body.vertices()).ok();
    let (a, b) = (hull(p)?, hull(q)?);
    let stopwatch = Stopwatch::new();
    let mut workspace = Workspace::default();
    let solids = |placement: &Placement| {
        let cast = placement.cast(p, q);
        ((), stopwatch.time(|| cast.clearance_in(&mut workspace)).1)
    };
    let polyhedra = |placement: &Placement| {
        let ([s, t], direction) = (placement.poses, placement.direction);
        let cast = Cast::new(a.at(s), b.at(t), direction).expect("poses in range");
        ((), stopwatch.time(|| cast.clearance()).1)
    };
    Some(Comparison::in_blocks(placements, BLOCK, solids, polyhedra, |(), ()| ()))
}

/// Measures the same body with more and more facets.
fn measure_growth(run: &mut Run) {
    let sizes = [16_000, 64_000, 256_000, 1_000_000];
    for size in run.choose(vec![sizes[0], sizes[3]], sizes.into()) {
        let mesh = bumpy_ball(size);
        let (body, build) = Stopwatch::new().time(|| solid_from_mesh(&mesh));
        let Some(body) = body else { continue };
        let mut random = run.random(&[7]);
        let placements: Vec<Placement> =
            (0..run.choose(20, 100)).map(|_| Placement::draw([1.2, 1.2], &mut random)).collect();
        let row = compare_libraries("growth", "bumpy ball", [&body, &body], &placements);
        let bytes = body.memory_bytes() as f64 / body.triangles().len() as f64;
        run.add(merge_objects(row, json!({ "build_ns": build, "bytes_per_facet": bytes })));
        println!("    built in {:.1} ms, {bytes:.0} bytes a facet", build / 1e6);
    }
}

/// Measures a slab on another one, at random places.
fn measure_slabs(run: &mut Run) {
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
    for parts in [[1, 1, 1], [4, 4, 1], [40, 40, 2], [180, 180, 4]] {
        let mesh = slab(DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 0.25), parts);
        let Some(body) = solid_from_mesh(&mesh) else { continue };
        for (name, height, direction) in cases {
            for (turned, rotation) in [("", DQuat::IDENTITY), (", turned", oblique)] {
                let mut random = run.random(&[9]);
                let pose = |at| Pose::new(rotation, rotation * at).unwrap_or(Pose::IDENTITY);
                let mut aside = || random.range(-0.4, 0.4);
                let placements: Vec<Placement> = (0..run.choose(50, 200))
                    .map(|_| Placement {
                        poses: [pose(DVec3::new(aside(), aside(), height)), pose(DVec3::ZERO)],
                        direction: rotation * direction,
                    })
                    .collect();
                run.add(compare_libraries(
                    "flat",
                    &format!("{name}{turned}"),
                    [&body; 2],
                    &placements,
                ));
            }
        }
    }
}
