//! Compares the minimisation with brute force.

use glam::{DQuat, DVec2, DVec3};

use super::cell::face_of_edge;
use super::crossing::{Chain, Crossing};
use super::minimise::{NarrowedSearch, minimise};
use super::options::Cuts;
use super::planar::{self, LastAnswer, PlanarAnswer, PlanarHint};
use super::section::Section;
use super::section_pair::SectionPair;
use super::sectioned_body::SectionedBody;
use super::{ContactGuess, MinimisationOptions, MinimisationStart};
use crate::answer::Steps;
use crate::body::ConvexPolyhedron;
use crate::body::Pose;
use crate::body::convex::tests::bodies::{Random, cone, cuboid, ellipsoid, prism, thin_ellipsoid};
use crate::setting::Setting;
use crate::setting::minkowski::MinkowskiDifference;
use crate::solve::observe::{NoObserver, Observer, Watch};
use crate::solve::portal;

/// Number of exit tests, and of those that ended a search.
#[derive(Debug, Default)]
struct ExitCounter {
    tests: u32,
    hits: u32,
}

impl Observer for ExitCounter {
    fn exit_test(&mut self, solved: impl FnOnce() -> bool) {
        self.tests += 1;
        self.hits += u32::from(solved());
    }
}

/// Returns the result of a minimisation and the work that it took.
fn minimise_counting_steps(
    setting: &Setting,
    options: &MinimisationOptions,
) -> (NarrowedSearch, Steps) {
    let mut none = NoObserver;
    let mut watch = Watch::new(&mut none);
    let narrowed = minimise(setting, options, &mut watch);
    (narrowed, watch.steps)
}

/// Result of the brute-force search.
#[derive(Debug)]
enum BruteForce {
    Contact(f64),
    Separated,
    /// The shadows only touch: rounding decides.
    Grazing,
}

struct PlacedMesh {
    vertices: Vec<DVec3>,
    normals: Vec<DVec3>,
    edges: Vec<DVec3>,
}

impl PlacedMesh {
    fn new(body: &ConvexPolyhedron, pose: &Pose) -> Self {
        let vertices: Vec<DVec3> =
            body.vertices().iter().map(|&v| pose.transform_point(v)).collect();
        let normals = (0..body.face_count() as u32)
            .map(|face| {
                let corners: Vec<DVec3> =
                    body.face_vertices(face).map(|v| vertices[v as usize]).collect();
                let pairs =
                    corners.windows(2).map(|w| (w[0] - corners[0]).cross(w[1] - corners[0]));
                pairs.sum::<DVec3>().normalize()
            })
            .collect();
        let edges = (0..vertices.len() as u32)
            .flat_map(|v| body.neighbours(v).iter().map(move |&w| (v, w)))
            .filter(|(v, w)| v < w)
            .map(|(v, w)| (vertices[w as usize] - vertices[v as usize]).normalize())
            .collect();
        Self { vertices, normals, edges }
    }
}

/// Computes the greatest lower bound over all normals that can be optimal: those of faces and of pairs of
/// edges.
fn brute_force_contact(p: &PlacedMesh, q: &PlacedMesh, d: DVec3) -> BruteForce {
    let margin = |n: DVec3| {
        let of_p = p.vertices.iter().map(|v| n.dot(*v)).fold(f64::NEG_INFINITY, f64::max);
        q.vertices.iter().map(|v| n.dot(*v)).fold(f64::INFINITY, f64::min) - of_p
    };
    let mut apart = f64::NEG_INFINITY;
    for e in p.edges.iter().chain(&q.edges) {
        let n = e.cross(d);
        if n.length() > 1e-9 {
            let n = n.normalize();
            apart = apart.max(margin(n)).max(margin(-n));
        }
    }
    if apart.abs() < 1e-12 {
        return BruteForce::Grazing;
    }
    if apart > 0.0 {
        return BruteForce::Separated;
    }
    let mut candidates: Vec<DVec3> = p.normals.clone();
    candidates.extend(&q.normals);
    for e in &p.edges {
        candidates.extend(q.edges.iter().map(|f| e.cross(*f)));
    }
    let bounds = candidates.into_iter().filter_map(|n| {
        let n = n.try_normalize()?;
        let n = if n.dot(d) < 0.0 { -n } else { n };
        (n.dot(d) > 1e-9).then(|| margin(n) / n.dot(d))
    });
    BruteForce::Contact(bounds.fold(f64::NEG_INFINITY, f64::max))
}

