//! Settings that are hard on purpose: random ones, and tied ones, which are the rule among the
//! parts of machines.
//!
//! A setting is a function of its family's name and a seed, so that a line of a report is enough to
//! replay it.

use std::f64::consts::TAU;
use std::fmt;

use colltrans::{BuildError, Cast, ConvexPolyhedron, Outcome, Pose, QueryError, Solver};
use glam::{DQuat, DVec3};

use crate::oracle::check::{Judge, Objection};
use crate::oracle::input::{self, Kept};
use crate::random::Random;
use crate::shapes::cuboid;

/// Two bodies by their points, where they are, and where one is going.
#[derive(Debug, Clone)]
pub struct Setting {
    /// The family it belongs to.
    pub family: &'static str,
    /// The seed it was drawn with.
    pub seed: u64,
    /// Points whose hull is the moving body.
    pub moving: Vec<DVec3>,
    /// Points whose hull is the fixed body.
    pub fixed: Vec<DVec3>,
    /// Where the moving body is.
    pub moving_pose: Pose,
    /// Where the fixed body is.
    pub fixed_pose: Pose,
    /// The direction.
    pub direction: DVec3,
    /// The graze tolerance of the query.
    pub graze_tolerance: f64,
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.family, self.seed)
    }
}

/// The bodies of a setting.
#[derive(Debug, Clone)]
pub struct Bodies {
    /// The moving body.
    pub moving: ConvexPolyhedron,
    /// The fixed body.
    pub fixed: ConvexPolyhedron,
}

impl Setting {
    /// Builds both bodies.
    ///
    /// # Errors
    /// As [`ConvexPolyhedron::from_points`].
    pub fn bodies(&self) -> Result<Bodies, BuildError> {
        Ok(Bodies {
            moving: ConvexPolyhedron::from_points(&self.moving)?,
            fixed: ConvexPolyhedron::from_points(&self.fixed)?,
        })
    }

    /// The query, with default choices but for the graze tolerance.
    ///
    /// # Errors
    /// As [`Cast::new`] and [`Cast::with_graze_tolerance`].
    pub fn query<'a>(&self, bodies: &'a Bodies) -> Result<Cast<'a>, QueryError> {
        let Bodies { moving, fixed } = bodies;
        Cast::new(moving.at(self.moving_pose), fixed.at(self.fixed_pose), self.direction)?
            .with_graze_tolerance(self.graze_tolerance)
    }

    /// Asks the library where the bodies first meet.
    ///
    /// # Errors
    /// As [`Self::query`] and [`Cast::first_contact`].
    pub fn cast(&self, bodies: &Bodies, solver: Solver) -> Result<Outcome, QueryError> {
        self.query(bodies)?.with_solver(solver).first_contact()
    }

    /// The judge of answers about it.
    ///
    /// # Panics
    /// If the library refuses the query.
    pub fn judge<'a>(&self, bodies: &'a Bodies) -> Judge<'a> {
        Judge::new(self.query(bodies).expect("a query")).with_input(&self.moving, &self.fixed)
    }

    /// Holds both bodies against the points that they were made of.
    ///
    /// # Errors
    /// Which one does not keep them, and how; as [`input::judge`].
    pub fn judge_bodies(&self, bodies: &Bodies) -> Result<[Kept; 2], Objection> {
        let named = |name: &'static str| move |e| Objection(format!("{name} body: {e}"));
        Ok([
            input::judge(&self.moving, &bodies.moving).map_err(named("moving"))?,
            input::judge(&self.fixed, &bodies.fixed).map_err(named("fixed"))?,
        ])
    }

    /// All numbers of the setting, for a report.
    pub fn dump(&self) -> String {
        format!("{self:?}")
    }
}

