//! Recognition of fasteners: generated parts of known sizes in random poses, with random numbers of sides, rounded to
//! single precision; parts that look alike; names and units.
//!
//! A generated body is a sequence of rings: star-shaped outlines about `z`, all with corners at the same angles.
//! Consecutive rings are joined, and the first and the last one are closed by fans.

use std::f64::consts::TAU;

use colltrans_assembly::fasteners::{Drive, Fastener, FastenerKind, Fasteners, Head};
use colltrans_assembly::{Assembly, Part, Piece};
use colltrans_mesh::Mesh;
use colltrans_testkit::cases;
use colltrans_testkit::random::Random;
use glam::{DAffine3, DVec2, DVec3};

/// A radius over the angle, in turns.
type Outline = Box<dyn Fn(f64) -> f64>;

/// A body of rings.
struct Lathe {
    /// Angles of the corners in turns, in increasing order.
    turns: Vec<f64>,
    rings: Vec<(f64, Outline)>,
}

/// Returns a circle.
fn circle(radius: f64) -> Outline {
    Box::new(move |_| radius)
}

/// Returns a polygon with its corners at given angles, which is star-shaped.
fn polygon(corners: Vec<DVec2>) -> Outline {
    Box::new(move |turn| {
        let out = DVec2::from_angle(TAU * turn);
        let edges = corners.iter().zip(corners.iter().cycle().skip(1));
        let hits = edges.filter_map(|(&a, &b)| {
            let [x, y] = [out.perp_dot(a), out.perp_dot(b)];
            let point = a + (b - a) * (x / (x - y));
            let is_hit = x <= 1e-12 && y >= -1e-12 && x != y;
            (is_hit && point.dot(out) > 0.0).then(|| point.length())
        });
        hits.fold(0.0, f64::max)
    })
}

/// Returns the corners of a regular polygon with a distance between opposite sides.
fn regular(sides: usize, across: f64) -> Vec<DVec2> {
    let radius = across / 2.0 / (TAU / 2.0 / sides as f64).cos();
    (0..sides).map(|k| DVec2::from_angle(TAU * k as f64 / sides as f64) * radius).collect()
}

/// Returns the corners of a cross with arms of a width and a length.
fn cross(width: f64, length: f64) -> Vec<DVec2> {
    let (a, b) = (width / 2.0, length / 2.0);
    let arm = [DVec2::new(b, -a), DVec2::new(b, a), DVec2::new(a, a)];
    let turned = |k: usize| DVec2::from_angle(TAU * k as f64 / 4.0);
    (0..4).flat_map(|k| arm.map(|p| turned(k).rotate(p))).collect()
}

impl Lathe {
    /// Returns a body with `sides` corners and those of some polygons.
    fn new(sides: usize, polygons: &[&[DVec2]]) -> Self {
        let mut turns: Vec<f64> = (0..sides).map(|k| k as f64 / sides as f64).collect();
        turns.extend(
            polygons.iter().flat_map(|p| p.iter()).map(|p| (p.to_angle() / TAU).rem_euclid(1.0)),
        );
        turns.sort_by(f64::total_cmp);
        turns.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
        Self { turns, rings: Vec::new() }
    }

    fn ring(mut self, z: f64, outline: Outline) -> Self {
        self.rings.push((z, outline));
        self
    }

    /// Appends circles: radius and height.
    fn circles(self, rings: &[[f64; 2]]) -> Self {
        rings.iter().fold(self, |body, &[radius, z]| body.ring(z, circle(radius)))
    }

    /// Appends a thread from one height to another one, with the least and the largest radius.
    fn thread(mut self, [low, high]: [f64; 2], radii: [f64; 2], pitch: f64) -> Self {
        let count = ((high - low) / pitch.abs() * 16.0).ceil() as usize;
        for k in 0..=count {
            let z = low + (high - low) * k as f64 / count as f64;
            let outline = move |turn: f64| {
                let phase = (z / pitch - turn).rem_euclid(1.0);
                radii[0] + (radii[1] - radii[0]) * (1.0 - (2.0 * phase - 1.0).abs())
            };
            self.rings.push((z, Box::new(outline)));
        }
        self
    }

