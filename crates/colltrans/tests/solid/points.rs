//! Points and segments against solids, judged by brute force in whole numbers.
//!
//! The solids are random sets of unit cubes, each cut into triangles along random diagonals and sheared by a
//! whole matrix, so that points hit vertices, run along edges and lie in planes of facets. Coordinates are
//! even, so that middles of edges are whole.

use colltrans::glam::DVec3;
use colltrans::motion::{FacetsMeeting, FacetsMet, Motion, MotionCast, MotionOutcome};
use colltrans::solid::{AsSolid, SolidError};
use colltrans::{
    Among, Cast, Clearance, ConvexPolyhedron, Feature, InputVertex, Obstacles, Outcome, Pair, Pose,
    Solid, Within,
};
use colltrans_testkit::random::Random;

type Point = [i128; 3];

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn scaled(a: Point, by: i128) -> Point {
    a.map(|x| x * by)
}

fn plus(a: Point, b: Point) -> Point {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: Point, b: Point) -> i128 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn float(a: Point) -> DVec3 {
    DVec3::from_array(a.map(|x| x as f64))
}

fn gcd(a: i128, b: i128) -> i128 {
    if b == 0 { a.abs() } else { gcd(b, a % b) }
}

struct Cubes {
    vertices: Vec<Point>,
    triangles: Vec<[u32; 3]>,
    matrix: [Point; 3],
}

impl Cubes {
    /// The surface of a random set of cubes.
    fn new(random: &mut Random, side: usize) -> Self {
        let matrix = random.pick(&[
            [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
            [[1, 1, 0], [0, 1, 0], [1, 0, 1]],
            [[1, 2, -1], [0, 1, 1], [1, 0, 2]],
        ]);
        let n = side as i128;
        let mut filled: Vec<bool> = (0..n * n * n).map(|_| random.one_in(2)).collect();
        let full = |filled: &[bool], c: Point| {
            let inside = c.iter().all(|x| (0..n).contains(x));
            inside && filled[((c[0] * n + c[1]) * n + c[2]) as usize]
        };
        // Two pits that meet in a vertex alone are left out: the vertex blocks.
        let around = |v: Point| (0..8).map(move |k| minus(v, [k >> 2 & 1, k >> 1 & 1, k & 1]));
        let is_pinched = |filled: &[bool], v: Point| {
            let all: Vec<bool> = around(v).map(|c| full(filled, c)).collect();
            all.iter().filter(|f| **f).count() == 6 && (0..4).any(|k| !all[k] && !all[7 - k])
        };
        let inner = || (0..n * n * n).map(|k| [k / n / n, k / n % n, k % n]);
        if inner().any(|v| is_pinched(&filled, v)) {
            filled.fill(true);
        }
        let is_full = |c: Point| full(&filled, c);
        let mut cubes = Self { vertices: Vec::new(), triangles: Vec::new(), matrix };
        for k in 0..n * n * n {
            let cell = [k / n / n, k / n % n, k % n];
            if !is_full(cell) {
                continue;
            }
            for axis in 0..3 {
                for up in [false, true] {
                    let mut beyond = cell;
                    beyond[axis] += if up { 1 } else { -1 };
                    if !is_full(beyond) {
                        cubes.add_face(random, cell, axis, up);
                    }
                }
            }
        }
        cubes
    }

    fn add_face(&mut self, random: &mut Random, cell: Point, axis: usize, up: bool) {
        let corner = |s: i128, t: i128| {
            let mut c = cell;
            c[axis] += i128::from(up);
            c[(axis + 1) % 3] += s;
            c[(axis + 2) % 3] += t;
            c
        };
        let ring = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(s, t)| {
            let place = self.place(scaled(corner(s, t), 2));
            let known = self.vertices.iter().position(|v| *v == place);
            known.unwrap_or_else(|| {
                self.vertices.push(place);
                self.vertices.len() - 1
            }) as u32
        });
        let [a, b, c, e] = ring;
        let mut cut =
            if random.one_in(2) { [[a, b, c], [a, c, e]] } else { [[a, b, e], [b, c, e]] };
        if !up {
            for triangle in &mut cut {
                triangle.swap(1, 2);
            }
        }
        self.triangles.extend(cut);
    }

    /// A point of the grid, sheared.
    fn place(&self, p: Point) -> Point {
        self.matrix.map(|row| dot(row, p))
    }