const EXACT: MinimisationOptions = MinimisationOptions {
    start: MinimisationStart::Center,
    gap: 1e-10,
    keeps_to_cell: false,
    cuts: Cuts::Shifted,
    starts_cold: false,
};

/// Compares a minimisation with brute force to `tolerance`, and returns its result.
fn check_against_brute_force(
    (p, p_pose): (&ConvexPolyhedron, &Pose),
    (q, q_pose): (&ConvexPolyhedron, &Pose),
    d: DVec3,
    tolerance: f64,
    name: &str,
) -> NarrowedSearch {
    let setting = Setting::new(p.at(*p_pose), q.at(*q_pose), d).unwrap();
    let narrowed = minimise_counting_steps(&setting, &EXACT).0;
    let truth =
        brute_force_contact(&PlacedMesh::new(p, p_pose), &PlacedMesh::new(q, q_pose), setting.unit);
    match (&truth, narrowed.guess) {
        (BruteForce::Contact(t), ContactGuess::Contact { normal }) => {
            assert!((narrowed.upper - t).abs() <= tolerance, "{name}: {truth:?} {narrowed:?}");
            assert!((narrowed.lower - t).abs() <= tolerance, "{name}: {truth:?} {narrowed:?}");
            assert!((normal.dot(setting.unit) - 1.0).abs() < 1e-6, "{name}: {narrowed:?}");
            // The normal proves the lower bound.
            let world = PlacedMesh::new(p, p_pose);
            let fixed = PlacedMesh::new(q, q_pose);
            let of_p =
                world.vertices.iter().map(|v| normal.dot(*v)).fold(f64::NEG_INFINITY, f64::max);
            let of_q = fixed.vertices.iter().map(|v| normal.dot(*v)).fold(f64::INFINITY, f64::min);
            assert!(
                (of_q - of_p - t).abs() <= tolerance,
                "{name}: {truth:?} {narrowed:?} {}",
                of_q - of_p
            );
        }
        (BruteForce::Separated, ContactGuess::Separation { .. }) | (BruteForce::Grazing, _) => {}
        _ => panic!("{name}: {truth:?} {narrowed:?}"),
    }
    narrowed
}

fn random_pose(random: &mut Random, spread: f64) -> Pose {
    let translation = DVec3::new(random.signed(), random.signed(), random.signed()) * spread;
    Pose::new(random.rotation(), translation).unwrap()
}

#[test]
fn random_bodies_agree_with_brute_force() {
    let mut random = Random(7);
    for round in 0..2000 {
        let mut body = || {
            let axes = DVec3::new(
                random.within(0.6, 1.4),
                random.within(0.6, 1.4),
                random.within(0.6, 1.4),
            );
            match random.index(4) {
                0 => ellipsoid(8 + random.index(30), axes),
                1 => prism(3 + random.index(6), axes),
                2 => cone(3 + random.index(6), axes),
                _ => cuboid(axes, axes),
            }
        };
        let (p, q) = (body(), body());
        let (p_pose, q_pose) = (random_pose(&mut random, 1.0), random_pose(&mut random, 1.0));
        let d = random.unit();
        check_against_brute_force((&p, &p_pose), (&q, &q_pose), d, 1e-8, &format!("round {round}"));
    }
}