    fn mesh(&self, is_closed_loop: bool) -> Mesh {
        let n = self.turns.len() as u32;
        let mut vertices = Vec::new();
        for (z, outline) in &self.rings {
            let corner = |turn: &f64| (DVec2::from_angle(TAU * turn) * outline(*turn)).extend(*z);
            vertices.extend(self.turns.iter().map(corner));
        }
        let count = self.rings.len() as u32;
        let mut faces: Vec<Vec<u32>> = Vec::new();
        let mut join = |a: u32, b: u32| {
            for k in 0..n {
                let next = (k + 1) % n;
                faces.push(vec![a * n + k, a * n + next, b * n + next]);
                faces.push(vec![a * n + k, b * n + next, b * n + k]);
            }
        };
        (1..count).for_each(|k| join(k - 1, k));
        if is_closed_loop {
            join(count - 1, 0);
        } else {
            for (ring, is_first) in [(0, true), (count - 1, false)] {
                let middle = vertices.len() as u32;
                vertices.push(DVec3::Z * self.rings[ring as usize].0);
                for k in 0..n {
                    let [a, b] = [ring * n + k, ring * n + (k + 1) % n];
                    faces.push(if is_first { vec![middle, b, a] } else { vec![middle, a, b] });
                }
            }
        }
        Mesh::new(vertices, faces)
    }

    /// Returns a solid body, from the tip over its surface to the bottom of its recess.
    fn solid(&self) -> Mesh {
        self.mesh(false)
    }

    /// Returns a body with a hole: the last ring is joined with the first one.
    fn tube(&self) -> Mesh {
        self.mesh(true)
    }
}

/// Returns a part in a random pose, with coordinates rounded to single precision, and the pose.
fn placed(name: &str, mesh: &Mesh, random: &mut Random) -> (Part, DAffine3) {
    let at = random.vector() * 200.0;
    let pose = DAffine3::from_rotation_translation(random.rotation(), at);
    let corner = |v: &DVec3| pose.transform_point3(*v).as_vec3().as_dvec3();
    let mesh = Mesh::new(mesh.vertices.iter().map(corner).collect(), mesh.faces.clone());
    let piece = Piece { mesh, world_from_piece: DAffine3::IDENTITY };
    (crate::common::part(name, &[piece]), pose)
}

/// Returns the fastener that a mesh is.
fn recognised(name: &str, mesh: &Mesh, random: &mut Random) -> (Option<Fastener>, DAffine3) {
    let (part, pose) = placed(name, mesh, random);
    let found = Fasteners::find(&Assembly::new(vec![part]).unwrap());
    (found.get(0).cloned(), pose)
}

/// Metric sizes with their coarse pitch.
const SIZES: [[f64; 2]; 9] = [
    [2.0, 0.4],
    [2.5, 0.45],
    [3.0, 0.5],
    [4.0, 0.7],
    [5.0, 0.8],
    [6.0, 1.0],
    [8.0, 1.25],
    [12.0, 1.75],
    [20.0, 2.5],
];