    fn solid(&self) -> Option<Solid> {
        let vertices: Vec<DVec3> = self.vertices.iter().map(|v| float(*v)).collect();
        Solid::from_mesh(&vertices, &self.triangles).ok()
    }

    fn corners(&self, by: i128) -> impl Iterator<Item = [Point; 3]> + '_ {
        self.triangles.iter().map(move |t| t.map(|v| scaled(self.vertices[v as usize], by)))
    }

    fn normals(&self) -> impl Iterator<Item = Point> + '_ {
        self.corners(1).map(|[a, b, c]| cross(minus(b, a), minus(c, a)))
    }

    /// Whether a point, over `by`, lies strictly inside; `None` if it lies on the surface.
    fn holds(&self, p: Point, by: i128) -> Option<bool> {
        for ([a, b, c], normal) in self.corners(by).zip(self.normals()) {
            // Along sides that are not scaled.
            let along = |u: Point, v: Point| {
                let side = minus(v, u).map(|x| x / by);
                dot(normal, cross(side, minus(p, u))).signum()
            };
            if dot(normal, minus(p, a)) == 0
                && along(a, b) >= 0
                && along(b, c) >= 0
                && along(c, a) >= 0
            {
                return None;
            }
        }
        // A direction that meets no edge.
        'next: for k in 1_i128.. {
            let way = [11 + 3 * k, 101 - 5 * k * k, 37 * k + 1];
            let mut winding = 0;
            for (corners, normal) in self.corners(by).zip(self.normals()) {
                let [a, b, c] = corners.map(|v| minus(v, p));
                let sides = [[a, b], [b, c], [c, a]].map(|[u, v]| dot(way, cross(u, v)).signum());
                if dot(normal, way) == 0 {
                    continue;
                }
                if sides.contains(&1) && sides.contains(&-1) {
                    continue;
                }
                if sides.contains(&0) {
                    continue 'next;
                }
                if dot(normal, a).signum() == dot(normal, way).signum() {
                    winding += dot(normal, way).signum();
                }
            }
            return Some(winding > 0);
        }
        None
    }

    /// The least `t` from which on a point of `p + t d` is inside, as a quotient, over those from `from` on, and
    /// whether `from` itself is inside.
    fn entry(&self, p: Point, d: Point, from: Option<i128>) -> Option<(i128, i128)> {
        let mut times: Vec<(i128, i128)> = from.map(|t| (t, 1)).into_iter().collect();
        let mut add = |over: i128, under: i128| {
            if under != 0 {
                let whole = gcd(over, under) * under.signum();
                times.push((over / whole, under / whole));
            }
        };
        for [a, b, c] in self.corners(1) {
            let normal = cross(minus(b, a), minus(c, a));
            add(dot(normal, minus(a, p)), dot(normal, d));
            for [u, v] in [[a, b], [b, c], [c, a]] {
                // Where the line meets that of a side, if it does: across two axes.
                for k in 0..3 {
                    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                    let (e, w) = (minus(v, u), minus(u, p));
                    add(w[i] * e[j] - w[j] * e[i], d[i] * e[j] - d[j] * e[i]);
                }
            }
        }
        times.sort_by(|a, b| (a.0 * b.1).cmp(&(b.0 * a.1)));
        times.dedup_by(|a, b| a.0 * b.1 == b.0 * a.1);
        let early = |t: &(i128, i128)| from.is_some_and(|from| t.0 < from * t.1);
        times.retain(|t| !early(t));
        times.windows(2).find_map(|w| {
            let ([a, b], under) = ([w[0], w[1]], 2 * w[0].1 * w[1].1);
            let middle = plus(scaled(p, under), scaled(d, a.0 * b.1 + b.0 * a.1));
            (self.holds(middle, under) == Some(true)).then_some(a)
        })
    }
}

fn point(p: Point) -> ConvexPolyhedron {
    ConvexPolyhedron::from_points(&[float(p)]).expect("a point")
}

fn segment(p: Point, q: Point) -> ConvexPolyhedron {
    ConvexPolyhedron::from_points(&[float(p), float(q)]).expect("a segment")
}

fn small(random: &mut Random, low: i64, high: i64) -> Point {
    [0; 3].map(|_| i128::from(random.int(low, high)))
}

fn any_direction(random: &mut Random) -> Point {
    loop {
        let d = small(random, -2, 2);
        if d != [0; 3] {
            return d;
        }
    }
}