#[test]
fn bodies_with_ties_agree_with_brute_force() {
    let mut random = Random(13);
    let bodies = [
        cuboid(DVec3::ZERO, DVec3::ONE),
        cuboid(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0)),
        cuboid(DVec3::ONE, DVec3::ONE),
        prism(4, DVec3::ONE),
        prism(6, DVec3::ONE),
        cone(4, DVec3::ONE),
        ellipsoid(8, DVec3::ONE),
        ellipsoid(32, DVec3::ONE),
    ];
    let directions =
        [DVec3::Z, DVec3::NEG_X, DVec3::new(1.0, 1.0, 0.0), DVec3::ONE, DVec3::new(1.0, 2.0, 0.0)];
    let rotations = [
        DQuat::IDENTITY,
        DQuat::from_rotation_z(std::f64::consts::FRAC_PI_4),
        DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2),
    ];
    for (i, p) in bodies.iter().enumerate() {
        for (j, q) in bodies.iter().enumerate() {
            for d in directions {
                for rotation in rotations {
                    for shift in [
                        DVec3::ZERO,
                        DVec3::X,
                        DVec3::new(0.5, 0.0, 3.0),
                        DVec3::new(1.0, 1.0, 0.25),
                        DVec3::new(2.0, 0.0, 5.0),
                    ] {
                        let pose = Pose::new(rotation, shift).unwrap();
                        let name = format!("bodies {i} {j} {d} {rotation} {shift}");
                        let setting = Setting::new(p.at(Pose::IDENTITY), q.at(pose), d).unwrap();
                        check_planar(&setting, &mut random, &name);
                        check_against_brute_force((p, &Pose::IDENTITY), (q, &pose), d, 1e-8, &name);
                    }
                }
            }
        }
    }
}

/// Computes the lower bound of the collision translation that a normal proves, by a scan of all vertices.
fn bound_proven_by(normal: DVec3, p: &PlacedMesh, q: &PlacedMesh, d: DVec3) -> f64 {
    let of_p = p.vertices.iter().map(|v| normal.dot(*v)).fold(f64::NEG_INFINITY, f64::max);
    let of_q = q.vertices.iter().map(|v| normal.dot(*v)).fold(f64::INFINITY, f64::min);
    (of_q - of_p) / normal.dot(d)
}

#[test]
fn needles_plates_and_large_caps_have_certified_bounds() {
    let mut random = Random(17);
    let bodies = [
        ellipsoid(3000, DVec3::ONE),
        ellipsoid(3000, DVec3::new(1000.0, 1.0, 1.0)),
        ellipsoid(3000, DVec3::new(1000.0, 1000.0, 1.0)),
        prism(1000, DVec3::ONE),
        prism(1000, DVec3::new(1.0, 1.0, 1e-3)),
        cone(1000, DVec3::new(1.0, 1.0, 3.0)),
    ];
    for round in 0..400 {
        let p = &bodies[random.index(bodies.len())];
        let q = &bodies[random.index(bodies.len())];
        let d = random.unit();
        let poses = [0.0, 3.0].map(|t| Pose::new(random.rotation(), d * t).unwrap());
        let setting = Setting::new(p.at(poses[0]), q.at(poses[1]), d).unwrap();
        let narrowed = minimise_counting_steps(&setting, &EXACT).0;
        let (p, q) = (PlacedMesh::new(p, &poses[0]), PlacedMesh::new(q, &poses[1]));
        let size = p.vertices.iter().chain(&q.vertices).map(|v| v.length()).fold(0.0, f64::max);
        // Both centres are on the line, therefore the bodies meet.
        let ContactGuess::Contact { normal } = narrowed.guess else {
            panic!("round {round}: {narrowed:?}")
        };
        let proven = bound_proven_by(normal, &p, &q, setting.unit);
        let (lower, upper) = (narrowed.lower, narrowed.upper);
        assert!((proven - lower).abs() < 1e-9 * size, "round {round}: {narrowed:?} {proven}");
        assert!(upper - lower < 1e-6 * size, "round {round}: {narrowed:?}");
        assert!(upper - lower > -1e-9 * size, "round {round}: {narrowed:?}");
    }
}

