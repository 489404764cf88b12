//! Draws settings that are deliberately difficult: random ones, and ties, which are common among machine parts.
//!
//! A setting is a function of the family's name and a seed, so that a line of a report suffices to replay it.

mod bodies;
mod nearly_flat;
mod stretched;
mod tied;

use std::fmt;

use colltrans::{BuildError, Cast, ConvexPolyhedron, Outcome, Pose, QueryError, Solver};
use glam::{DQuat, DVec3};

use crate::oracle::check::{Judge, Objection};
use crate::oracle::input::{self, Kept};
use crate::random::Random;

pub use self::nearly_flat::narrow_rings;
use self::nearly_flat::{
    disc, flat_prism, lattice, nearly_flat_faces, needle, onto_nearly_flat, plate,
};
use self::stretched::{
    far, flat, magnitude, needle_plate, offset, random, segment_point, shallow, size_ratio, thin,
};
use self::tied::{
    boxes, cylinders, edge_edge_parallel, face_face, grid, identical, nearly, peg, prisms, rim,
    turned_boxes, vertex_over_vertex,
};
use crate::shapes::reach;

/// Two bodies given by points, their poses, and the direction.
#[derive(Debug, Clone)]
pub struct Setting {
    /// The family.
    pub family: &'static str,
    /// The seed.
    pub seed: u64,
    /// The points whose hull is the moving body.
    pub moving: Vec<DVec3>,
    /// The points whose hull is the fixed body.
    pub fixed: Vec<DVec3>,
    /// The pose of the moving body.
    pub moving_pose: Pose,
    /// The pose of the fixed body.
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
    /// The errors of [`ConvexPolyhedron::from_points`].
    pub fn bodies(&self) -> Result<Bodies, BuildError> {
        Ok(Bodies {
            moving: ConvexPolyhedron::from_points(&self.moving)?,
            fixed: ConvexPolyhedron::from_points(&self.fixed)?,
        })
    }

    /// Builds the query, with default options except for the graze tolerance.
    ///
    /// # Errors
    /// The errors of [`Cast::new`] and [`Cast::with_graze_tolerance`].
    pub fn query<'a>(&self, bodies: &'a Bodies) -> Result<Cast<'a>, QueryError> {
        let Bodies { moving, fixed } = bodies;
        Cast::new(moving.at(self.moving_pose), fixed.at(self.fixed_pose), self.direction)?
            .with_graze_tolerance(self.graze_tolerance)
    }

    /// Computes the first contact with a solver.
    ///
    /// # Errors
    /// The errors of [`Self::query`] and [`Cast::first_contact`].
    pub fn cast(&self, bodies: &Bodies, solver: Solver) -> Result<Outcome, QueryError> {
        self.query(bodies)?.with_solver(solver).first_contact()
    }

    /// Builds the judge of answers.
    ///
    /// # Panics
    /// If the library rejects the query.
    pub fn judge<'a>(&self, bodies: &'a Bodies) -> Judge<'a> {
        Judge::new(self.query(bodies).expect("a query")).with_input(&self.moving, &self.fixed)
    }

    /// Compares both bodies with their input points.
    ///
    /// # Errors
    /// [`Objection`] of [`input::judge`] with the name of the body.
    pub fn judge_bodies(&self, bodies: &Bodies) -> Result<[Kept; 2], Objection> {
        let named = |name: &'static str| move |e| Objection(format!("{name} body: {e}"));
        Ok([
            input::judge(&self.moving, &bodies.moving).map_err(named("moving"))?,
            input::judge(&self.fixed, &bodies.fixed).map_err(named("fixed"))?,
        ])
    }

    /// Returns all numbers of the setting for a report.
    pub fn dump(&self) -> String {
        format!("{self:?}")
    }
}

/// A family: its name, and the function that draws a setting.
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

/// The families of bodies with a thickness of about rounding errors or less.
pub const NEARLY_FLAT: &[&str] = &[
    "nearly-flat-disc",
    "nearly-flat-prism",
    "nearly-flat-plate",
    "nearly-flat-lattice",
    "nearly-straight",
];

/// A setting before it is rotated and scaled as a whole.
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
    /// Builds a draft without rotations, with the moving body at the origin.
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

    /// Sets the rotations.
    fn turned(self, moving_rotation: DQuat, fixed_rotation: DQuat) -> Self {
        Self { moving_rotation, fixed_rotation, ..self }
    }

    /// Rotates the whole scene. Exact ties become ties up to rounding.
    fn turn(&mut self, rotation: DQuat) {
        self.moving_rotation = (rotation * self.moving_rotation).normalize();
        self.fixed_rotation = (rotation * self.fixed_rotation).normalize();
        self.moving_at = rotation * self.moving_at;
        self.fixed_at = rotation * self.fixed_at;
        self.direction = rotation * self.direction;
    }
}

/// Returns a pose of the moving body with a gap or a depth along the direction, of `1e-3` to `1e-15` of the
/// size, or zero. `None` for settings that are left unchanged.
pub fn near_contact(setting: &Setting, bodies: &Bodies, random: &mut Random) -> Option<Pose> {
    let kind = random.index(8);
    if kind < 2 {
        return None;
    }
    let cast = setting.query(bodies).ok()?;
    let Outcome::Contact(contact) = cast.first_contact().ok()? else { return None };
    let way = cast.direction() * contact.translation;
    let size = [&bodies.moving, &bodies.fixed].map(|body| reach(body.vertices()));
    let gap = 10.0_f64.powf(-random.range(3.0, 15.0)) * (size[0] + size[1]);
    let back = cast.direction().normalize()
        * match kind {
            2..=5 => gap,
            6 => 0.0,
            _ => -gap,
        };
    setting.moving_pose.translated_by(way - back).ok()
}

/// Draws the setting of a family with a seed. Half of them are rotated as a whole. For some the direction is
/// reversed or is not a unit vector.
///
/// # Panics
/// If the family is unknown.
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