/// Returns a screw with the tip at `z = -length` and the seat of its head at `z = 0`. `pitch` is that of the modelled
/// thread; 0 for a plain shank.
fn screw(sides: usize, d: f64, length: f64, head: Head, drive: Option<Drive>, pitch: f64) -> Mesh {
    let recess = match drive {
        Some(Drive::HexSocket) => regular(6, 0.8 * d),
        Some(Drive::SquareSocket) => regular(4, 0.7 * d),
        Some(Drive::Cross) => cross(0.25 * d, 1.1 * d),
        Some(Drive::Slot) => [[-1.4, -0.25], [1.4, -0.25], [1.4, 0.25], [-1.4, 0.25]]
            .map(|p| DVec2::from_array(p) * d / 2.0)
            .to_vec(),
        _ => Vec::new(),
    };
    let hexagon = regular(6, 1.6 * d);
    let is_hexagon = head == Head::Hexagon;
    let body = Lathe::new(sides, &[&recess, if is_hexagon { &hexagon } else { &[] }]);
    let r = d / 2.0;
    let body = body.circles(&[[0.8 * r, -length], [r, -length + 0.2 * r]]);
    let body = if pitch == 0.0 {
        body
    } else {
        let end = -length * 0.15 - 0.1 * d;
        body.thread([-length + 0.3 * r, end], [r - 0.61 * pitch.abs(), r], pitch)
            .circles(&[[r, end + 0.1 * r]])
    };
    let (body, top) = match head {
        Head::Hexagon => {
            let outline = || polygon(regular(6, 1.6 * d));
            (body.ring(0.0, circle(r)).ring(0.0, outline()).ring(0.65 * d, outline()), 0.65 * d)
        }
        Head::Cylinder => (body.circles(&[[r, 0.0], [1.6 * r, 0.0], [1.6 * r, d]]), d),
        Head::Countersunk => {
            (body.circles(&[[r, 0.0], [2.0 * r, r], [2.0 * r, 1.02 * r]]), 1.02 * r)
        }
        _ => {
            let dome = [[1.8, 0.0], [1.75, 0.2], [1.6, 0.4], [1.4, 0.5]];
            let dome = dome.map(|[x, z]| [x * r, z * d]);
            (body.circles(&[[r, 0.0]]).circles(&dome), 0.5 * d)
        }
    };
    if recess.is_empty() {
        return body.solid();
    }
    let depth = if head == Head::Countersunk { 0.6 * r } else { 0.5 * top };
    body.ring(top, polygon(recess.clone())).ring(top - depth, polygon(recess)).solid()
}

/// Returns a ring between two radii; the outline of the outside may be another one.
fn ring(
    sides: usize,
    hole: f64,
    outside: &dyn Fn() -> Outline,
    height: f64,
    more: &[DVec2],
) -> Mesh {
    let body = Lathe::new(sides, &[more]);
    body.ring(height, circle(hole))
        .ring(0.0, circle(hole))
        .ring(0.0, outside())
        .ring(height, outside())
        .tube()
}

#[test]
fn screws_have_their_sizes_in_any_pose_and_tessellation() {
    let mut random = Random::new(11);
    let kinds = [
        (Head::Hexagon, None),
        (Head::Cylinder, Some(Drive::HexSocket)),
        (Head::Cylinder, Some(Drive::SquareSocket)),
        (Head::Cylinder, Some(Drive::Slot)),
        (Head::Countersunk, Some(Drive::Cross)),
        (Head::Countersunk, Some(Drive::HexSocket)),
        (Head::Countersunk, None),
        (Head::Rounded, Some(Drive::HexSocket)),
        (Head::Rounded, Some(Drive::Cross)),
    ];
    for round in 0..cases(360) {
        let (head, drive) = kinds[round % kinds.len()];
        let [d, coarse] = random.pick(&SIZES);
        let length = (d * random.range(1.2, 8.0)).ceil();
        let sides = 10 + random.index(50);
        let pitch = if random.one_in(3) { coarse * random.pick(&[1.0, -1.0]) } else { 0.0 };
        let mesh = screw(sides, d, length, head, drive, pitch);
        let (found, pose) = recognised("body", &mesh, &mut random);
        let case = format!("M{d} x {length}, {head:?}, {drive:?}, {sides} sides, pitch {pitch}");
        let found = found.unwrap_or_else(|| panic!("not recognised: {case}"));
        assert_eq!(
            (found.kind, found.head),
            (FastenerKind::Screw, Some(head)),
            "{case}: {found:?}"
        );
        // The axis of a modelled thread is less accurate, because the normals of its flanks do not meet it.
        let accuracy = d * if pitch == 0.0 { 1e-3 } else { 1e-2 };
        assert!((found.diameter - d).abs() < accuracy, "{case}: {found:?}");
        let total = if head == Head::Countersunk { length + 0.51 * d } else { length };
        assert!((found.length - total).abs() < 1e-3 * d, "{case}: {found:?}");
        assert_eq!(found.metric, Some(d), "{case}");
        if head != Head::Countersunk {
            assert_eq!(found.designation, format!("M{d} x {length}"));
        }
        assert_eq!(found.drive.map(|x| x.0), drive, "{case}: {found:?}");
        let wide = match drive {
            Some(Drive::HexSocket) => 0.8 * d,
            Some(Drive::SquareSocket) => 0.7 * d,
            _ => found.drive.map_or(0.0, |x| x.1),
        };
        assert!(found.drive.is_none_or(|x| (x.1 - wide).abs() < accuracy), "{case}: {found:?}");
        assert_eq!(found.standard_pitch, Some(coarse));
        match found.pitch {
            Some(own) => assert!((own - pitch).abs() < 0.05 * coarse, "{case}: {own}"),
            // A thread of a short shank is not always found; a thread is never invented.
            None => assert!(pitch == 0.0 || length < 2.5 * d, "{case}"),
        }
        let axis = pose.transform_vector3(DVec3::Z);
        assert!(found.axis[1].dot(axis) > 0.999_9, "{case}: {found:?}");
        let off = (found.axis[0] - pose.translation).reject_from(axis);
        assert!(off.length() < 0.01 * d, "{case}: {found:?}");
    }
}