#[test]
fn exit_test_ends_99_percent_of_contact_searches() {
    let mut random = Random(23);
    let bodies = [
        ellipsoid(30, DVec3::ONE),
        ellipsoid(60, DVec3::new(1.0, 0.7, 1.3)),
        ellipsoid(60, DVec3::new(100.0, 1.0, 1.0)),
        prism(5, DVec3::ONE),
        cone(6, DVec3::ONE),
        cuboid(DVec3::ZERO, DVec3::ONE),
    ];
    let mut counted = ExitCounter::default();
    let mut contacts = 0;
    for round in 0..500 {
        let (p, q) = (&bodies[random.index(bodies.len())], &bodies[random.index(bodies.len())]);
        let Example { poses, d } = colliding_setting(&mut random);
        let setting = Setting::new(p.at(poses[0]), q.at(poses[1]), d).unwrap();
        let mut exits = ExitCounter::default();
        let narrowed = minimise(&setting, &EXACT, &mut Watch::new(&mut exits));
        let truth = brute_force_contact(
            &PlacedMesh::new(p, &poses[0]),
            &PlacedMesh::new(q, &poses[1]),
            setting.unit,
        );
        let BruteForce::Contact(t) = truth else { continue };
        contacts += 1;
        counted.tests += exits.tests;
        counted.hits += exits.hits;
        // No search continues after a hit, and no hit is wrong.
        assert!(exits.hits <= 1, "round {round}");
        assert!(
            exits.hits == 0 || (narrowed.lower - t).abs() < 1e-7,
            "round {round}: {narrowed:?}"
        );
    }
    assert!(contacts > 250 && counted.hits * 100 >= contacts * 99, "{contacts} {counted:?}");
    // Fewer than half of the tests hit, so a hit is not the only possible result.
    assert!(counted.tests > 2 * counted.hits, "{counted:?}");
}

#[test]
fn exit_on_many_sided_face_gives_corners_around_the_line() {
    let mut random = Random(37);
    let point = ellipsoid(200, DVec3::splat(0.2));
    let mut hits = 0;
    for round in 0..600 {
        let face = prism(4 + random.index(60), DVec3::ONE);
        // The bodies meet at a cap, from either side and with either body moving.
        let along = DVec3::new(0.3 * random.signed(), 0.3 * random.signed(), 1.0);
        let cap = if random.index(2) == 0 { -along } else { along };
        let aside = DVec3::new(random.signed(), random.signed(), 0.0) * 0.6;
        let [rest, start] =
            [DVec3::ZERO, aside - cap * 4.0].map(|at| Pose::new(DQuat::IDENTITY, at).unwrap());
        let setting = if random.index(2) == 0 {
            Setting::new(point.at(start), face.at(rest), cap).unwrap()
        } else {
            Setting::new(face.at(rest), point.at(start), -cap).unwrap()
        };
        let mut exits = ExitCounter::default();
        let narrowed = minimise(&setting, &EXACT, &mut Watch::new(&mut exits));
        let Some(corners) = narrowed.corners else { continue };
        hits += exits.hits;
        let difference = MinkowskiDifference::new(&setting);
        assert!(
            portal::pierced_triangle(&difference, &corners).is_some(),
            "round {round}: {corners:?}"
        );
    }
    assert!(hits > 550, "{hits}");
}

#[test]
fn shifts_within_cells_need_a_quarter_more_planar_problems() {
    let one_by_one = MinimisationOptions { keeps_to_cell: true, ..EXACT };
    let mut random = Random(47);
    let bodies = ellipsoid_pair(2000, false);
    let (mut within, mut crossed) = (0, 0);
    for round in 0..300 {
        let e = colliding_setting(&mut random);
        let [p, q] = &bodies;
        let setting = Setting::new(p.at(e.poses[0]), q.at(e.poses[1]), e.d).unwrap();
        let [(a, one), (b, more)] =
            [&one_by_one, &EXACT].map(|o| minimise_counting_steps(&setting, o));
        // Both end at the same contact, or both find none.
        let same = a.upper == b.upper || (a.upper - b.upper).abs() < 1e-8;
        assert!(same, "round {round}: {} {}", a.upper, b.upper);
        within += one.planar_problems;
        crossed += more.planar_problems;
    }
    assert!(within * 4 > crossed * 5, "{within} {crossed}");
}