/// Poses that turn nothing, one that does by quarter turns, and one that rounds.
fn still() -> Pose {
    Pose::IDENTITY
}

#[test]
fn a_point_enters_cubes_where_fractions_say() {
    let mut random = Random::new(5_201);
    let (mut asked, mut met, mut overlapping, mut moved) = (0, 0, 0, 0);
    for _ in 0..400 {
        let side = 2 + random.index(2);
        let cubes = Cubes::new(&mut random, side);
        let Some(solid) = cubes.solid() else { continue };
        for _ in 0..6 {
            let p = cubes.place(small(&mut random, -2, 7));
            let d = cubes.place(any_direction(&mut random));
            let body = point(p);
            let cast =
                Cast::between(body.at(still()), solid.at(still()), float(d)).expect("a cast");
            let fixed = Cast::between(solid.at(still()), body.at(still()), -float(d)).expect("it");
            asked += 1;
            let right = cubes.entry(p, d, None).map(|(a, b)| a as f64 / b as f64);
            for cast in [&cast, &fixed] {
                match (cast.first_contact().expect("an answer"), right) {
                    (Outcome::Contact(contact), Some(right)) => {
                        let t = contact.translation;
                        assert!(t.lower <= right && right <= t.upper, "{t:?} {right}: {p:?} {d:?}");
                        assert!(t.upper - t.lower < 1e-11, "{t:?}");
                        met += 1;
                    }
                    (Outcome::Separated(_), None) => {}
                    (found, right) => {
                        panic!("{found:?}, {right:?}: {p:?} {d:?} {:?}", cubes.vertices)
                    }
                }
            }
            let inside = cubes.holds(p, 1) == Some(true);
            let right = cubes.entry(p, d, Some(0)).map(|(a, b)| a as f64 / b as f64);
            for cast in
                [cast.with_tolerance(0.0).expect("it"), fixed.with_tolerance(0.0).expect("it")]
            {
                let (found, proof) = cast.certified_clearance().expect("an answer");
                match (&found, inside, right) {
                    (Clearance::Overlapping(_), true, _) => overlapping += 1,
                    (Clearance::Blocked { distance, contact }, false, Some(right)) => {
                        assert!(*distance <= right, "{distance} {right}: {p:?} {d:?}");
                        assert!(right <= contact.translation.upper, "{contact:?} {right}");
                        assert!(right - distance < 1e-11, "{distance} {right}");
                        moved += 1;
                    }
                    (Clearance::Free(_), false, None) => {}
                    found => {
                        panic!("{found:?}: {p:?} {d:?} {:?} {:?}", cubes.vertices, cubes.triangles)
                    }
                }
                cast.verify(&proof).expect("a proof that holds");
                assert_eq!(cast.overlaps(), inside, "{p:?}");
                let meets = cast.intersects().expect("an answer").meets;
                assert_eq!(meets, cubes.holds(p, 1) != Some(false), "{p:?}");
            }
        }
    }
    eprintln!("{asked} points, {met} met, {moved} stopped, {overlapping} inside");
    assert!(met > 1_000 && overlapping > 100 && moved > 300);
}

/// Whether an open part of the segment from `p` to `q`, over `by`, is inside.
fn runs_inside(cubes: &Cubes, p: Point, q: Point) -> bool {
    cubes.entry(p, minus(q, p), Some(0)).is_some_and(|(a, b)| a < b)
}

#[test]
fn a_segment_overlaps_and_touches_cubes_as_fractions_say() {
    let mut random = Random::new(5_202);
    let (mut overlapping, mut apart) = (0, 0);
    for _ in 0..400 {
        let cubes = Cubes::new(&mut random, 2);
        let Some(solid) = cubes.solid() else { continue };
        for _ in 0..8 {
            let [p, q] = [0; 2].map(|_| cubes.place(small(&mut random, -1, 5)));
            if p == q {
                continue;
            }
            let body = segment(p, q);
            let wanted = runs_inside(&cubes, p, q);
            let d = float(cubes.place(any_direction(&mut random)));
            let there = Cast::between(body.at(still()), solid.at(still()), d).expect("a cast");
            let back = Cast::between(solid.at(still()), body.at(still()), d).expect("a cast");
            for cast in [there, back] {
                let cast = cast.with_tolerance(0.0).expect("none");
                assert_eq!(
                    cast.overlaps(),
                    wanted,
                    "{p:?} {q:?} {:?} {:?}",
                    cubes.vertices,
                    cubes.triangles
                );
                let (_, proof) = cast.certified_clearance().expect("an answer");
                cast.verify(&proof).expect("a proof that holds");
            }
            *(if wanted { &mut overlapping } else { &mut apart }) += 1;
        }
    }
    assert!(overlapping > 500 && apart > 300, "{overlapping} {apart}");
}