#[test]
fn nuts_washers_dowels_and_bearings_have_their_sizes() {
    let mut random = Random::new(12);
    let sizes = [
        [3.0, 5.5, 3.2, 7.0],
        [5.0, 8.0, 5.3, 10.0],
        [8.0, 13.0, 8.4, 16.0],
        [12.0, 18.0, 13.0, 24.0],
    ];
    for _ in 0..cases(120) {
        let [d, flats, hole, rim] = random.pick(&sizes);
        let sides = 12 + random.index(40);
        let hexagon = regular(6, flats);
        // The hole is drawn at the nominal diameter, at the core, or between.
        let bore = d * random.range(0.85, 1.0);
        let nut = ring(sides, bore / 2.0, &|| polygon(regular(6, flats)), 0.8 * d, &hexagon);
        let found = recognised("part", &nut, &mut random).0.expect("a nut");
        assert_eq!((found.kind, &found.designation[..]), (FastenerKind::Nut, &format!("M{d}")[..]));
        assert!((found.width - flats).abs() < 1e-3 && (found.diameter - bore).abs() < 1e-3);
        let washer = ring(sides, hole / 2.0, &|| circle(rim / 2.0), 0.2 * d, &[]);
        let found = recognised("part", &washer, &mut random).0.expect("a washer");
        assert_eq!((found.kind, found.metric), (FastenerKind::Washer, Some(d)));
        assert!((found.diameter - hole).abs() < 1e-3 && (found.length - 0.2 * d).abs() < 1e-3);
        let length = if d == 12.0 { 50.0 } else { 4.0 * d };
        let rounded = [[0.45, 0.0], [0.5, 0.02], [0.5, 0.98], [0.45, 1.0]];
        let rounded = rounded.map(|[r, z]| [r * d, z * length]);
        let dowel = Lathe::new(sides, &[]).circles(&rounded).solid();
        let found = recognised("part", &dowel, &mut random).0.expect("a dowel");
        assert_eq!(found.designation, format!("{d} x {length}"));
        assert_eq!(found.kind, FastenerKind::Dowel);
    }
    let bearing = ring(40, 4.0, &|| circle(11.0), 7.0, &[]);
    let found = recognised("part", &bearing, &mut random).0.expect("a bearing");
    assert_eq!((found.kind, &found.designation[..]), (FastenerKind::Bearing, "608"));
}

/// Returns the prism over the outline of an open ring.
fn open_ring(sides: usize, radii: [f64; 2], gap: f64, height: f64) -> Mesh {
    let at = |k: usize, r: f64| {
        DVec2::from_angle(TAU * (gap / 2.0 + (1.0 - gap) * k as f64 / sides as f64)) * r
    };
    let mut vertices = Vec::new();
    for k in 0..=sides {
        for (r, z) in [(radii[0], 0.0), (radii[1], 0.0), (radii[1], height), (radii[0], height)] {
            vertices.push(at(k, r).extend(z));
        }
    }
    let mut faces: Vec<Vec<u32>> = vec![vec![0, 1, 2, 3]];
    let last = 4 * sides as u32;
    faces.push(vec![last + 3, last + 2, last + 1, last]);
    for k in 0..sides as u32 {
        for j in 0..4 {
            let [a, b] = [4 * k + j, 4 * k + (j + 1) % 4];
            faces.push(vec![b, a, a + 4, b + 4]);
        }
    }
    Mesh::new(vertices, faces)
}

