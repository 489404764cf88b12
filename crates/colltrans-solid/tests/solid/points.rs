//! Points and segments against solids, judged by brute force in whole numbers.
//!
//! The solids are random sets of unit cubes, two such sets as pieces of one body, and blocks with pits from above and
//! below, which may meet in a vertex, cross in an edge or reach the other face. All are cut into triangles along
//! random diagonals and sheared by a whole matrix, so that points hit vertices, run along edges and lie in planes of
//! facets.

use colltrans::motion::{FacetContact, FacetContactProof, Motion, MotionCast, MotionOutcome};
use colltrans::{Obstacles, SceneQuery};
use colltrans_convex::{
    Cast, Clearance, ConvexPolyhedron, Feature, InputVertex, Outcome, Pair, Pose, Within,
};
use colltrans_solid::{AsSolid, Solid, SolidCast, SolidError, SolidPair};
use colltrans_testkit::bodies::cube;
use colltrans_testkit::cases;
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::{self, Mesh};
use glam::{DQuat, DVec3};

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

/// Maps of the grid, which shear it.
const MATRICES: [[Point; 3]; 3] = [
    [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
    [[1, 1, 0], [0, 1, 0], [1, 0, 1]],
    [[1, 2, -1], [0, 1, 1], [1, 0, 2]],
];

/// A closed surface.
struct Surface {
    vertices: Vec<Point>,
    triangles: Vec<[u32; 3]>,
    matrix: [Point; 3],
}

impl Surface {
    /// The surface of a random set of cubes.
    fn cubes(random: &mut Random, matrix: [Point; 3], side: usize) -> Self {
        let n = side as i128;
        let filled: Vec<bool> = (0..n * n * n).map(|_| random.one_in(2)).collect();
        let is_full = |c: Point| {
            let inside = c.iter().all(|x| (0..n).contains(x));
            inside && filled[((c[0] * n + c[1]) * n + c[2]) as usize]
        };
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

    /// A block of 8 units with a pit in its upper and one in its lower face, where they have a bottom: four corners,
    /// some of which may be one.
    fn block(random: &mut Random, matrix: [Point; 3], bottoms: &[Option<[Point; 4]>; 2]) -> Self {
        let mut block = Self { vertices: Vec::new(), triangles: Vec::new(), matrix };
        let square = |from: i128, to: i128, z: i128| {
            [[from, from, z], [to, from, z], [to, to, z], [from, to, z]]
        };
        let [low, high] = [square(0, 8, 0), square(0, 8, 8)];
        for k in 0..4 {
            let next = (k + 1) % 4;
            block.add(random, [low[k], low[next], high[next], high[k]], false);
        }
        for (rim, inner, bottom, is_down) in
            [(high, square(2, 6, 8), bottoms[0], false), (low, square(2, 6, 0), bottoms[1], true)]
        {
            let Some(bottom) = bottom else {
                block.add(random, rim, is_down);
                continue;
            };
            for k in 0..4 {
                let next = (k + 1) % 4;
                block.add(random, [rim[k], rim[next], inner[next], inner[k]], is_down);
                block.add(random, [inner[k], inner[next], bottom[next], bottom[k]], is_down);
            }
        }
        block
    }

    /// A block whose pits end in points or in edges, which may meet each other, cross, or reach the opposite face.
    fn pits(random: &mut Random, matrix: [Point; 3]) -> Self {
        let bottom = |random: &mut Random, z: i128| match random.index(4) {
            0 => [[3, 4, z], [5, 4, z], [5, 4, z], [3, 4, z]],
            1 => [[4, 3, z], [4, 3, z], [4, 5, z], [4, 5, z]],
            _ => [[4, 4, z]; 4],
        };
        let bottoms = if random.one_in(3) {
            let depth = random.pick(&[0, 1]);
            [Some(bottom(random, depth)), None]
        } else {
            [Some(bottom(random, 4)), Some(bottom(random, 4))]
        };
        Self::block(random, matrix, &bottoms)
    }

    /// Adds a quadrangle of points of the half grid, some of which may be one.
    fn add(&mut self, random: &mut Random, ring: [Point; 4], turned: bool) {
        let [a, b, c, e] = ring.map(|p| self.number(self.place(p)));
        let cut = if random.one_in(2) { [[a, b, c], [a, c, e]] } else { [[a, b, e], [b, c, e]] };
        for [a, b, c] in cut {
            if a != b && b != c && c != a {
                self.triangles.push(if turned { [a, c, b] } else { [a, b, c] });
            }
        }
    }

    fn number(&mut self, place: Point) -> u32 {
        let known = self.vertices.iter().position(|v| *v == place);
        known.unwrap_or_else(|| {
            self.vertices.push(place);
            self.vertices.len() - 1
        }) as u32
    }

    fn add_face(&mut self, random: &mut Random, cell: Point, axis: usize, up: bool) {
        let corner = |s: i128, t: i128| {
            let mut c = cell;
            c[axis] += i128::from(up);
            c[(axis + 1) % 3] += s;
            c[(axis + 2) % 3] += t;
            c
        };
        let ring = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(s, t)| scaled(corner(s, t), 2));
        self.add(random, ring, !up);
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

    /// Adds each `t` at which a point of `p + t d` may come in or go out, as a quotient.
    fn add_times(&self, p: Point, d: Point, times: &mut Vec<(i128, i128)>) {
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
    }
}

/// A body of one or two pieces.
struct Body {
    pieces: Vec<Surface>,
}

impl Body {
    fn random(random: &mut Random, side: usize) -> Self {
        let matrix = random.pick(&MATRICES);
        let mut pieces = vec![match random.index(3) {
            0 => Surface::pits(random, matrix),
            _ => Surface::cubes(random, matrix, side),
        }];
        if random.one_in(3) {
            let mut other = Surface::cubes(random, matrix, side);
            let way = other.place(small(random, -2, 2));
            other.vertices.iter_mut().for_each(|v| *v = plus(*v, way));
            pieces.push(other);
        }
        Self { pieces }
    }

    fn solid(&self) -> Option<Solid> {
        let all: Vec<Solid> = self.pieces.iter().filter_map(Surface::solid).collect();
        match &all[..] {
            [one] if self.pieces.len() == 1 => Some(one.clone()),
            [one, other] => Solid::from_pieces([one, other]).ok(),
            _ => None,
        }
    }

    /// A point of the grid, sheared.
    fn place(&self, p: Point) -> Point {
        self.pieces[0].place(p)
    }

    /// The body, so many times as large.
    fn scaled(&self, by: i128) -> Self {
        let scaled = |of: &Surface| Surface {
            vertices: of.vertices.iter().map(|v| scaled(*v, by)).collect(),
            triangles: of.triangles.clone(),
            matrix: of.matrix,
        };
        Self { pieces: self.pieces.iter().map(scaled).collect() }
    }

    /// Whether a point, over `by`, lies strictly inside a piece; `None` if it lies on a surface and inside none.
    fn holds(&self, p: Point, by: i128) -> Option<bool> {
        let all: Vec<Option<bool>> = self.pieces.iter().map(|piece| piece.holds(p, by)).collect();
        if all.contains(&Some(true)) {
            return Some(true);
        }
        if all.contains(&None) { None } else { Some(false) }
    }

    /// The least `t` from which on a point of `p + t d` is inside, as a quotient, of those from `from` on.
    fn entry(&self, p: Point, d: Point, from: Option<i128>) -> Option<(i128, i128)> {
        let mut times: Vec<(i128, i128)> = from.map(|t| (t, 1)).into_iter().collect();
        self.pieces.iter().for_each(|piece| piece.add_times(p, d, &mut times));
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

    fn told(&self) -> String {
        let piece = |of: &Surface| format!("{:?} {:?}", of.vertices, of.triangles);
        self.pieces.iter().map(piece).collect::<Vec<_>>().join("; ")
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

fn still() -> Pose {
    Pose::IDENTITY
}

/// A pose that turns nothing, or one whose matrix is rounded.
fn any_pose(random: &mut Random) -> Pose {
    if random.one_in(2) {
        return still();
    }
    let turn = DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), random.int(1, 9) as f64);
    Pose::new(turn, DVec3::new(0.1, -7.3, 1e3)).expect("a pose")
}

#[test]
fn a_point_enters_cubes_where_fractions_say() {
    let mut random = Random::new(5_201);
    let (mut asked, mut met, mut overlapping, mut moved) = (0, 0, 0, 0);
    for _ in 0..cases(250) {
        let side = 2 + random.index(2);
        let cubes = Body::random(&mut random, side);
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
                        panic!("{found:?}, {right:?}: {p:?} {d:?} {}", cubes.told())
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
                        panic!("{found:?}: {p:?} {d:?} {}", cubes.told())
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
    assert!(met > cases(1_000) && overlapping > cases(100) && moved > cases(300));
}

/// Whether an open part of the segment from `p` to `q`, over `by`, is inside.
fn runs_inside(body: &Body, p: Point, q: Point) -> bool {
    body.entry(p, minus(q, p), Some(0)).is_some_and(|(a, b)| a < b)
}

#[test]
fn a_segment_overlaps_and_touches_cubes_as_fractions_say() {
    let mut random = Random::new(5_202);
    let (mut overlapping, mut apart) = (0, 0);
    for _ in 0..cases(400) {
        let cubes = Body::random(&mut random, 2);
        let Some(solid) = cubes.solid() else { continue };
        for _ in 0..8 {
            let [p, q] = [0; 2].map(|_| cubes.place(small(&mut random, -1, 5)));
            if p == q {
                continue;
            }
            let body = segment(p, q);
            let wanted = runs_inside(&cubes, p, q);
            let d = float(cubes.place(any_direction(&mut random)));
            let pose = any_pose(&mut random);
            let there = Cast::between(body.at(pose), solid.at(pose), d).expect("a cast");
            let back = Cast::between(solid.at(pose), body.at(pose), d).expect("a cast");
            let start = point(p);
            let on_end = Cast::between(start.at(pose), solid.at(pose), d).expect("a cast");
            let on_end = on_end.with_tolerance(0.0).expect("none");
            assert_eq!(
                on_end.overlaps(),
                cubes.holds(p, 1) == Some(true),
                "{p:?} {}",
                cubes.told()
            );
            for cast in [there, back] {
                let cast = cast.with_tolerance(0.0).expect("none");
                assert_eq!(cast.overlaps(), wanted, "{p:?} {q:?} {}", cubes.told());
                let (_, proof) = cast.certified_clearance().expect("an answer");
                cast.verify(&proof).expect("a proof that holds");
            }
            *(if wanted { &mut overlapping } else { &mut apart }) += 1;
        }
    }
    assert!(overlapping > cases(500) && apart > cases(300), "{overlapping} {apart}");
}

#[test]
#[ignore = "long: whole numbers at many places of each way"]
fn a_segment_is_stopped_where_it_first_runs_into_cubes() {
    let mut random = Random::new(5_203);
    let (mut stopped, mut free) = (0, 0);
    for _ in 0..cases(150) {
        let cubes = Body::random(&mut random, 2);
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
                let large = cubes.scaled(under);
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
    assert!(stopped > cases(80) && free > cases(80), "{stopped} {free}");
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
    let among = SceneQuery::new(corner.at(still()), &scene).expect("a point among solids");
    let nearest = among.nearest().expect("an answer").expect("one");
    assert!(nearest.lower <= 20.0_f64.sqrt() && 20.0_f64.sqrt() < nearest.lower + 1e-12);
    let (_, proof) = among.certified_nearest().expect("an answer").expect("one");
    among.verify(&proof).expect("a proof that holds");
    let mut points = Obstacles::new();
    points.insert(corner, still());
    let among = SceneQuery::new(solid.at(still()), &points).expect("a solid among points");
    assert!(among.nearest().expect("an answer").is_some());
}

/// A point and a rod come around the origin from (-4, 0, 0) to a slab that begins at x = 0, in half a turn.
fn motions_take_points_and_segments() {
    let turn = Motion::rotation_about(still(), DVec3::ZERO, DVec3::Z, -std::f64::consts::PI);
    let turn = turn.expect("a turn");
    let slab = ConvexPolyhedron::cuboid(DVec3::new(0.0, 3.0, -0.5), DVec3::new(1.0, 8.0, 0.5));
    let slab = Solid::from_convex(&slab.expect("a box")).expect("a solid");
    let rest = Motion::at_rest(still());
    // An edge of the rod passes through the face: that is proven.
    let rod = segment([-4, -1, 0], [-4, 1, 0]);
    let cast =
        MotionCast::between_any(rod.with_motion(&turn), slab.with_motion(&rest)).expect("a cast");
    let cast = cast.with_tolerance(0.0).expect("none");
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
    let back = Motion::rotation_about(still(), DVec3::ZERO, DVec3::Z, std::f64::consts::PI)
        .expect("a turn");
    for moves in [true, false] {
        let cast = if moves {
            MotionCast::between_any(tip.with_motion(&turn), slab.with_motion(&rest))
        } else {
            MotionCast::between_any(slab.with_motion(&back), tip.with_motion(&rest))
        };
        let cast = cast.expect("a cast");
        let found = cast.certified_first_contact().expect("an answer");
        let MotionOutcome::Contact(contact) = found else { panic!("no contact: {found:?}") };
        assert!((contact.lower - 0.5).abs() < 1e-9, "{contact:?}");
        assert!(contact.upper - contact.lower < 1e-11, "{contact:?}");
        assert_eq!(cast.verify(&contact.proof), Ok([contact.lower, contact.upper]));
        let meeting = contact.proof.meeting.expect("it is proven");
        let forged = |change: &dyn Fn(&mut FacetContact)| {
            let mut proof = contact.proof.clone();
            change(proof.meeting.as_mut().expect("it is there"));
            assert!(cast.verify(&proof).is_err(), "{:?}", proof.meeting);
        };
        forged(&|of| of.time = contact.lower);
        forged(&|of| of.triangles[usize::from(!moves)] = 1);
        let weights = [1.0, 0.0, 0.0];
        forged(&|of| of.met = FacetContactProof::Contained { moving: !moves, weights });
        forged(&|of| {
            of.met = FacetContactProof::Contained { moving: moves, weights: [2.0, 0.0, 0.0] }
        });
        assert!(
            matches!(meeting.met, FacetContactProof::Contained { moving, .. } if moving == moves)
        );
    }
}

/// Whether a point and those near it are inside a piece, by solid angles.
fn is_well_inside(body: &Body, p: DVec3) -> bool {
    let piece = |surface: &Surface, p: DVec3| {
        let angle = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| float(surface.vertices[v as usize]) - p);
            let [l, m, n] = [a, b, c].map(DVec3::length);
            let under = l * m * n + a.dot(b) * n + b.dot(c) * l + c.dot(a) * m;
            2.0 * a.dot(b.cross(c)).atan2(under)
        };
        surface.triangles.iter().map(angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
    };
    let near = DVec3::new(3e-9, 5e-9, 7e-9);
    let is_inside = |p: DVec3| body.pieces.iter().any(|surface| piece(surface, p) > 0.75);
    is_inside(p + near) && is_inside(p - near)
}

#[test]
fn points_and_segments_that_turn_into_a_body_meet_it_in_proven_bounds() {
    let mut random = Random::new(5_204);
    let rest = Motion::at_rest(still());
    let (mut met, mut free, mut grazed) = (0, 0, 0);
    for _ in 0..cases(600) {
        let body = Body::random(&mut random, 2);
        let Some(solid) = body.solid() else { continue };
        let [p, q] = [0; 2].map(|_| body.place(small(&mut random, -3, 9)));
        let is_point = random.one_in(2);
        let thin = if is_point || p == q { point(p) } else { segment(p, q) };
        let axis = random.pick(&[DVec3::X, DVec3::Y, DVec3::Z]);
        let about = float(body.place(small(&mut random, -2, 8)));
        let turn = Motion::rotation_about(still(), about, axis, 2.0).expect("a turn");
        let cast = MotionCast::between_any(thin.with_motion(&turn), solid.with_motion(&rest))
            .expect("a cast");
        let cast = cast.with_tolerance(0.0).expect("none");
        let place = |time: f64, share: f64| {
            let start = float(p).lerp(float(if is_point { p } else { q }), share);
            DQuat::from_axis_angle(axis, 2.0 * time) * (start - about) + about
        };
        let is_inside =
            |time: f64| (0..=8).any(|k| is_well_inside(&body, place(time, f64::from(k) / 8.0)));
        let apart_up_to = |until: f64| {
            let times = (1..=100).map(|k| until * f64::from(k) / 100.0);
            let inside = times.filter(|t| *t > 0.0).find(|t| is_inside(*t));
            assert_eq!(inside, None, "{p:?} {q:?} {axis} {about} {}", body.told());
        };
        match cast.certified_first_contact().expect("an answer") {
            MotionOutcome::Contact(contact) => {
                assert_eq!(cast.verify(&contact.proof), Ok([contact.lower, contact.upper]));
                // What only touches at first meets later.
                let is_narrow = contact.upper - contact.lower < 1e-7;
                assert!(is_narrow || !is_inside(contact.lower + 1e-7), "{contact:?}");
                apart_up_to(contact.lower - 1e-6);
                met += usize::from(is_narrow);
            }
            MotionOutcome::Grazing(contact) => {
                cast.verify(&contact.proof).expect("a proof that holds");
                apart_up_to(contact.lower - 1e-6);
                // What is seen to be inside a little later is proven to be.
                let soon = is_inside(contact.lower + 1e-7);
                assert!(!soon, "{contact:?} {p:?} {q:?} {axis} {about} {}", body.told());
                grazed += 1;
            }
            MotionOutcome::Free(_) => {
                apart_up_to(1.0);
                free += 1;
            }
            _ => {}
        }
    }
    eprintln!("{met} met, {grazed} grazed, {free} free");
    assert!(met > cases(40) && free > cases(10), "{met} {grazed} {free}");
}

fn stop(body: &ConvexPolyhedron, solid: &Solid, d: Point) -> Option<f64> {
    let cast = Cast::between(body.at(still()), solid.at(still()), float(d)).expect("a cast");
    match cast.with_tolerance(0.0).expect("none").clearance().expect("an answer") {
        Clearance::Blocked { contact, .. } => Some(contact.translation.value),
        Clearance::Free(_) => None,
        Clearance::Overlapping(_) => panic!("they overlap"),
    }
}

#[test]
fn a_point_passes_where_pits_meet_in_a_vertex_or_an_edge() {
    let mut random = Random::new(5_205);
    let apex = |z: i128| Some([[4, 4, z]; 4]);
    let ridge = |z: i128| Some([[3, 4, z], [5, 4, z], [5, 4, z], [3, 4, z]]);
    let across = |z: i128| Some([[4, 3, z], [4, 3, z], [4, 5, z], [4, 5, z]]);
    // The pits meet in a vertex, along an edge, a vertex on an edge, two edges that cross; a pit reaches the lower face.
    for bottoms in [
        [apex(4), apex(4)],
        [ridge(4), ridge(4)],
        [apex(4), ridge(4)],
        [ridge(4), across(4)],
        [apex(0), None],
        [ridge(0), None],
    ] {
        let solid = Surface::block(&mut random, MATRICES[0], &bottoms).solid().expect("a solid");
        let (middle, beside) = (point([4, 4, 9]), point([4, 3, 9]));
        assert_eq!(stop(&middle, &solid, [0, 0, -1]), None, "{bottoms:?}");
        assert_eq!(stop(&point([4, 4, -1]), &solid, [0, 0, 1]), None, "{bottoms:?}");
        assert!(stop(&beside, &solid, [0, 0, -1]).is_some(), "{bottoms:?}");
        // From the side a point is stopped by the block before.
        assert_eq!(stop(&point([4, -1, 4]), &solid, [0, 1, 0]), Some(1.0));
        let rod = segment([4, 4, 9], [4, 4, -1]);
        assert!(stop(&rod, &solid, [1, 0, 0]).is_some(), "{bottoms:?}");
    }
    // A vertex with material behind it stops the point.
    let bottoms = [apex(4), None];
    let solid = Surface::block(&mut random, MATRICES[0], &bottoms).solid().expect("a solid");
    assert_eq!(stop(&point([4, 4, 9]), &solid, [0, 0, -1]), Some(5.0));
}

#[test]
fn a_point_is_inside_a_body_if_it_is_inside_one_piece() {
    let box_of = |low: f64, high: f64| {
        ConvexPolyhedron::cuboid(DVec3::new(-1.0, -1.0, low), DVec3::new(3.0, 3.0, high))
    };
    let [lower, upper, above] =
        [box_of(0.0, 4.0), box_of(2.0, 6.0), box_of(6.0, 8.0)].map(|body| body.expect("a box"));
    let overlapping = Solid::from_pieces([&lower, &upper]).expect("a solid");
    let is_inside = |body: &ConvexPolyhedron, solid: &Solid| {
        let cast = Cast::between(body.at(still()), solid.at(still()), DVec3::Z).expect("a cast");
        cast.with_tolerance(0.0).expect("none").overlaps()
    };
    // On the lower piece's upper face, inside the upper one, and on the side of both.
    assert!(is_inside(&point([0, 0, 4]), &overlapping));
    assert!(is_inside(&segment([0, 0, 4], [1, 1, 4]), &overlapping));
    assert!(!is_inside(&point([3, 0, 3]), &overlapping));
    assert!(!is_inside(&segment([3, 0, 1], [3, 0, 5]), &overlapping));
    // Between two pieces that touch a point passes; it is stopped by what lies behind.
    let touching = Solid::from_pieces([&upper, &above]).expect("a solid");
    assert!(!is_inside(&point([0, 0, 6]), &touching));
    assert_eq!(stop(&point([-2, 0, 6]), &touching, [1, 0, 0]), None);
    assert_eq!(stop(&point([-2, 0, 5]), &touching, [1, 0, 0]), Some(1.0));
}

#[test]
fn a_face_without_thickness_stops_a_point_and_carries_a_rod() {
    let corners = [[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]].map(float);
    let plate = ConvexPolyhedron::from_points(&corners).expect("a polygon");
    let plate = Solid::from_convex(&plate).expect("a plate of two faces");
    // Inside a triangle and on the diagonals between them; at the rim it passes.
    for [x, y] in [[1, 2], [2, 2], [1, 1], [3, 1]] {
        assert_eq!(stop(&point([x, y, 3]), &plate, [0, 0, -1]), Some(3.0), "{x} {y}");
    }
    assert_eq!(stop(&point([4, 2, 3]), &plate, [0, 0, -1]), None);
    assert_eq!(stop(&point([4, 4, 3]), &plate, [0, 0, -1]), None);
    let overlaps = |z: [i128; 2]| {
        let rod = segment([2, 2, z[0]], [2, 2, z[1]]);
        let cast = Cast::between(rod.at(still()), plate.at(still()), DVec3::Z).expect("a cast");
        cast.with_tolerance(0.0).expect("none").overlaps()
    };
    assert_eq!([[0, 3], [-3, 0], [-1, 1]].map(overlaps), [false, false, true]);
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

/// A block with two cavities that touch face to face, and a box through both: where the cavities touch the point lies
/// on two walls of the block, and inside of the box, which stops it.
#[test]
fn a_point_on_two_walls_of_one_piece_is_stopped_by_another_piece() {
    let block = shapes::block([0.0; 3], [12.0; 3])
        .joined(&shapes::block([2.0; 3], [6.0, 10.0, 10.0]).reversed())
        .joined(&shapes::block([6.0, 3.0, 3.0], [10.0, 9.0, 9.0]).reversed());
    let plug = shapes::block([4.0, 6.0, 4.0], [8.0; 3]);
    let solid = |mesh: &Mesh| Solid::from_mesh(&mesh.vertices, &mesh.faces).unwrap();
    let (block, plug) = (solid(&block), solid(&plug));
    let both = Solid::from_pieces([&block, &plug]).unwrap();
    let point = ConvexPolyhedron::from_points(&[DVec3::new(6.0, 5.0, 5.0)]).unwrap();
    for (body, stopped) in [(&block, 5.0), (&plug, 1.0), (&both, 1.0)] {
        let cast = Cast::between(point.at(still()), body.at(still()), DVec3::Y).unwrap();
        let clearance = cast.with_tolerance(0.0).unwrap().clearance().unwrap();
        let Clearance::Blocked { contact, .. } = clearance else { panic!("{clearance:?}") };
        assert_eq!(contact.translation.value, stopped);
    }
}

/// An octahedral cavity that touches the outside of a block, the facets in any order: the vertex that touches says
/// nothing of what the cavity is in.
#[test]
fn a_cavity_that_touches_the_outside_stays_a_cavity() {
    let random = &mut Random::new(17);
    let at = [[4.0, 6.0, 2.0], [8.0, 6.0, 2.0], [6.0, 4.0, 2.0], [6.0, 8.0, 2.0]];
    let mut hollow = shapes::block([0.0; 3], [12.0; 3]);
    let first = hollow.vertices.len() as u32;
    hollow.vertices.extend(at.map(DVec3::from_array));
    hollow.vertices.extend([DVec3::new(6.0, 6.0, 0.0), DVec3::new(6.0, 6.0, 4.0)]);
    for [a, b, c] in
        [[0, 2, 5], [2, 1, 5], [1, 3, 5], [3, 0, 5], [2, 0, 4], [1, 2, 4], [3, 1, 4], [0, 3, 4]]
    {
        hollow.faces.push([a, c, b].map(|v| v + first).to_vec());
    }
    for _ in 0..100 {
        let mut faces = hollow.faces.clone();
        for k in (1..faces.len()).rev() {
            faces.swap(k, random.index(k + 1));
        }
        for face in &mut faces {
            let by = random.index(face.len());
            face.rotate_left(by);
        }
        let solid = Solid::from_mesh(&hollow.vertices, &faces).unwrap();
        let volume = solid.report().shells.iter().map(|shell| shell.volume).sum::<f64>();
        assert!((volume - (1728.0 - 32.0 / 3.0)).abs() < 1e-9, "{volume}");
        assert!(solid.report().shells.iter().all(|shell| !shell.reversed));
        let mut bodies = solid.bodies();
        bodies.dedup();
        assert_eq!(bodies, [0], "the cavity is in the block");
    }
}