/// Cuts through the planar problem's value and cold starts find the same contact with more work.
#[test]
fn centroid_cuts_and_cold_starts_reach_same_contact_with_more_work() {
    let paper = MinimisationOptions { keeps_to_cell: true, ..EXACT };
    let centroid = MinimisationOptions { cuts: Cuts::Centroid, ..paper };
    let cold = MinimisationOptions { starts_cold: true, ..paper };
    let mut random = Random(53);
    let bodies = ellipsoid_pair(500, false);
    let mut work = [Steps::default(); 3];
    for round in 0..200 {
        let e = colliding_setting(&mut random);
        let [p, q] = &bodies;
        let setting = Setting::new(p.at(e.poses[0]), q.at(e.poses[1]), e.d).unwrap();
        let found = [&paper, &centroid, &cold].map(|o| minimise_counting_steps(&setting, o));
        for (narrowed, _) in &found[1..] {
            let [a, b] = [found[0].0.upper, narrowed.upper];
            assert!(a == b || (a - b).abs() < 1e-8, "round {round}: {a} {b}");
        }
        work.iter_mut().zip(found).for_each(|(sum, (_, steps))| *sum += steps);
    }
    let [paper, centroid, cold] = work;
    assert!(12 * centroid.planar_problems > 13 * paper.planar_problems, "{centroid:?} {paper:?}");
    assert_eq!(cold.planar_problems, paper.planar_problems);
    assert!(4 * cold.iterations > 5 * paper.iterations, "{cold:?} {paper:?}");
}

/// The steps of a minimisation and their preparation take no square root (the paper, V-A), by this name or
/// another.
#[test]
fn steps_take_no_square_roots() {
    let sources = [
        include_str!("bound.rs"),
        include_str!("cell.rs"),
        include_str!("crossing.rs"),
        include_str!("exit.rs"),
        include_str!("minimise.rs"),
        include_str!("section_pair.rs"),
        include_str!("piece.rs"),
        include_str!("planar/mod.rs"),
        include_str!("planar/snapshot_guess.rs"),
        include_str!("planar/chain_walk.rs"),
        include_str!("region.rs"),
        include_str!("section.rs"),
        include_str!("sectioned_body.rs"),
        include_str!("start.rs"),
        include_str!("../../body/convex/sections/chains.rs"),
        include_str!("../../body/convex/sections/walk.rs"),
    ];
    for source in sources {
        let code = source.split("#[cfg(test)]").next().unwrap();
        for (k, line) in code.lines().enumerate() {
            // The exception computes a value for observers alone.
            if line.contains("(1.0 / u.length(), 0.0)") {
                continue;
            }
            for root in ["sqrt", "normalize", ".length()", "length_recip", "distance("] {
                assert!(!line.contains(root), "line {}: {line}", k + 1);
            }
        }
    }
}

#[test]
fn ten_planar_problems_suffice_on_average_up_to_20000_vertices() {
    for count in [8, 128, 2000, 20_000] {
        let mut random = Random(19);
        let [p, q] = [0, 1].map(|_| {
            let axes = [0, 1, 2].map(|_| random.within(0.6, 1.4));
            ellipsoid(count, DVec3::from_array(axes))
        });
        let mut steps = 0;
        let options = MinimisationOptions { gap: 2.5e-3, ..EXACT };
        for _ in 0..300 {
            let e = colliding_setting(&mut random);
            let setting = Setting::new(p.at(e.poses[0]), q.at(e.poses[1]), e.d).unwrap();
            steps += minimise_counting_steps(&setting, &options).1.planar_problems;
        }
        assert!(
            steps <= 300 * 10,
            "{count} vertices: {} steps on average",
            f64::from(steps) / 300.0
        );
    }
}

/// Poses and direction of a setting.
struct Example {
    poses: [Pose; 2],
    d: DVec3,
}

/// Returns random poses. The origin of the fixed body is 5 ahead along `d`, and at most 1 off the line.
fn colliding_setting(random: &mut Random) -> Example {
    let d = random.unit();
    let across = random.unit().cross(d).normalize() * random.within(0.0, 1.0);
    let poses = [DVec3::ZERO, d * 5.0 + across]
        .map(|translation| Pose::new(random.rotation(), translation).unwrap());
    Example { poses, d }
}

/// Returns all vertices of a section in order, from the bottom up the left chain.
fn section_polygon(side: &SectionedBody, level: f64) -> Vec<Crossing> {
    let section = Section { side, level, max_steps: side.topology.edge_count() };
    let above = |h: &u32| {
        side.vertex_level(side.topology.origin(*h)) <= level
            && side.vertex_level(side.topology.target(*h)) > level
    };
    let crossing = (0..side.topology.half_edges().len() as u32).find(above).unwrap();
    let first = section.find_bottom(crossing).unwrap().vertex;
    let mut all = vec![first];
    loop {
        let next = section.next_vertex(Chain::Left, &all[all.len() - 1]);
        if next.half_edge == first.half_edge {
            return all;
        }
        all.push(next);
    }
}