#[test]
fn circlips_and_keys_have_their_sizes() {
    let mut random = Random::new(13);
    for _ in 0..cases(60) {
        let inside = random.range(4.0, 30.0);
        let mesh = open_ring(
            20 + random.index(30),
            [inside, 1.2 * inside],
            random.range(0.08, 0.3),
            0.1 * inside,
        );
        let found = recognised("part", &mesh, &mut random).0.expect("a circlip");
        assert_eq!(found.kind, FastenerKind::Circlip);
        assert!((found.diameter / inside - 2.0).abs() < 0.02, "{found:?} {inside}");
        let [b, h] = random.pick(&[[5.0, 5.0], [8.0, 7.0], [12.0, 8.0]]);
        let length = b * random.range(2.0, 6.0).round();
        let (half, straight) = (b / 2.0, length / 2.0 - b / 2.0);
        let sides = 16;
        let end = |k: usize| {
            let turn =
                DVec2::from_angle(TAU * (k % (2 * sides)) as f64 / 2.0 / sides as f64 - TAU / 4.0);
            turn * half + DVec2::X * straight
        };
        let right = (0..=sides).map(end);
        let outline: Vec<DVec3> =
            right.clone().chain(right.map(|p| -p)).map(|p| p.extend(0.0)).collect();
        let mesh = file_mesh(colltrans_testkit::shapes::extruded(&outline, [0.0, h]));
        let found = recognised("part", &mesh, &mut random).0.expect("a key");
        assert_eq!(found.designation, format!("{b} x {h} x {length}"));
        assert_eq!(found.kind, FastenerKind::Key);
    }
}

fn file_mesh(mesh: colltrans_testkit::shapes::Mesh) -> Mesh {
    Mesh::new(mesh.vertices, mesh.faces)
}

/// Returns the parts that resemble fasteners.
fn look_alikes() -> Vec<(&'static str, Mesh)> {
    let shaft = |rings: &[[f64; 2]]| Lathe::new(32, &[]).circles(rings).solid();
    let hexagon = regular(6, 8.0);
    let bar = |length: f64| {
        let body = Lathe::new(12, &[&hexagon]);
        body.ring(0.0, polygon(regular(6, 8.0))).ring(length, polygon(regular(6, 8.0))).solid()
    };
    let flanged = Lathe::new(32, &[]);
    let rings = [[3.0, 0.0], [5.0, 0.0], [5.0, 12.0], [9.0, 12.0], [9.0, 15.0], [3.0, 15.0]];
    vec![
        ("shaft", shaft(&[[5.0, 0.0], [5.0, 73.3]])),
        (
            "shaft with a collar",
            shaft(&[[4.0, 0.0], [4.0, 30.0], [7.0, 30.0], [7.0, 36.0], [4.0, 36.0], [4.0, 50.0]]),
        ),
        (
            "shaft with a collar at its end",
            shaft(&[[4.0, 0.0], [4.0, 30.0], [7.0, 30.0], [7.0, 36.0]]),
        ),
        ("valve", shaft(&[[3.0, 0.0], [3.0, 80.0], [16.0, 88.0], [16.0, 90.0]])),
        ("disc", shaft(&[[20.0, 0.0], [20.0, 3.0]])),
        ("hexagon bar", bar(60.0)),
        ("hexagon block", bar(6.0)),
        ("flanged bushing", flanged.circles(&rings).tube()),
        ("pipe", ring(32, 4.0, &|| circle(5.0), 60.0, &[])),
        ("spacer", ring(32, 4.1, &|| circle(7.3), 9.0, &[])),
        ("hexagon spacer", ring(32, 2.5, &|| polygon(regular(6, 8.0)), 30.0, &hexagon)),
        ("wide ring", ring(48, 30.0, &|| circle(34.0), 2.0, &[])),
        ("box", file_mesh(colltrans_testkit::shapes::block([0.0; 3], [8.0, 7.0, 30.0]))),
        ("plate", file_mesh(colltrans_testkit::shapes::block([0.0; 3], [40.0, 20.0, 3.0]))),
    ]
}