/// A family: its name, and how to draw one of its settings.
pub type Family = (&'static str, fn(&mut Random) -> Draft);

/// All families.
pub const FAMILIES: &[Family] = &[
    ("random", random),
    ("boxes", boxes),
    ("turned-boxes", turned_boxes),
    ("prisms", prisms),
    ("grid", grid),
    ("face-face", face_face),
    ("edge-edge-parallel", edge_edge_parallel),
    ("vertex-over-vertex", vertex_over_vertex),
    ("rim", rim),
    ("identical", identical),
    ("peg", peg),
    ("needle-plate", needle_plate),
    ("size-ratio", size_ratio),
    ("offset", offset),
    ("far", far),
    ("flat", flat),
    ("segment-point", segment_point),
    ("nearly", nearly),
    ("shallow", shallow),
    ("thin", thin),
    ("cylinders", cylinders),
    ("magnitude", magnitude),
    ("narrow-rings", nearly_flat_faces),
    ("nearly-flat-disc", |rng| onto_nearly_flat(rng, disc)),
    ("nearly-flat-prism", |rng| onto_nearly_flat(rng, flat_prism)),
    ("nearly-flat-plate", |rng| onto_nearly_flat(rng, plate)),
    ("nearly-flat-lattice", |rng| onto_nearly_flat(rng, lattice)),
    ("nearly-straight", |rng| onto_nearly_flat(rng, needle)),
];

/// The families of bodies that are hardly thicker than rounding, or less.
pub const NEARLY_FLAT: &[&str] = &[
    "nearly-flat-disc",
    "nearly-flat-prism",
    "nearly-flat-plate",
    "nearly-flat-lattice",
    "nearly-straight",
];

/// A setting before it is turned and scaled as a whole.
#[derive(Debug, Clone)]
pub struct Draft {
    moving: Vec<DVec3>,
    fixed: Vec<DVec3>,
    moving_rotation: DQuat,
    fixed_rotation: DQuat,
    moving_at: DVec3,
    fixed_at: DVec3,
    direction: DVec3,
    graze_tolerance: f64,
}

impl Draft {
    fn new(moving: Vec<DVec3>, fixed: Vec<DVec3>, fixed_at: DVec3, direction: DVec3) -> Self {
        Self {
            moving,
            fixed,
            moving_rotation: DQuat::IDENTITY,
            fixed_rotation: DQuat::IDENTITY,
            moving_at: DVec3::ZERO,
            fixed_at,
            direction,
            graze_tolerance: 0.0,
        }
    }

    fn turned(self, moving_rotation: DQuat, fixed_rotation: DQuat) -> Self {
        Self { moving_rotation, fixed_rotation, ..self }
    }

    /// The whole scene turned: ties that were exact are now ties up to rounding.
    fn turn(&mut self, rotation: DQuat) {
        self.moving_rotation = (rotation * self.moving_rotation).normalize();
        self.fixed_rotation = (rotation * self.fixed_rotation).normalize();
        self.moving_at = rotation * self.moving_at;
        self.fixed_at = rotation * self.fixed_at;
        self.direction = rotation * self.direction;
    }
}

/// The setting of a family with a seed: half of them as drawn, half turned as a whole; some with a
/// direction that is turned around or no unit vector.
///
/// # Panics
/// If there is no such family.
pub fn setting(family: &str, seed: u64) -> Setting {
    let &(family, draw) = FAMILIES.iter().find(|f| f.0 == family).expect("a known family");
    let salt = family.bytes().fold(0, |h: u64, b| h.wrapping_mul(31).wrapping_add(b.into()));
    let mut rng = Random::new(seed ^ salt.rotate_left(32));
    let mut draft = draw(&mut rng);
    if rng.one_in(2) {
        draft.turn(rng.rotation());
    }
    if rng.one_in(4) {
        draft.direction = -draft.direction;
    }
    if rng.one_in(4) {
        draft.direction *= rng.range(-7.0, 7.0).exp();
    }
    let pose = |rotation, at| Pose::new(rotation, at).expect("a rotation");
    Setting {
        family,
        seed,
        moving_pose: pose(draft.moving_rotation, draft.moving_at),
        fixed_pose: pose(draft.fixed_rotation, draft.fixed_at),
        moving: draft.moving,
        fixed: draft.fixed,
        direction: draft.direction,
        graze_tolerance: draft.graze_tolerance,
    }
}

fn cloud(rng: &mut Random) -> Vec<DVec3> {
    let n = rng.int(4, 12);
    let axes = DVec3::new(rng.range(0.4, 1.4), rng.range(0.4, 1.4), rng.range(0.4, 1.4));
    if rng.one_in(2) {
        (0..n).map(|_| rng.direction() * axes).collect()
    } else {
        (0..n).map(|_| rng.vector() * axes).collect()
    }
}

fn whole_box(rng: &mut Random) -> Vec<DVec3> {
    cuboid(rng.grid(1, 4)).vertices
}

/// An upright prism over a regular polygon, the apex angle of the first corner given.
fn prism(sides: u32, radius: f64, half_height: f64, first_rad: f64) -> Vec<DVec3> {
    let corner = |k: u32| {
        let angle_rad = first_rad + TAU * f64::from(k) / f64::from(sides);
        DVec3::new(radius * angle_rad.cos(), radius * angle_rad.sin(), half_height)
    };
    let mirror = DVec3::new(1.0, 1.0, -1.0);
    (0..sides).flat_map(|k| [corner(k), corner(k) * mirror]).collect()
}

fn octahedron(radius: f64) -> Vec<DVec3> {
    DVec3::AXES.into_iter().flat_map(|e| [e * radius, -e * radius]).collect()
}

fn axis(rng: &mut Random) -> DVec3 {
    rng.pick(&DVec3::AXES) * rng.pick(&[1.0, -1.0])
}

/// An axis, or any direction.
fn axis_or_any(rng: &mut Random) -> DVec3 {
    if rng.one_in(2) { axis(rng) } else { rng.direction() }
}

/// Where a body has to be to be met, more or less, along a direction.
fn ahead(rng: &mut Random, direction: DVec3, distance: f64, miss: f64) -> DVec3 {
    direction * distance + rng.direction().cross(direction) * rng.range(0.0, miss)
}

fn random(rng: &mut Random) -> Draft {
    let direction = axis_or_any(rng);
    let distance = rng.range(-3.0, 6.0);
    let at = ahead(rng, direction, distance, 2.0);
    let draft = Draft::new(cloud(rng), cloud(rng), at, direction);
    draft.turned(rng.rotation(), rng.rotation())
}

fn boxes(rng: &mut Random) -> Draft {
    let direction = if rng.one_in(4) { rng.grid(-1, 1) } else { axis(rng) };
    let direction = if direction == DVec3::ZERO { DVec3::Z } else { direction };
    let at = rng.grid(-3, 3) + direction * rng.whole(-4, 12);
    Draft::new(whole_box(rng), whole_box(rng), at, direction)
}

/// Boxes turned by multiples of a right angle, or of half of one.
fn turned_boxes(rng: &mut Random) -> Draft {
    let step = rng.pick(&[TAU / 4.0, TAU / 8.0]);
    let mut turn = || DQuat::from_axis_angle(axis(rng), step * rng.whole(0, 7));
    let (moving, fixed) = (turn(), turn());
    boxes(rng).turned(moving, fixed)
}

fn prisms(rng: &mut Random) -> Draft {
    let sides = rng.int(3, 6) as u32;
    let first_rad = rng.pick(&[0.0, TAU / 12.0, 0.3]);
    let mut one = || prism(sides, rng.whole(1, 3), rng.whole(1, 3), first_rad);
    let (moving, fixed) = (one(), one());
    let direction = if rng.one_in(3) { axis_or_any(rng) } else { DVec3::Z };
    let at = DVec3::new(rng.whole(-2, 2), rng.whole(-2, 2), 0.0) + direction * rng.whole(-3, 10);
    Draft::new(moving, fixed, at, direction)
}

fn grid(rng: &mut Random) -> Draft {
    let mut body = || {
        let n = rng.int(1, 12);
        (0..n).map(|_| rng.grid(0, 3)).collect()
    };
    let (moving, fixed) = (body(), body());
    let direction = rng.grid(-2, 2);
    let direction = if direction == DVec3::ZERO { DVec3::X } else { direction };
    let at = rng.grid(-2, 2) + direction * rng.whole(-1, 4);
    Draft::new(moving, fixed, at, direction)
}

/// A face of one body parallel to a face of the other, touching or apart.
fn face_face(rng: &mut Random) -> Draft {
    let half = rng.grid(1, 3) * 0.25;
    let mut moving = cuboid(half).vertices;
    moving.truncate(rng.pick(&[8, 8, 7, 6]));
    let fixed = prism(rng.int(3, 6) as u32, rng.range(0.3, 2.0), half.z, rng.unit());
    let direction =
        if rng.one_in(2) { DVec3::Z } else { (rng.vector() + DVec3::Z * 2.0).normalize() };
    let any = rng.unit();
    let height = 2.0 * half.z + rng.pick(&[0.0, 0.0, 1.0, any, -0.25]);
    let at = rng.vector() * DVec3::new(1.5, 1.5, 0.0) + DVec3::Z * height;
    Draft::new(moving, fixed, at, direction)
}

/// Two roofs, ridge over ridge.
fn edge_edge_parallel(rng: &mut Random) -> Draft {
    let mut roof = |up: f64| {
        let (length, width, height) = (rng.whole(1, 3), rng.whole(1, 3), up * rng.whole(1, 2));
        let ridge = [DVec3::new(-length, 0.0, height), DVec3::new(length, 0.0, height)];
        let base = cuboid(DVec3::new(length, width, 0.0)).vertices;
        ridge.into_iter().chain(base).collect::<Vec<_>>()
    };
    let (moving, fixed) = (roof(1.0), roof(-1.0));
    let lateral = rng.pick(&[DVec3::ZERO, DVec3::Y * 1e-13, DVec3::X, DVec3::X * 0.3, DVec3::Y]);
    let direction =
        if rng.one_in(3) { DVec3::new(0.0, rng.range(-0.4, 0.4), 1.0) } else { DVec3::Z };
    let at = DVec3::Z * rng.whole(0, 9) + lateral;
    Draft::new(moving, fixed, at, direction)
}

fn vertex_over_vertex(rng: &mut Random) -> Draft {
    let moving = octahedron(rng.whole(1, 3));
    let fixed = if rng.one_in(3) {
        cuboid(DVec3::splat(rng.whole(1, 2))).vertices
    } else {
        octahedron(rng.whole(1, 3))
    };
    let tip = rng.pick(&[DVec3::Z, DVec3::X, DVec3::new(1.0, 1.0, 1.0)]);
    let direction = if rng.one_in(3) { (tip + rng.vector() * 0.2).normalize() } else { tip };
    let at = direction * rng.whole(2, 9) + rng.vector() * rng.pick(&[0.0, 0.0, 1e-15]);
    Draft::new(moving, fixed, at, direction)
}

/// A vertex or an edge that comes down exactly on the rim of a face, or just inside or outside it.
fn rim(rng: &mut Random) -> Draft {
    let half = rng.grid(1, 3);
    let fixed = cuboid(half).vertices;
    let moving = match rng.int(0, 2) {
        0 => octahedron(rng.whole(1, 2)),
        1 => whole_box(rng),
        _ => vec![DVec3::ZERO],
    };
    let reach = moving.iter().map(|v| v.x).fold(0.0, f64::max);
    let inside = rng.pick(&[0.0, 0.0, 0.0, 1e-15, -1e-15, 1e-12, -1e-12, 1e-9, -1e-9]);
    let lateral = if rng.one_in(2) { half.x } else { half.x + reach } - inside * half.x;
    let any = rng.unit();
    let along = rng.pick(&[0.0, half.y, any]);
    let at = DVec3::new(lateral, along, rng.whole(-5, 9));
    Draft::new(moving, fixed, at, DVec3::Z)
}

fn identical(rng: &mut Random) -> Draft {
    let body = if rng.one_in(2) { cloud(rng) } else { whole_box(rng) };
    let direction = axis_or_any(rng);
    let at = match rng.int(0, 3) {
        0 => DVec3::ZERO,
        1 => direction * rng.range(-2.0, 5.0),
        2 => direction * rng.whole(-2, 5),
        _ => body[0] - body[body.len() - 1],
    };
    let rotation = if rng.one_in(2) { rng.rotation() } else { DQuat::IDENTITY };
    Draft::new(body.clone(), body, at, direction).turned(rotation, rotation)
}

/// A peg that slides along a wall with no clearance, or with a little, or with a little too much.
fn peg(rng: &mut Random) -> Draft {
    let (peg, wall) = (rng.grid(1, 4) * 0.1, rng.grid(1, 9) * 0.1);
    let clearance = rng.pick(&[0.0, 0.0, 0.0, 1e-6, -1e-6, 1e-13, -1e-13]);
    let lateral = peg.x + wall.x + clearance;
    let at = DVec3::new(lateral, rng.range(-0.1, 0.1), rng.range(-2.0, 4.0));
    let round = rng.one_in(3);
    let moving = if round {
        prism(6, peg.x, peg.z, rng.pick(&[0.0, TAU / 12.0]))
    } else {
        cuboid(peg).vertices
    };
    let draft = Draft::new(moving, cuboid(wall).vertices, at, DVec3::Z);
    Draft { graze_tolerance: rng.pick(&[0.0, 0.0, 1e-9, 1e-5, 1e-3]), ..draft }
}

fn needle_plate(rng: &mut Random) -> Draft {
    let mut body = || {
        let long = rng.pick(&[100.0, 1000.0]);
        let axes =
            if rng.one_in(2) { DVec3::new(1.0, 1.0, long) } else { DVec3::new(long, long, 1.0) };
        let points: Vec<_> = cloud(rng).into_iter().map(|v| v * axes).collect();
        points
    };
    let (moving, fixed) = (body(), body());
    let direction = axis_or_any(rng);
    let at = ahead(rng, direction, 2000.0, 500.0);
    let draft = Draft::new(moving, fixed, at, direction);
    if rng.one_in(3) { draft } else { draft.turned(rng.rotation(), rng.rotation()) }
}

fn size_ratio(rng: &mut Random) -> Draft {
    let mut draft = if rng.one_in(3) { boxes(rng) } else { random(rng) };
    let factor = rng.pick(&[1e6, 1e-6, 1e3]);
    draft.fixed.iter_mut().for_each(|v| *v *= factor);
    if factor > 1.0 {
        let corner = draft.fixed[0];
        draft.fixed_at +=
            draft.direction * 2.0 * factor - draft.fixed_rotation * corner * rng.pick(&[0.0, 1.0]);
    }
    draft
}

/// Bodies far from the origin of their frame, or of the world, or of both.
fn offset(rng: &mut Random) -> Draft {
    let mut draft = match rng.int(0, 2) {
        0 => boxes(rng),
        1 => grid(rng),
        _ => random(rng),
    };
    let far = rng.pick(&[1e6, 1e3]) * if rng.one_in(2) { rng.grid(-1, 1) } else { rng.vector() };
    if rng.one_in(2) {
        draft.moving_at += far;
        draft.fixed_at += far;
    }
    if rng.one_in(2) {
        draft.moving.iter_mut().for_each(|v| *v += far);
        draft.moving_at -= draft.moving_rotation * far;
    }
    if rng.one_in(2) {
        draft.fixed.iter_mut().for_each(|v| *v -= far);
        draft.fixed_at += draft.fixed_rotation * far;
    }
    draft
}

fn far(rng: &mut Random) -> Draft {
    let mut draft = match rng.int(0, 2) {
        0 => boxes(rng),
        1 => prisms(rng),
        _ => random(rng),
    };
    draft.fixed_at += draft.direction * rng.pick(&[1e4, -1e4, 12345.678]) * 2.0;
    draft
}

fn flat_body(rng: &mut Random) -> Vec<DVec3> {
    let (n, whole) = (rng.int(3, 7), rng.one_in(2));
    (0..n)
        .map(|_| {
            let v = if whole { rng.grid(-2, 2) } else { rng.vector() * 2.0 };
            DVec3::new(v.x, v.y, 0.0)
        })
        .collect()
}

fn flat(rng: &mut Random) -> Draft {
    let moving = flat_body(rng);
    let fixed = if rng.one_in(2) { flat_body(rng) } else { whole_box(rng) };
    let any = rng.direction();
    let direction = rng.pick(&[DVec3::Z, DVec3::X, DVec3::ONE, any]);
    let at = direction * rng.whole(-2, 6) + rng.grid(-1, 1);
    let draft = Draft::new(moving, fixed, at, direction);
    match rng.int(0, 2) {
        0 => draft,
        1 => draft.turned(DQuat::from_rotation_x(TAU / 4.0), DQuat::IDENTITY),
        _ => draft.turned(rng.rotation(), rng.rotation()),
    }
}

fn segment_point(rng: &mut Random) -> Draft {
    let mut small = || match rng.int(0, 2) {
        0 => vec![rng.grid(-1, 1)],
        1 => vec![rng.grid(-1, 1), rng.grid(-1, 1)],
        _ => vec![rng.vector(), rng.vector()],
    };
    let (first, second) = (small(), small());
    let moving = first;
    let fixed = match rng.int(0, 2) {
        0 => second,
        1 => whole_box(rng),
        _ => flat_body(rng),
    };
    let direction = axis_or_any(rng);
    let at = direction * rng.whole(-1, 5) + rng.grid(-1, 1) * rng.pick(&[0.0, 1.0]);
    let swap = rng.one_in(2);
    let draft = Draft::new(moving, fixed, at, direction);
    if swap { Draft { moving: draft.fixed, fixed: draft.moving, ..draft } } else { draft }
}

/// Tied settings whose ties are broken in the last digits.
fn nearly(rng: &mut Random) -> Draft {
    let mut draft = match rng.int(0, 4) {
        0 => boxes(rng),
        1 => prisms(rng),
        2 => edge_edge_parallel(rng),
        3 => vertex_over_vertex(rng),
        _ => face_face(rng),
    };
    let tilt = rng.pick(&[1e-3, 1e-7, 1e-9, 1e-11, 1e-14]);
    draft.moving_rotation = DQuat::from_axis_angle(rng.direction(), tilt);
    draft.moving_at += rng.vector() * rng.pick(&[0.0, tilt]);
    draft
}

/// A block that glides over a slab, a little downwards: the contact normal is almost orthogonal to
/// the direction.
fn shallow(rng: &mut Random) -> Draft {
    let slab =
        cuboid(DVec3::new(rng.whole(2, 9), rng.whole(1, 3), rng.pick(&[0.0, 0.5, 1.0]))).vertices;
    let block = match rng.int(0, 3) {
        0 => octahedron(0.5),
        1 => cloud(rng),
        _ => cuboid(rng.grid(1, 3) * 0.25).vertices,
    };
    let descent = rng.pick(&[0.1, 1e-3, 1e-6, 1e-9, 1e-12, 1e-15, 0.0]);
    let drift = rng.pick(&[0.0, 0.0, 0.3]);
    let direction = DVec3::new(1.0, drift, -descent);
    let start = rng.range(-4.0, 4.0);
    let low = block.iter().map(|v| v.z).fold(f64::INFINITY, f64::min);
    let top = slab[7].z;
    let height = top - low + descent * rng.pick(&[0.0, 1.0, 3.0]);
    let at = DVec3::new(start, rng.range(-1.0, 1.0), -height);
    Draft::new(block, slab, at, direction)
}

/// Slabs from a thousandth of their width down to nothing.
fn thin(rng: &mut Random) -> Draft {
    let mut slab = || {
        let thickness = rng.pick(&[1e-3, 1e-6, 1e-9, 1e-12, 1e-15, 1e-17, 0.0]);
        let half = DVec3::new(rng.whole(1, 2), rng.whole(1, 2), thickness);
        let turn = if rng.one_in(2) { rng.rotation() } else { DQuat::IDENTITY };
        cuboid(half).vertices.into_iter().map(|v| turn * v).collect::<Vec<_>>()
    };
    let (moving, fixed) = (slab(), slab());
    let direction = axis_or_any(rng);
    let at = direction * rng.whole(-1, 6) + rng.vector() * rng.pick(&[0.0, 1.0]);
    let draft = Draft::new(moving, fixed, at, direction);
    if rng.one_in(2) { draft } else { draft.turned(rng.rotation(), DQuat::IDENTITY) }
}

/// Prisms of many sides, side by side or one over the other, on the same axis or tangent.
fn cylinders(rng: &mut Random) -> Draft {
    let sides = rng.pick(&[8, 12]);
    let (r, s) = (rng.whole(1, 3), rng.whole(1, 3));
    let moving = prism(sides, r, rng.whole(1, 2), 0.0);
    let fixed = prism(sides, s, rng.whole(1, 2), rng.pick(&[0.0, TAU / f64::from(2 * sides)]));
    let direction = rng.pick(&[DVec3::Z, DVec3::X, DVec3::new(1.0, 1.0, 0.0)]);
    let lateral = rng.pick(&[DVec3::X, DVec3::Y, DVec3::Z]).reject_from(direction);
    let at = direction * rng.whole(2, 8) + lateral * rng.pick(&[0.0, r + s, r - s, s]);
    Draft::new(moving, fixed, at, direction)
}

/// Very small and very large scenes.
fn magnitude(rng: &mut Random) -> Draft {
    let mut draft = match rng.int(0, 3) {
        0 => boxes(rng),
        1 => grid(rng),
        2 => flat(rng),
        _ => random(rng),
    };
    let factor = rng.pick(&[1e-50, 1e-30, 1e-9, 1e9, 1e30, 1e50]);
    draft.moving.iter_mut().chain(&mut draft.fixed).for_each(|v| *v *= factor);
    draft.moving_at *= factor;
    draft.fixed_at *= factor;
    draft
}

/// Corners on an ellipse, each a share of the thickness off its plane.
fn disc(rng: &mut Random, thickness: f64) -> Vec<DVec3> {
    let (sides, width) = (rng.int(5, 24), rng.pick(&[1.0, 1.0, 0.3, 1e-3]));
    let first_rad = rng.pick(&[0.0, 0.3]);
    (0..sides)
        .map(|k| first_rad + TAU * k as f64 / sides as f64)
        .map(|a| DVec3::new(a.cos(), width * a.sin(), thickness * rng.range(-0.5, 0.5)))
        .collect()
}

fn flat_prism(rng: &mut Random, thickness: f64) -> Vec<DVec3> {
    prism(rng.int(3, 16) as u32, 1.0, 0.5 * thickness, rng.pick(&[0.0, 0.3]))
}

/// A box, or points in one, dense or in a wedge.
fn plate(rng: &mut Random, thickness: f64) -> Vec<DVec3> {
    let half = DVec3::new(1.0, rng.pick(&[1.0, 0.5, 1e-2]), 0.5 * thickness);
    match rng.int(0, 2) {
        0 => cuboid(half).vertices,
        1 => (0..rng.int(5, 24)).map(|_| rng.vector() * half).collect(),
        _ => (0..rng.int(5, 24))
            .map(|_| rng.vector() * half)
            .map(|v| v.with_z(v.z * (1.0 + v.x)))
            .collect(),
    }
}

/// Points of a grid in a plane, each a share of the thickness off it.
fn lattice(rng: &mut Random, thickness: f64) -> Vec<DVec3> {
    let [columns, rows] = [0; 2].map(|_| rng.int(2, 5));
    let mut points = Vec::new();
    for i in 0..columns {
        for j in 0..rows {
            points.push(DVec3::new(i as f64, j as f64, thickness * rng.range(-0.5, 0.5)));
        }
    }
    points
}

/// Points along an axis, each a share of the thickness off it.
fn needle(rng: &mut Random, thickness: f64) -> Vec<DVec3> {
    let across = DVec3::new(0.0, thickness, thickness * rng.pick(&[1.0, 1.0, 1e-2, 1e2]));
    (0..rng.int(4, 16)).map(|_| rng.vector() * across + DVec3::X * rng.range(-1.0, 1.0)).collect()
}

/// A nearly flat body of a shape: `1e-16` to `1e-11` thick, most turned in its frame, some modelled far
/// from the origin and brought back, or left there.
fn nearly_flat(rng: &mut Random, shape: fn(&mut Random, f64) -> Vec<DVec3>) -> Vec<DVec3> {
    let some = 10_f64.powf(rng.range(-16.0, -11.0));
    let thickness = if rng.one_in(5) { 0.0 } else { some };
    let mut points = shape(rng, thickness);
    if !rng.one_in(4) {
        let turn = rng.rotation();
        for v in &mut points {
            *v = turn * *v;
        }
    }
    if rng.one_in(2) {
        let far = rng.direction() * 10_f64.powf(rng.range(0.0, 5.0));
        for v in &mut points {
            *v += far;
        }
        let middle = points.iter().sum::<DVec3>() / points.len() as f64;
        let back = rng.pick(&[far, middle, middle, DVec3::ZERO]);
        for v in &mut points {
            *v -= back;
        }
    }
    points
}

/// A point, a cloud or another such body onto one of the points that a nearly flat body is made of, or
/// next to it.
fn onto_nearly_flat(rng: &mut Random, shape: fn(&mut Random, f64) -> Vec<DVec3>) -> Draft {
    let fixed = nearly_flat(rng, shape);
    let moving = match rng.int(0, 3) {
        0 => cloud(rng),
        1 => nearly_flat(rng, shape),
        _ => vec![DVec3::ZERO],
    };
    let target = rng.pick(&fixed);
    let middle = fixed.iter().sum::<DVec3>() / fixed.len() as f64;
    let inwards = rng.pick(&[0.0, 1e-15, 1e-12, 1e-6, 0.1, 1.0]);
    // Across the rim, along the body, or anyhow.
    let (rim, any) = ((middle - target).normalize_or(DVec3::Z), rng.direction());
    let side = (rng.pick(&fixed) - rng.pick(&fixed)).normalize_or(any);
    let direction = rng.pick(&[any, any, rim, side]);
    let [moving_turn, fixed_turn] =
        [0; 2].map(|_| if rng.one_in(2) { rng.rotation() } else { DQuat::IDENTITY });
    let start = moving_turn * rng.pick(&moving) + direction * rng.range(-0.5, 5.0);
    let at = start - fixed_turn * target.lerp(middle, inwards);
    Draft::new(moving, fixed, at, direction).turned(moving_turn, fixed_turn)
}

/// Rings of a narrow ellipse, the upper ones with corners a few roundings off their plane, above a
/// chamfer and a base: faces with many corners that are flat only nearly, beside edges of any length.
pub fn narrow_rings(rng: &mut Random) -> Vec<DVec3> {
    let ten = |rng: &mut Random, low, high| 10_f64.powf(rng.range(low, high));
    let corners = rng.int(9, 12) as u32;
    let turn = TAU / f64::from(corners);
    let angles: Vec<f64> =
        (0..corners).map(|k| turn * (f64::from(k) + rng.range(-0.3, 0.3))).collect();
    let (width, bump) = (ten(rng, -6.0, 0.0), rng.range(0.0, 200.0) * f64::EPSILON * 0.5);
    let mut slope = ten(rng, -15.0, -6.0);
    let (mut out, mut z, mut points) = (0.0, 0.0, Vec::new());
    for ring in 0..4 {
        let off = if ring < 2 { bump } else { 0.0 };
        points.extend(angles.iter().map(|a| {
            DVec3::new((1.0 + out) * a.cos(), (width + out) * a.sin(), z + rng.range(-off, off))
        }));
        let step = ten(rng, -12.0, 0.0);
        (out, z) = (out + step, z - step * slope);
        slope *= ten(rng, 0.0, 3.0);
    }
    let base = z - ten(rng, -8.0, 1.0);
    points.extend(
        angles.iter().map(|a| DVec3::new((1.0 + out) * a.cos(), (width + out) * a.sin(), base)),
    );
    points
}

/// Narrow rings whose tops face each other, or that of one a cloud, tilted a little.
fn nearly_flat_faces(rng: &mut Random) -> Draft {
    let tilt = |rng: &mut Random| {
        let angle = 10_f64.powf(rng.range(-17.0, -1.0));
        let axis = DVec3::new(rng.range(-1.0, 1.0), rng.range(-1.0, 1.0), 0.0);
        DQuat::from_scaled_axis(axis * angle)
    };
    let over = DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0);
    let moving = narrow_rings(rng);
    let fixed = if rng.one_in(4) { cloud(rng) } else { narrow_rings(rng) };
    let tilts = [(); 2].map(|()| if rng.one_in(4) { DQuat::IDENTITY } else { tilt(rng) });
    let spin = DQuat::from_rotation_z(if rng.one_in(2) { 0.0 } else { rng.range(0.0, TAU) });
    let aside = rng.pick(&[0.0, 1e-9, 1e-3, 0.5, 1.0, 2.0]);
    let at = DVec3::new(rng.range(-aside, aside), rng.range(-aside, aside), rng.range(-1.0, 4.0));
    Draft::new(moving, fixed, at, DVec3::Z).turned(tilts[0], tilts[1] * spin * over)
}