#[test]
fn planar_problems_agree_with_brute_force() {
    let mut random = Random(5);
    for round in 0..3000 {
        let mut body = || match random.index(4) {
            0 => ellipsoid(8 + random.index(60), DVec3::ONE),
            1 => prism(3 + random.index(6), DVec3::ONE),
            2 => cone(3 + random.index(6), DVec3::ONE),
            _ => cuboid(DVec3::ZERO, DVec3::ONE),
        };
        let (p, q) = (body(), body());
        let (p_pose, q_pose) = (random_pose(&mut random, 1.0), random_pose(&mut random, 1.0));
        let setting = Setting::new(p.at(p_pose), q.at(q_pose), random.unit()).unwrap();
        check_planar(&setting, &mut random, &format!("round {round}"));
    }
}

/// The bodies have chains because their sections have many edges.
#[test]
fn planar_problems_with_chains_agree_with_brute_force() {
    let mut random = Random(6);
    let (p, q) = (&cone(800, DVec3::ONE), &cone(700, DVec3::new(1.0, 0.7, 1.3)));
    for round in 0..5 {
        let poses = [random_pose(&mut random, 1.0), random_pose(&mut random, 1.0)];
        let setting = Setting::new(p.at(poses[0]), q.at(poses[1]), random.unit()).unwrap();
        check_planar(&setting, &mut random, &format!("round {round}"));
    }
}

/// Computes the least height common to two polygons, from all vertices and all pairs of edges. Infinite if the
/// polygons are disjoint.
fn least_common_height(polygons: &[Vec<Crossing>; 2]) -> f64 {
    let edges = |i: usize| {
        let of: &Vec<Crossing> = &polygons[i];
        (0..of.len()).map(move |k| (of[k].w, of[(k + 1) % of.len()].w))
    };
    // Clockwise with g to the right and h upwards.
    let inside = |i: usize, w: DVec2| edges(i).all(|(s, t)| (t - s).perp_dot(w - s) >= -1e-12);
    let mut least = f64::INFINITY;
    for (i, polygon) in polygons.iter().enumerate() {
        for c in polygon {
            if inside(1 - i, c.w) {
                least = least.min(c.h());
            }
        }
    }
    for (a, b) in edges(0) {
        for (c, e) in edges(1) {
            let (r, s) = (b - a, e - c);
            let cross = r.perp_dot(s);
            if cross.abs() < 1e-9 * r.length() * s.length() {
                continue;
            }
            let (u, v) = ((c - a).perp_dot(s) / cross, (c - a).perp_dot(r) / cross);
            if (0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v) {
                least = least.min((a + r * u).x);
            }
        }
    }
    least
}

/// Compares the answer of a planar problem with brute force, for several hints.
fn check_planar(setting: &Setting, random: &mut Random, name: &str) {
    let query = SectionPair::new(setting);
    let levels = [0, 1].map(|i| {
        let [low, high] = query.sides[i].level_range();
        random.within(low, high)
    });
    let polygons = [0, 1].map(|i| section_polygon(&query.sides[i], levels[i]));
    for (i, polygon) in polygons.iter().enumerate() {
        let least = polygon.iter().map(Crossing::h).fold(f64::INFINITY, f64::min);
        assert!(polygon[0].h() - least < 1e-12, "{name}, side {i}");
    }
    let least = least_common_height(&polygons);
    let check = |hint: &PlanarHint, name: &str| {
        let answer = planar::solve_planar(&query.sides, levels, hint).unwrap();
        check_planar_answer(&answer, &polygons, least, name);
    };
    // A lower bound and a guess, right or wrong, change the path of the search but not the answer.
    check(&PlanarHint::NONE, name);
    let edges = [0, 1].map(|i| polygons[i][random.index(polygons[i].len())].half_edge);
    let between = [polygons[1][0].half_edge, edges[1]];
    let lasts = [
        LastAnswer::Nothing,
        LastAnswer::Facing { right: 0, edges },
        LastAnswer::Facing { right: 1, edges },
        LastAnswer::Bottom { upper: 0, vertex: edges[0], between },
    ];
    for known in [1e-6, 1e-2, 1.0] {
        for last in lasts {
            let hint = PlanarHint { height: least.min(10.0) - known, levels, last };
            check(&hint, &format!("{name}, {hint:?}"));
        }
    }
    // The same holds for hints from an answer at other levels, near or far.
    for share in [1e-9, 1e-3, 0.1, 1.0] {
        let others = [0, 1].map(|i| {
            let [low, high] = query.sides[i].level_range();
            levels[i] + (random.within(low, high) - levels[i]) * share
        });
        let other = planar::solve_planar(&query.sides, others, &PlanarHint::NONE).unwrap();
        let hint = other.hint_for_levels(others, levels, least.min(10.0) - share);
        check(&hint, &format!("{name}, from {share}"));
    }
}