#[test]
fn a_segment_is_stopped_where_it_first_runs_into_cubes() {
    let mut random = Random::new(5_203);
    let (mut stopped, mut free) = (0, 0);
    for _ in 0..250 {
        let cubes = Cubes::new(&mut random, 2);
        let Some(solid) = cubes.solid() else { continue };
        for _ in 0..4 {
            let [p, q] = [0; 2].map(|_| cubes.place(small(&mut random, -2, 6)));
            let d = cubes.place(any_direction(&mut random));
            if p == q || runs_inside(&cubes, p, q) {
                continue;
            }
            let body = segment(p, q);
            let cast =
                Cast::between(body.at(still()), solid.at(still()), float(d)).expect("a cast");
            let cast = cast.with_tolerance(0.0).expect("none");
            let (found, proof) = cast.certified_clearance().expect("an answer");
            cast.verify(&proof).expect("a proof that holds");
            // Just before the stop it does not run into the solid, and just behind it does.
            let moved = |over: i128, under: i128| {
                let large = Cubes {
                    vertices: cubes.vertices.iter().map(|v| scaled(*v, under)).collect(),
                    triangles: cubes.triangles.clone(),
                    matrix: cubes.matrix,
                };
                let at = |p: Point| plus(scaled(p, under), scaled(d, over));
                runs_inside(&large, at(p), at(q))
            };
            let under = 64;
            match found {
                Clearance::Blocked { distance, .. } => {
                    let over = (distance * under as f64).round() as i128;
                    assert!(moved(over + 1, under), "{distance}: {p:?} {q:?} {d:?}");
                    assert!(over < 1 || !moved(over - 1, under), "{distance}: {p:?} {q:?} {d:?}");
                    (0..over * 8 / under).for_each(|k| assert!(!moved(k, 8), "{p:?} {q:?} {d:?}"));
                    stopped += 1;
                }
                Clearance::Free(_) => {
                    (0..80).for_each(|k| assert!(!moved(k, 8), "{k}: {p:?} {q:?} {d:?}"));
                    free += 1;
                }
                Clearance::Overlapping(_) => panic!("{p:?} {q:?}"),
            }
        }
    }
    assert!(stopped > 150 && free > 150, "{stopped} {free}");
}

fn cube() -> ConvexPolyhedron {
    ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE).expect("a box")
}

#[test]
fn distances_motions_and_scenes_take_points_and_segments() {
    let far = ConvexPolyhedron::cuboid(DVec3::splat(7.0), DVec3::splat(8.0)).expect("a box");
    let solid = Solid::from_pieces([&cube(), &far]).expect("a solid");
    let corner = point([3, 5, 1]);
    let rod = segment([3, 0, 0], [3, 5, 1]);
    let cases = [(&corner, 20.0_f64.sqrt()), (&rod, 2.0)];
    for (body, right) in cases {
        for pair in [
            Pair::between(body.at(still()), solid.at(still())).expect("a pair"),
            Pair::between(solid.at(still()), body.at(still())).expect("a pair"),
        ] {
            let (found, proof) = pair.certified_distance().expect("a distance");
            assert!(found.lower <= right && right <= found.upper, "{found:?} {right}");
            assert!(found.upper - found.lower < 1e-12, "{found:?}");
            pair.verify(&proof).expect("a proof that holds");
            let features = found.features.expect("they are apart");
            let own = if pair.moving().is_closed() { features.fixed } else { features.moving };
            assert!(!matches!(own, Feature::Face(_)), "{features:?}");
            assert!(matches!(pair.within(right + 1e-9), Ok(Within::Closer(_))));
            assert!(matches!(pair.within(right - 1e-9), Ok(Within::Farther(_))));
        }
    }
    motions_take_points_and_segments();
    // Scenes, either way.
    let mut scene = Obstacles::new();
    scene.insert(solid.clone(), still());
    let among = Among::new(corner.at(still()), &scene).expect("a point among solids");
    let nearest = among.nearest().expect("an answer").expect("one");
    assert!(nearest.lower <= 20.0_f64.sqrt() && 20.0_f64.sqrt() < nearest.lower + 1e-12);
    let (_, proof) = among.certified_nearest().expect("an answer").expect("one");
    among.verify(&proof).expect("a proof that holds");
    let mut points = Obstacles::new();
    points.insert(corner, still());
    let among = Among::new(solid.at(still()), &points).expect("a solid among points");
    assert!(among.nearest().expect("an answer").is_some());
}

