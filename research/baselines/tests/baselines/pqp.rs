//! PQP against exact distances: all pairs of triangles for soups, whole bodies for convex ones.
//!
//! `S` is the size of both soups. Distances may have errors of [`GOAL`] `S`, and points may be this far from their
//! soups.

use colltrans::{ConvexPolyhedron, Pose};
use colltrans_baselines::pqp::{Pqp, Soup, SoupError};
use colltrans_testkit::bodies::body;
use colltrans_testkit::oracle::distance::{distance, distance_of_bodies};
use colltrans_testkit::oracle::exact::{Vector, place};
use colltrans_testkit::oracle::settings::{FAMILIES, setting};
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::{self, cuboid};
use glam::{DQuat, DVec3};

const GOAL: f64 = 1e-13;

/// Triangles as lists, so that an oracle can read them.
#[derive(Debug, Clone)]
struct Mesh {
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

impl Mesh {
    fn soup(&self) -> Soup {
        Soup::new(&self.vertices, &self.triangles).unwrap()
    }

    fn of_body(body: &ConvexPolyhedron) -> Self {
        let mut triangles = Vec::new();
        for face in 0..body.face_count() as u32 {
            let corners: Vec<u32> = body.face_vertices(face).collect();
            triangles.extend((2..corners.len()).map(|i| [corners[0], corners[i - 1], corners[i]]));
        }
        if triangles.is_empty() {
            triangles.push([0, 0, body.vertices().len() as u32 - 1]);
        }
        Self { vertices: body.vertices().to_vec(), triangles }
    }