/// Compares an answer with the least common height of two sections, which is infinite if they are disjoint.
fn check_planar_answer(
    answer: &PlanarAnswer,
    polygons: &[Vec<Crossing>; 2],
    least: f64,
    name: &str,
) {
    match answer {
        PlanarAnswer::Vertex { vertex, .. } => {
            assert!((vertex.h() - least).abs() < 1e-9, "{name}: {least} {}", vertex.h());
        }
        PlanarAnswer::Edges { contact, .. } => {
            assert!((contact.x - least).abs() < 1e-9, "{name}: {least} {contact}");
        }
        PlanarAnswer::Separated { u, supports } => {
            // Sections that touch each other may count as separated or in contact.
            let apart = u.dot(supports[1].w - supports[0].w);
            assert!(apart >= -1e-12 && (least == f64::INFINITY || apart < 1e-12), "{name}");
            let beyond = |c: &Crossing, body: usize| u.dot(c.w - supports[body].w);
            assert!(polygons[0].iter().all(|c| beyond(c, 0) < 1e-9), "{name}");
            assert!(polygons[1].iter().all(|c| beyond(c, 1) > -1e-9), "{name}");
        }
    }
}

/// Returns random levels within the ranges of both bodies.
fn random_levels(random: &mut Random, query: &SectionPair) -> [f64; 2] {
    query.sides.each_ref().map(|side| {
        let [low, high] = side.level_range();
        random.within(low, high)
    })
}

#[test]
fn faces_of_edge_contact_reproduce_it() {
    let mut random = Random(43);
    let (p, q) = (ellipsoid(200, DVec3::ONE), ellipsoid(60, DVec3::new(1.0, 0.7, 1.3)));
    let (mut contacts, mut reproduced) = (0, 0);
    for round in 0..3000 {
        let poses = [random_pose(&mut random, 0.7), random_pose(&mut random, 0.7)];
        let setting = Setting::new(p.at(poses[0]), q.at(poses[1]), random.unit()).unwrap();
        let query = SectionPair::new(&setting);
        let levels = random_levels(&mut random, &query);
        let found = planar::solve_planar(&query.sides, levels, &PlanarHint::NONE).unwrap();
        let PlanarAnswer::Edges { edges, contact } = found else { continue };
        contacts += 1;
        let faces = [0, 1].map(|i| face_of_edge(&query.sides[i], &edges[i]).unwrap().0);
        let again = planar::solve_on_faces(&query.sides, levels, faces, 1e-9);
        let Some(PlanarAnswer::Edges { contact: other, .. }) = again else { continue };
        reproduced += 1;
        assert!(contact.distance(other) < 1e-9, "round {round}: {contact} {other}");
    }
    assert!(contacts > 500 && reproduced * 100 >= contacts * 99, "{reproduced} of {contacts}");
}

/// Measures searches from the centre to the end. Returns the mean number of iterations in a planar problem, and
/// of planar problems in a search.
fn work_per_problem(bodies: &[ConvexPolyhedron; 2], aside: f64, rounds: usize) -> [f64; 2] {
    let mut random = Random(29);
    let (mut problems, mut iterations) = (0, 0);
    for _ in 0..rounds {
        let mut e = colliding_setting(&mut random);
        let shift = random.unit().cross(e.d).normalize() * aside;
        e.poses[1] = Pose::new(e.poses[1].rotation(), e.poses[1].translation() + shift).unwrap();
        let [p, q] = bodies;
        let setting = Setting::new(p.at(e.poses[0]), q.at(e.poses[1]), e.d).unwrap();
        let steps = minimise_counting_steps(&setting, &EXACT).1;
        problems += steps.planar_problems;
        iterations += steps.iterations;
    }
    let problems = f64::from(problems);
    [f64::from(iterations) / problems, problems / rounds as f64]
}