#[test]
fn parts_that_look_alike_are_no_fasteners() {
    let mut random = Random::new(14);
    for (name, mesh) in look_alikes() {
        let found = recognised(name, &mesh, &mut random).0;
        assert_eq!(found, None, "{name}");
    }
}

#[test]
fn name_is_never_enough_and_confirms_plain_shapes() {
    let mut random = Random::new(15);
    let plain = [[2.5, -20.0], [2.5, 0.0], [4.25, 0.0], [4.25, 5.0]];
    let mesh = Lathe::new(32, &[]).circles(&plain).solid();
    assert_eq!(recognised("bolted_rod", &mesh, &mut random).0, None);
    let found = recognised("keeper_screw_1", &mesh, &mut random).0.expect("a screw by its name");
    assert_eq!((&found.designation[..], found.needs_name), ("M5 x 20", true));
    assert_eq!(found.title(), "screw M5 x 20");
    assert_eq!(found.details(), "cylinder head, thread not modelled, by its name");
    // A shank drawn at its core has the size of its name, another one its measured diameter.
    let core = [[2.1, -20.0], [2.1, 0.0], [4.25, 0.0], [4.25, 5.0]];
    let mesh = Lathe::new(32, &[]).circles(&core).solid();
    assert_eq!(recognised("M5x20", &mesh, &mut random).0.unwrap().designation, "M5 x 20");
    let mesh = Lathe::new(32, &[]).circles(&core.map(|[r, z]| [1.07 * r, z])).solid();
    assert_eq!(recognised("screw", &mesh, &mut random).0.unwrap().designation, "4.49 x 20");
    for (name, mesh) in look_alikes() {
        for kind in ["screw", "nut", "M5x20", "circlip", "DIN 934"] {
            let is_headed = name == "shaft with a collar at its end";
            let found = recognised(kind, &mesh, &mut random).0;
            assert_eq!(
                found.is_some(),
                is_headed && ["screw", "M5x20"].contains(&kind),
                "{name} {kind}"
            );
        }
    }
}

#[test]
fn unit_of_the_files_gives_the_same_designation() {
    let mut random = Random::new(16);
    let mesh = screw(24, 5.0, 20.0, Head::Cylinder, Some(Drive::HexSocket), 0.0);
    for (unit, factor) in [("m", 1e-3), ("mm", 1.0), ("in", 1.0 / 25.4)] {
        let scaled =
            Mesh::new(mesh.vertices.iter().map(|v| *v * factor).collect(), mesh.faces.clone());
        let at = DAffine3::from_rotation_translation(random.rotation(), DVec3::ONE * factor);
        let part = crate::common::part("part", &[Piece { mesh: scaled, world_from_piece: at }]);
        let assembly = Assembly::new(vec![part]).unwrap().with_unit(unit);
        let found = Fasteners::find(&assembly);
        let found = found.get(0).unwrap();
        assert_eq!(found.designation, "M5 x 20", "{unit}");
        assert!((found.length - 20.0 * factor).abs() < 1e-5 * factor);
    }
}

#[test]
fn recognition_visits_each_facet_a_bounded_number_of_times() {
    let mut random = Random::new(17);
    for sides in [16, 64, 256, 1024] {
        let mesh = screw(sides, 8.0, 30.0, Head::Cylinder, Some(Drive::HexSocket), 0.0);
        let count = mesh.faces.len() as u64;
        let (part, _) = placed("part", &mesh, &mut random);
        let found = Fasteners::find(&Assembly::new(vec![part]).unwrap());
        assert!(!found.is_empty());
        assert!(found.work() <= 60 * count, "{} visits of {count} facets", found.work());
    }
}