    fn placed(&self, pose: &Pose) -> Vec<Vec<Vector>> {
        let at = |v: u32| self.vertices[v as usize];
        let corners = self.triangles.iter().map(|t| t.map(at));
        corners.map(|t| place(pose.matrix(), pose.translation(), &t)).collect()
    }
}

/// Returns the exact distance of the surfaces over all pairs of triangles.
fn brute_force((moving, at): (&Mesh, &Pose), (fixed, fixed_at): (&Mesh, &Pose)) -> f64 {
    let (moving, fixed) = (moving.placed(at), fixed.placed(fixed_at));
    let pairs = moving.iter().flat_map(|s| fixed.iter().map(move |t| (s, t)));
    pairs.map(|(s, t)| distance(s, t).to_f64()).fold(f64::INFINITY, f64::min)
}

fn size((moving, at): (&[DVec3], &Pose), (fixed, fixed_at): (&[DVec3], &Pose)) -> f64 {
    let reach = |points: &[DVec3]| points.iter().map(|p| p.length()).fold(0.0, f64::max);
    reach(moving) + reach(fixed) + at.translation().distance(fixed_at.translation())
}

/// Checks all queries on two soups with a known exact distance.
fn check(name: &str, pqp: &mut Pqp, at: &Pose, fixed_at: &Pose, truth: f64, size: f64) {
    let answer = pqp.distance(at, fixed_at);
    let report = format!("{name}: {answer:?}, exactly {truth:e}");
    let tolerance = GOAL * size;
    assert!((answer.distance - truth).abs() <= tolerance, "{report}");
    let away = 4.0 * f64::EPSILON * (answer.on_moving.length() + answer.on_fixed.length());
    let between = answer.on_moving.distance(answer.on_fixed);
    assert!((between - truth).abs() <= tolerance + away, "{report}");

    assert!(pqp.is_within(at, fixed_at, answer.distance + tolerance).0, "{report}");
    assert!(!pqp.is_within(at, fixed_at, truth - tolerance).0, "{report}");
    pqp.reset();
    assert!(pqp.is_within(at, fixed_at, truth + tolerance).0, "{report}");
    for part in [0.5, 0.9, 1.1, 2.0] {
        if truth > 20.0 * tolerance {
            assert_eq!(pqp.is_within(at, fixed_at, part * truth).0, part > 1.0, "{report}");
        }
    }
    let (meets, (contacts, _)) = (pqp.intersects(at, fixed_at).0, pqp.contact_count(at, fixed_at));
    assert_eq!(meets, contacts > 0, "{report}");
    if truth == 0.0 || truth > tolerance {
        assert_eq!(meets, truth == 0.0, "{report}");
    }

    pqp.reset();
    let (relative, absolute) = (0.3, 0.1 * size);
    let rough = pqp.distance_within(at, fixed_at, relative, absolute);
    let most = (truth * (1.0 + relative)).min(truth + absolute) + tolerance;
    assert!((truth - tolerance..=most).contains(&rough.distance), "{rough:?} {report}");
}

fn random_mesh(rng: &mut Random) -> Mesh {
    let count = rng.int(1, 12) as u32;
    let vertices: Vec<DVec3> = match rng.int(0, 2) {
        0 => (0..3 * count).map(|_| rng.grid(-2, 2)).collect(),
        1 => (0..3 * count).map(|_| rng.vector()).collect(),
        _ => {
            let thin = DVec3::new(1.0, rng.pick(&[1.0, 1e-3, 0.0]), rng.pick(&[1e-3, 1e-9, 0.0]));
            (0..3 * count).map(|_| rng.vector() * thin).collect()
        }
    };
    let any = |rng: &mut Random| rng.int(0, vertices.len() as i64 - 1) as u32;
    // Shared vertices, repeated triangles and degenerate ones included.
    let triangles = (0..count).map(|_| [0; 3].map(|_| any(rng))).collect();
    Mesh { vertices, triangles }
}

fn any_pose(rng: &mut Random, away: f64) -> Pose {
    let turn = if rng.one_in(2) { rng.rotation() } else { DQuat::IDENTITY };
    let at = if rng.one_in(2) { rng.grid(-2, 2) } else { rng.vector() };
    Pose::new(turn, at * away).unwrap()
}

#[test]
fn distance_of_soups_is_that_of_nearest_triangles() {
    let mut rng = Random::new(11);
    let mut touching = 0;
    for case in 0..400 {
        let moving = random_mesh(&mut rng);
        let mut fixed = if rng.one_in(6) { moving.clone() } else { random_mesh(&mut rng) };
        let away = rng.pick(&[0.0, 1.0, 2.0, 4.0, 4.0, 1e3]);
        let (at, mut fixed_at) = (any_pose(&mut rng, away), any_pose(&mut rng, 1.0));
        if rng.one_in(4) {
            // A corner of one is a corner of the other.
            (fixed.vertices[0], fixed_at) = (moving.vertices[0], at);
        }
        let truth = brute_force((&moving, &at), (&fixed, &fixed_at));
        let (soup, fixed_soup) = (moving.soup(), fixed.soup());
        let mut pqp = Pqp::new(&soup, &fixed_soup);
        let size = size((&moving.vertices, &at), (&fixed.vertices, &fixed_at));
        check(&format!("soup {case}"), &mut pqp, &at, &fixed_at, truth, size);
        touching += u32::from(truth == 0.0);
    }
    assert!((40..360).contains(&touching), "{touching}");
}

#[test]
fn tree_search_equals_brute_force() {
    let mut rng = Random::new(12);
    for case in 0..4 {
        let mut mesh = || {
            let vertices: Vec<DVec3> = (0..150).map(|_| rng.direction()).collect();
            let any = |rng: &mut Random| rng.int(0, 149) as u32;
            let near = |v: u32, rng: &mut Random| (v + rng.int(0, 9) as u32) % 150;
            let triangle = |rng: &mut Random| {
                let first = any(rng);
                [first, near(first, rng), near(first, rng)]
            };
            Mesh { triangles: (0..120).map(|_| triangle(&mut rng)).collect(), vertices }
        };
        let (moving, fixed) = (mesh(), mesh());
        let at = Pose::new(rng.rotation(), DVec3::X * rng.range(1.6, 2.4)).unwrap();
        let single = |mesh: &Mesh, i: usize| Soup::new(&mesh.vertices, &[mesh.triangles[i]]);
        let alone = |mesh: &Mesh| (0..120).map(|i| single(mesh, i).unwrap()).collect::<Vec<_>>();
        let (movings, fixeds) = (alone(&moving), alone(&fixed));
        let (mut truth, mut contacts) = (f64::INFINITY, 0);
        for (s, t) in movings.iter().flat_map(|s| fixeds.iter().map(move |t| (s, t))) {
            let mut pqp = Pqp::new(s, t);
            truth = truth.min(pqp.distance(&at, &Pose::IDENTITY).distance);
            contacts += u64::from(pqp.intersects(&at, &Pose::IDENTITY).0);
        }
        let (soup, fixed_soup) = (moving.soup(), fixed.soup());
        let mut pqp = Pqp::new(&soup, &fixed_soup);
        check(&format!("large {case}"), &mut pqp, &at, &Pose::IDENTITY, truth, 6.0);
        assert_eq!(pqp.contact_count(&at, &Pose::IDENTITY).0, contacts);
    }
}

#[test]
fn convex_bodies_of_all_families() {
    let mut apart = 0;
    for &(family, _) in FAMILIES {
        for seed in 0..30 {
            let setting = setting(family, seed);
            let bodies = setting.bodies().unwrap();
            let (at, fixed_at) = (&setting.moving_pose, &setting.fixed_pose);
            let mut truth =
                distance_of_bodies((&bodies.moving, at), (&bodies.fixed, fixed_at)).to_f64();
            if truth == 0.0 {
                // One may be inside the other.
                let (moving, fixed) = (Mesh::of_body(&bodies.moving), Mesh::of_body(&bodies.fixed));
                truth = brute_force((&moving, at), (&fixed, fixed_at));
            }
            apart += u32::from(truth > 0.0);
            let size = size((bodies.moving.vertices(), at), (bodies.fixed.vertices(), fixed_at));
            let soups = [&bodies.moving, &bodies.fixed].map(Soup::of_polyhedron);
            let mut pqp = Pqp::new(&soups[0], &soups[1]);
            check(&setting.to_string(), &mut pqp, at, fixed_at, truth, size);
        }
    }
    assert!(apart > 200, "{apart}");
}

fn prism(sides: u32, axes: DVec3) -> ConvexPolyhedron {
    body(&shapes::prism(sides as usize, 1.0).mapped(|v| v * axes).vertices)
}

#[test]
fn needles_and_plates() {
    let mut rng = Random::new(13);
    let thin = [DVec3::new(1e-3, 1e-3, 1.0), DVec3::new(1.0, 1.0, 1e-3)];
    for case in 0..120 {
        let sides = rng.pick(&[3, 8, 24]);
        let bodies = [0; 2].map(|_| prism(sides, rng.pick(&thin)));
        let away = rng.pick(&[0.01, 0.5, 1.5]);
        let at = any_pose(&mut rng, away);
        let fixed_at = any_pose(&mut rng, 0.5);
        let truth = distance_of_bodies((&bodies[0], &at), (&bodies[1], &fixed_at)).to_f64();
        if truth == 0.0 {
            continue;
        }
        let size = size((bodies[0].vertices(), &at), (bodies[1].vertices(), &fixed_at));
        let soups = [0, 1].map(|i| Soup::of_polyhedron(&bodies[i]));
        let mut pqp = Pqp::new(&soups[0], &soups[1]);
        check(&format!("thin {case}"), &mut pqp, &at, &fixed_at, truth, size);
    }
}

/// All pairs of triangles of two parallel faces are equally far apart. The search must not visit all of them.
#[test]
fn parallel_faces_take_few_steps() {
    for sides in [16, 128, 1024] {
        let soup = Soup::of_polyhedron(&prism(sides, DVec3::ONE));
        let mut rng = Random::new(14);
        for gap in [0.5, 1e-3, 1e-6, 1e-9, 0.0] {
            let turn = rng.rotation();
            let at = Pose::new(turn, turn * DVec3::new(0.1, 0.2, 2.0 + gap)).unwrap();
            let fixed_at = Pose::new(turn, DVec3::ZERO).unwrap();
            let mut pqp = Pqp::new(&soup, &soup);
            let answer = pqp.distance(&at, &fixed_at);
            assert!((answer.distance - gap).abs() < GOAL * 5.0, "{answer:?}");
            // Proportional to n log n, not to n^2.
            let most = 40 * u64::from(sides * sides.ilog2());
            assert!(answer.steps.volume_tests < most, "{sides}, {gap:e}: {answer:?}");
        }
    }
}

/// Faces with very many corners next to each other. With fans, the volumes of triangles would overlap, and nearly all
/// pairs would be visited.
#[test]
fn large_faces_take_few_steps() {
    for sides in [64, 512, 4096] {
        let soup = Soup::of_polyhedron(&prism(sides, DVec3::ONE));
        assert_eq!(soup.triangle_count(), 4 * sides as usize - 4);
        let mut rng = Random::new(16);
        let mut tests = 0;
        for _ in 0..20 {
            let at = Pose::new(rng.rotation(), rng.direction() * 3.0).unwrap();
            let fixed_at = Pose::new(rng.rotation(), DVec3::ZERO).unwrap();
            tests += Pqp::new(&soup, &soup).distance(&at, &fixed_at).steps.volume_tests;
        }
        assert!(tests < 20 * 60 * u64::from(sides), "{sides}: {tests}");
    }
}

#[test]
fn coherence_does_not_change_answers() {
    let mut rng = Random::new(15);
    let cloud = |rng: &mut Random, n| body(&(0..n).map(|_| rng.direction()).collect::<Vec<_>>());
    for case in 0..20 {
        let (moving, fixed) = (cloud(&mut rng, 60), cloud(&mut rng, 90));
        let soups = [&moving, &fixed].map(Soup::of_polyhedron);
        let mut coherent = Pqp::new(&soups[0], &soups[1]);
        let axis = rng.direction();
        let spin = rng.direction();
        let (mut less, mut more) = (0, 0);
        for step in 0..60 {
            let time = f64::from(step) / 60.0;
            let away = axis * (3.0 - 1.2 * time) + DVec3::X * 1e5;
            let at = Pose::new(DQuat::from_axis_angle(spin, time), away).unwrap();
            let fixed_at = Pose::from_translation(DVec3::X * 1e5).unwrap();
            let again = coherent.distance(&at, &fixed_at);
            let fresh = Pqp::new(&soups[0], &soups[1]).distance(&at, &fixed_at);
            let size = size((moving.vertices(), &at), (fixed.vertices(), &fixed_at));
            assert!((again.distance - fresh.distance).abs() <= 1e-13 * size, "{case}, {step}");
            less += again.steps.triangle_tests;
            more += fresh.steps.triangle_tests;
        }
        assert!(less < more, "{case}: {less} {more}");
    }
}

#[test]
fn common_displacement_costs_no_accuracy() {
    let cube = Soup::of_polyhedron(&body(&cuboid(DVec3::ONE).vertices));
    for displacement in [0.0, 1e6, 1e12] {
        let fixed_at = Pose::from_translation(DVec3::splat(displacement)).unwrap();
        let at = fixed_at.translated_by(DVec3::new(0.0, 3.0, 4.0)).unwrap();
        let offset = at.translation() - fixed_at.translation();
        let truth = (offset.y - 2.0).hypot(offset.z - 2.0);
        let answer = Pqp::new(&cube, &cube).distance(&at, &fixed_at);
        assert!((answer.distance - truth).abs() < 1e-14, "{answer:?} {truth}");
    }
}

#[test]
fn nested_surfaces_do_not_intersect() {
    let soups =
        [1.0, 3.0].map(|half| Soup::of_polyhedron(&body(&cuboid(DVec3::splat(half)).vertices)));
    let mut pqp = Pqp::new(&soups[0], &soups[1]);
    let at = Pose::from_translation(DVec3::X * 0.5).unwrap();
    assert_eq!(pqp.distance(&at, &Pose::IDENTITY).distance, 1.5);
    assert!(!pqp.intersects(&at, &Pose::IDENTITY).0);
    assert!(!pqp.is_within(&at, &Pose::IDENTITY, 1.4).0);
}

#[test]
fn flat_bodies_are_soups() {
    let [point, segment, square] = [
        body(&[DVec3::new(0.0, 0.0, 2.0)]),
        body(&[DVec3::new(-1.0, 0.0, 1.0), DVec3::new(1.0, 0.0, 1.0)]),
        body(&[DVec3::X, DVec3::Y, -DVec3::X, -DVec3::Y]),
    ]
    .map(|b| Soup::of_polyhedron(&b));
    assert_eq!([&point, &segment, &square].map(Soup::triangle_count), [1, 1, 2]);
    let apart = |a, b| Pqp::new(a, b).distance(&Pose::IDENTITY, &Pose::IDENTITY).distance;
    assert_eq!(apart(&point, &segment), 1.0);
    assert_eq!(apart(&segment, &square), 1.0);
    assert_eq!(apart(&square, &point), 2.0);
    assert_eq!(apart(&point, &point), 0.0);
}

#[test]
fn invalid_soups_are_rejected() {
    let vertices = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let refused = |vertices: &[DVec3], triangles: &[[u32; 3]]| Soup::new(vertices, triangles).err();
    assert_eq!(refused(&vertices, &[]), Some(SoupError::Empty));
    let unknown = SoupError::UnknownVertex { triangle: 1, vertex: 7, vertices: 3 };
    assert_eq!(refused(&vertices, &[[0, 1, 2], [0, 7, 2]]), Some(unknown));
    let nan = [DVec3::ZERO, DVec3::NAN, DVec3::Y];
    assert_eq!(refused(&nan, &[[0, 1, 2]]), Some(SoupError::NotFinite { vertex: 1 }));
    let far = [DVec3::ZERO, DVec3::X, DVec3::Y * 1e100];
    assert_eq!(refused(&far, &[[0, 1, 2]]), Some(SoupError::OutOfRange { vertex: 2 }));
    assert!(unknown.to_string().contains("triangle 1 refers to vertex 7"));
}

#[test]
fn queries_allocate_nothing() {
    let mut rng = Random::new(16);
    let soups = [700, 900].map(|n| {
        let points: Vec<DVec3> = (0..n).map(|_| rng.direction()).collect();
        Soup::of_polyhedron(&body(&points))
    });
    let mut pqp = Pqp::new(&soups[0], &soups[1]);
    let info = allocation_counter::measure(|| {
        for _ in 0..50 {
            let away = rng.range(1.0, 3.0);
            let at = Pose::new(rng.rotation(), DVec3::X * away).unwrap();
            pqp.reset();
            let distance = pqp.distance(&at, &Pose::IDENTITY).distance;
            pqp.is_within(&at, &Pose::IDENTITY, 0.99 * distance);
            pqp.contact_count(&at, &Pose::IDENTITY);
        }
    });
    assert_eq!(info.count_total, 0);
}

/// For slivers, the volume with the longer diagonal is replaced by its children, as in the authors' program, which
/// takes 4,738 and 12,139 tests here. Using the longer side alone takes 5,693 and 14,052.
#[test]
fn searches_of_slivers_take_few_tests() {
    for (around, rings, expected) in [(16, 200, 4_700.0), (8, 400, 12_100.0)] {
        let mut rng = Random::new(7);
        let (mut tests, mut count) = (0, 0);
        for _ in 0..6 {
            let soups = [0, 1].map(|_| {
                let axes = DVec3::from_array([0; 3].map(|_| rng.range(0.6, 1.4)));
                let mesh = shapes::ring_sphere(around, rings).mapped(|v| v * axes);
                let body =
                    ConvexPolyhedron::from_mesh(&mesh.vertices, &mesh.faces, 64.0 * f64::EPSILON);
                Soup::of_polyhedron(&body.expect("an ellipsoid"))
            });
            let mut pqp = Pqp::new(&soups[0], &soups[1]);
            for _ in 0..60 {
                let here = Pose::new(rng.rotation(), DVec3::ZERO).unwrap();
                let turn = rng.rotation();
                let there = Pose::new(turn, rng.direction() * rng.range(2.0, 4.0)).unwrap();
                pqp.reset();
                let found = pqp.distance(&here, &there);
                if found.distance > 0.0 {
                    tests += found.steps.volume_tests;
                    count += 1;
                }
            }
        }
        let each = tests as f64 / f64::from(count);
        assert!((each / expected - 1.0).abs() < 0.05, "{around} by {rings}: {each}");
    }
}