#[test]
fn warm_planar_problems_take_few_iterations() {
    for (count, thin) in [(2000, false), (20_000, false), (2000, true), (20_000, true)] {
        let bodies = ellipsoid_pair(count, thin);
        for aside in [0.0, 1.5, 3.0] {
            let [iterations, problems] = work_per_problem(&bodies, aside, 200);
            println!(
                "{count} thin {thin} aside {aside}: {iterations:.1} iterations a problem, \
                 {problems:.1} problems"
            );
            let limit = if thin { 100.0 } else { 80.0 };
            assert!(iterations < limit, "{count} {thin} {aside}: {iterations}");
        }
    }
}

/// Sections with about as many edges as the body use chains instead of walks.
#[test]
fn prisms_and_cones_take_few_times_the_iterations_of_ellipsoids() {
    for count in [3200, 12_800, 51_200] {
        let ellipsoids = work_per_problem(&ellipsoid_pair(count, false), 0.0, 100)[0];
        for (name, body, limit) in
            [("prism", prism(count / 2, DVec3::ONE), 2.6), ("cone", cone(count, DVec3::ONE), 3.2)]
        {
            let work = work_per_problem(&[body.clone(), body], 0.0, 100)[0];
            println!("{name} of {count}: {work:.1} iterations, ellipsoids {ellipsoids:.1}");
            assert!(work < limit * ellipsoids, "{name} of {count}: {work} {ellipsoids}");
        }
    }
}

/// Returns two ellipsoids with faces about as long as wide, or a hundred times as long.
fn ellipsoid_pair(count: usize, thin: bool) -> [ConvexPolyhedron; 2] {
    let mut random = Random(31);
    [0, 1].map(|_| {
        let axes = DVec3::from_array([0, 1, 2].map(|_| random.within(0.6, 1.4)));
        if thin { thin_ellipsoid(count, axes) } else { ellipsoid(count, axes) }
    })
}

/// Measures planar problems at random levels without a hint. Returns the mean number of iterations for
/// contacts, for separations sideways and for separations by height.
fn work_from_nothing(bodies: &[ConvexPolyhedron; 2], rounds: usize) -> [f64; 3] {
    let mut random = Random(41);
    let (mut problems, mut iterations) = ([0_u32; 3], [0_u32; 3]);
    for _ in 0..rounds {
        let [p, q] = bodies;
        let poses = [random_pose(&mut random, 0.7), random_pose(&mut random, 0.7)];
        let setting = Setting::new(p.at(poses[0]), q.at(poses[1]), random.unit()).unwrap();
        let query = SectionPair::new(&setting);
        let levels = random_levels(&mut random, &query);
        let kind = match planar::solve_planar(&query.sides, levels, &PlanarHint::NONE).unwrap() {
            PlanarAnswer::Separated { u, .. } if u.y == 0.0 => 2,
            PlanarAnswer::Separated { .. } => 1,
            PlanarAnswer::Vertex { .. } | PlanarAnswer::Edges { .. } => 0,
        };
        problems[kind] += 1;
        iterations[kind] += query.sides.iter().map(|side| side.iterations.get()).sum::<u32>();
    }
    assert!(problems.iter().all(|&of_kind| of_kind > 50), "{problems:?}");
    [0, 1, 2].map(|kind| f64::from(iterations[kind]) / f64::from(problems[kind]))
}

#[test]
fn cold_planar_problems_take_logarithmically_many_iterations() {
    for thin in [false, true] {
        for count in [200, 2000, 20_000, 200_000] {
            let work = work_from_nothing(&ellipsoid_pair(count, thin), 2000);
            println!("{count} thin {thin}: {work:.1?}");
            let limit = 6.0 * f64::from(count as u32).log2();
            assert!(work.iter().all(|&steps| steps < limit), "{count} thin {thin}: {work:.1?}");
        }
    }
}