/// A point and a rod come around the origin from (-4, 0, 0) to a slab that begins at x = 0, in half a turn.
fn motions_take_points_and_segments() {
    let turn = Motion::turn(still(), DVec3::ZERO, DVec3::Z, -std::f64::consts::PI);
    let turn = turn.expect("a turn");
    let slab = ConvexPolyhedron::cuboid(DVec3::new(0.0, 3.0, -0.5), DVec3::new(1.0, 8.0, 0.5));
    let slab = Solid::from_convex(&slab.expect("a box")).expect("a solid");
    let rest = Motion::still(still());
    // An edge of the rod passes through the face: that is proven.
    let rod = segment([-4, -1, 0], [-4, 1, 0]);
    let cast = MotionCast::between(rod.along(&turn), slab.along(&rest)).expect("a cast");
    let cast = cast.tolerating(0.0).expect("none");
    let found = cast.certified_first_contact().expect("an answer");
    let MotionOutcome::Contact(contact) = found else { panic!("no contact: {found:?}") };
    let right = 0.5 - 0.25_f64.atan() / std::f64::consts::PI;
    assert!(contact.lower <= right + 1e-15 && right <= contact.upper + 1e-15, "{contact:?}");
    let features = contact.features.expect("they are apart");
    assert_eq!(features.moving, Feature::Vertex(InputVertex(1)));
    assert!(contact.upper - contact.lower < 1e-9, "{contact:?}");
    cast.verify(&contact.proof).expect("a proof that holds");
    assert!(cast.clearance().is_ok());
    // A point has no edge that passes through one: a time is proven at which it is inside.
    let tip = point([-4, 0, 0]);
    let back = Motion::turn(still(), DVec3::ZERO, DVec3::Z, std::f64::consts::PI).expect("a turn");
    for moves in [true, false] {
        let cast = if moves {
            MotionCast::between(tip.along(&turn), slab.along(&rest))
        } else {
            MotionCast::between(slab.along(&back), tip.along(&rest))
        };
        let cast = cast.expect("a cast");
        let found = cast.certified_first_contact().expect("an answer");
        let MotionOutcome::Contact(contact) = found else { panic!("no contact: {found:?}") };
        assert!((contact.lower - 0.5).abs() < 1e-9, "{contact:?}");
        assert!(contact.upper - contact.lower < 1e-11, "{contact:?}");
        assert_eq!(cast.verify(&contact.proof), Ok([contact.lower, contact.upper]));
        let meeting = contact.proof.meeting.expect("it is proven");
        let forged = |change: &dyn Fn(&mut FacetsMeeting)| {
            let mut proof = contact.proof.clone();
            change(proof.meeting.as_mut().expect("it is there"));
            assert!(cast.verify(&proof).is_err(), "{:?}", proof.meeting);
        };
        forged(&|of| of.time = contact.lower);
        forged(&|of| of.triangles[usize::from(!moves)] = 1);
        let weights = [1.0, 0.0, 0.0];
        forged(&|of| of.met = FacetsMet::Contained { moving: !moves, weights });
        forged(&|of| of.met = FacetsMet::Contained { moving: moves, weights: [2.0, 0.0, 0.0] });
        assert!(matches!(meeting.met, FacetsMet::Contained { moving, .. } if moving == moves));
    }
}

#[test]
fn what_needs_an_area_refuses_points_with_the_way_out() {
    let refused = Solid::from_pieces([&point([0; 3])]).expect_err("no area");
    assert_eq!(refused, SolidError::NoArea { what: "point" });
    assert!(refused.to_string().contains("small box around it"), "{refused}");
    let rod = segment([0; 3], [1, 0, 0]);
    let surface = rod.as_surface().expect("a facet without area");
    assert_eq!(surface.as_solid().err(), Some(SolidError::NoArea { what: "segment" }));
    assert_eq!((surface.is_closed(), surface.volume()), (false, 0.0));
}
