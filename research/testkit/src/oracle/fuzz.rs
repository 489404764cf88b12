//! Implements the fuzz targets. Tests run the corpora through the same functions.
//!
//! The first byte selects how bytes are converted to numbers: as bits of `f64`, which yields all special values
//! and magnitudes, or as small integers, which yields all ties.

mod motions;
mod pairs;

use std::fs;
use std::path::Path;

use colltrans::solid::{SolidCast, SolidFree, SolidOptions, StartProof};
use colltrans::{
    Cast, Clearance, ConvexPolyhedron, FixedRotations, Pose, PoseError, Solid, Solver,
};
use glam::{DQuat, DVec3};

use crate::oracle::input;
use crate::oracle::scene::size;
use crate::oracle::settings::{Bodies, Setting};
use crate::oracle::solids::encloses;
use crate::oracle::solids::facets::{rule, triangles};
use crate::oracle::solids::proof::{MOST_PAIRS, approve};
use crate::oracle::still;
use crate::oracle::tracked::{Finding, Lanes};
pub use motions::motion;
pub use pairs::{among, depth, distance, min_gap, rounded, within};

/// Maximum number of points of a body. More points would only slow down a run.
const MOST_POINTS: usize = 64;
/// Maximum number of points of a body that is judged in exact arithmetic.
const MOST_JUDGED: usize = 10;
/// Maximum number of settings of a sequence.
const MOST_STEPS: usize = 24;

/// Returns the contents of the files of a target's corpus. Each name is printed first, so that a failure shows
/// it.
///
/// # Panics
/// If there are fewer than `at_least` files.
pub fn corpus(target: &str, at_least: usize) -> impl Iterator<Item = Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus").join(target);
    let mut files: Vec<_> = fs::read_dir(&folder)
        .unwrap_or_else(|e| panic!("{}: {e}", folder.display()))
        .map(|entry| entry.expect("an entry").path())
        .collect();
    files.sort();
    assert!(files.len() >= at_least, "{} files only in {}", files.len(), folder.display());
    files.into_iter().map(|file| {
        println!("{}", file.display());
        fs::read(file).expect("a file")
    })
}

/// A reader of bytes as numbers. After the end it returns zeros.
#[derive(Debug, Clone)]
pub struct Reader<'a> {
    bytes: &'a [u8],
    whole: bool,
}

impl<'a> Reader<'a> {
    /// Builds a reader. The first byte selects the conversion.
    pub fn new(bytes: &'a [u8]) -> Self {
        let (mode, bytes) = bytes.split_first().unwrap_or((&0, &[]));
        Self { bytes, whole: mode % 2 == 1 }
    }

    /// Checks whether all bytes were read.
    fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    /// Reads a byte.
    fn byte(&mut self) -> u8 {
        let (first, rest) = self.bytes.split_first().unwrap_or((&0, &[]));
        self.bytes = rest;
        *first
    }

    /// Reads a number.
    fn number(&mut self) -> f64 {
        if self.whole {
            return f64::from(self.byte().cast_signed());
        }
        let mut bits = [0; 8];
        bits.fill_with(|| self.byte());
        f64::from_le_bytes(bits)
    }

    /// Reads a vector.
    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.number(), self.number(), self.number())
    }

    /// Reads up to `most` points.
    fn points(&mut self, most: usize) -> Vec<DVec3> {
        let count = usize::from(self.byte()) % (most + 1);
        (0..count).map(|_| self.vector()).collect()
    }

    /// Reads a rotation.
    fn rotation(&mut self) -> DQuat {
        let bytes = [0; 4].map(|_| f64::from(self.byte().cast_signed()));
        let q = DQuat::from_array(bytes);
        if q.length_squared() > 0.0 { q.normalize() } else { DQuat::IDENTITY }
    }
}

/// Checks the convex hull of any points: a second construction yields the same body, its vertices are among the
/// points, and no point is farther from it than its hull error.
///
/// # Panics
/// If a check fails.
pub fn hull(bytes: &[u8]) {
    let mut reader = Reader::new(bytes);
    let mut points = Vec::new();
    while !reader.is_empty() && points.len() < MOST_POINTS {
        points.push(reader.vector());
    }
    let Ok(body) = ConvexPolyhedron::from_points(&points) else { return };
    let again = ConvexPolyhedron::from_points(&points).expect("it worked before");
    assert_eq!(body.vertices(), again.vertices(), "two hulls of the same points");
    check_surface(&body);
    input::judge(&points, &body).unwrap_or_else(|e| panic!("{e}"));
}

/// Checks that a mesh is rejected, or yields a body with a closed surface and the vertices of the mesh.
///
/// # Panics
/// If a check fails.
pub fn from_mesh(bytes: &[u8]) {
    let mut reader = Reader::new(bytes);
    let tolerance = if reader.byte().is_multiple_of(2) { 0.0 } else { reader.number() };
    let vertices = reader.points(MOST_POINTS);
    let mut faces = Vec::new();
    while !reader.is_empty() {
        let corners = usize::from(reader.byte() % 9);
        faces.push((0..corners).map(|_| u32::from(reader.byte())).collect::<Vec<u32>>());
    }
    let Ok(body) = ConvexPolyhedron::from_mesh(&vertices, &faces, tolerance) else { return };
    for (vertex, input) in body.vertices().iter().zip(body.input_indices()) {
        assert_eq!(*vertex, vertices[input.index()], "a vertex that is not the mesh's");
    }
    check_surface(&body);
}

/// Checks that a cast is rejected, or that its answer with every solver is approved by the exact judge.
///
/// # Panics
/// If a check fails.
pub fn cast(bytes: &[u8]) {
    let mut reader = Reader::new(bytes);
    let Some((setting, bodies)) = read_setting(&mut reader) else { return };
    setting.judge_bodies(&bodies).unwrap_or_else(|e| panic!("{e}"));
    for solver in [Solver::Cta, Solver::Portal, Solver::Auto] {
        let outcome = match setting.cast(&bodies, solver) {
            Ok(outcome) => outcome,
            Err(colltrans::QueryError::Direction { .. }) => return,
            Err(error) => panic!("{solver:?}: {error}"),
        };
        let judge = setting.judge(&bodies);
        judge.check(&outcome).unwrap_or_else(|e| panic!("{solver:?}: {e}"));
        judge.compare_with_oracle(&outcome).unwrap_or_else(|e| panic!("{solver:?}: {e}"));
    }
}

/// Checks that trackers with every focus and solver give the answers of single casts, along a sequence of
/// changes of poses, direction and graze tolerance.
///
/// # Panics
/// If an answer is wrong, or only one of the queries is rejected.
pub fn track(bytes: &[u8]) {
    let mut reader = Reader::new(bytes);
    let Some((mut setting, bodies)) = read_setting(&mut reader) else { return };
    let mut lanes = Lanes::new(&bodies);
    for _ in 0..MOST_STEPS {
        for finding in lanes.ask(&setting, true) {
            let Finding { lane, solver, verdict, .. } = finding;
            verdict.unwrap_or_else(|e| panic!("{lane} ({solver:?}): {e}\n{}", setting.dump()));
        }
        if reader.is_empty() {
            break;
        }
        change_setting(&mut setting, &mut reader);
    }
}

/// Checks that bulk casts by the faces of the difference give the answers of normal casts, along a sequence of
/// changes of poses, direction and graze tolerance. The changes include rotations, for which the faces do not
/// apply.
///
/// # Panics
/// If an answer is wrong, or only one of the queries is rejected.
pub fn bulk(bytes: &[u8]) {
    let mut reader = Reader::new(bytes);
    let Some((mut setting, bodies)) = read_setting(&mut reader) else { return };
    let [moving, fixed] =
        [bodies.moving.at(setting.moving_pose), bodies.fixed.at(setting.fixed_pose)];
    let rotations = FixedRotations::new(moving, fixed);
    let Ok(approach) = rotations.for_direction(setting.direction) else { return };
    for _ in 0..MOST_STEPS {
        if let Ok(cast) = setting.query(&bodies) {
            let findings = still::ask(&rotations, &approach, &cast, &setting, true)
                .unwrap_or_else(|e| panic!("{e}\n{}", setting.dump()));
            for (who, _, verdict) in findings {
                verdict.unwrap_or_else(|e| panic!("{who}: {e}\n{}", setting.dump()));
            }
        }
        if reader.is_empty() {
            break;
        }
        change_setting(&mut setting, &mut reader);
    }
}

/// Checks that a clearance between solids is proven. If the facets are few and not shrunk, the proof is checked
/// in rational arithmetic, and the distance is compared with the rule over all pairs of facets.
///
/// # Panics
/// If an answer is wrong.
pub fn solids(bytes: &[u8]) {
    let mut reader = Reader::new(bytes);
    let turned = reader.byte();
    let (Some(a), Some(b)) = (read_solid(&mut reader), read_solid(&mut reader)) else { return };
    let mut pose = |is_turned: bool| {
        let rotation = if is_turned { reader.rotation() } else { DQuat::IDENTITY };
        Pose::new(rotation, reader.vector()).ok()
    };
    let (Some(s), Some(t)) = (pose(turned & 1 == 1), pose(turned & 2 == 2)) else { return };
    let direction = reader.vector();
    let tolerance = f64::from(reader.byte() % 32) / 64.0;
    let options = SolidOptions::default().with_tolerance(tolerance);
    let cast = Cast::new(a.at(s), b.at(t), direction).and_then(|c| c.with_options(options));
    let Ok(cast) = cast else { return };
    let (answer, certificate) = cast.certified_clearance().expect("an answer");
    assert_eq!(Ok(answer), cast.clearance(), "with its proof and without");
    cast.verify(&certificate).unwrap_or_else(|e| panic!("{answer:?}: {e}"));
    if let Clearance::Free(SolidFree { separation: Some(plane), .. }) = &answer {
        cast.verify(plane).unwrap_or_else(|e| panic!("{answer:?}: {e}"));
    }
    let few = a.triangles().len() * b.triangles().len() <= MOST_PAIRS;
    if !few || tolerance != 0.0 || matches!(certificate.start, StartProof::Overlapping(_)) {
        return;
    }
    let size = size([a.vertices(), b.vertices()], [&s, &t]);
    // The distance of steep facets is accurate to this fraction of the size.
    let slack = 1e-9 * size / direction.length();
    approve(&cast, &certificate, slack).unwrap_or_else(|e| panic!("{answer:?}: {e}"));
    let placed = |solid: &Solid, pose: &Pose| {
        triangles(solid.vertices(), solid.triangles(), (pose.matrix(), pose.translation()))
    };
    let right = rule(&placed(&a, &s), &placed(&b, &t), direction).stop;
    match (&answer, right) {
        (Clearance::Free(_), None) => {}
        (Clearance::Blocked { contact, .. }, Some(right))
            if (contact.translation.value - right.to_f64()).abs() <= slack
                && encloses(&contact.translation, &right) => {}
        (found, right) => {
            panic!("{found:?}, by the rule {:?}", right.map(|right| right.to_f64()))
        }
    }
}

/// Reads a convex body, a closed mesh or an open one as a solid; `None` if it is invalid.
fn read_solid(reader: &mut Reader) -> Option<Solid> {
    let kind = reader.byte() % 3;
    if kind == 0 {
        let body = ConvexPolyhedron::from_points(&reader.points(MOST_JUDGED)).ok()?;
        return Solid::from_convex(&body).ok();
    }
    let vertices = reader.points(MOST_JUDGED + 6);
    let facets: Vec<Vec<u32>> = (0..reader.byte() % 25)
        .map(|_| (0..reader.byte() % 6).map(|_| u32::from(reader.byte())).collect())
        .collect();
    let built = if kind == 1 { Solid::from_mesh } else { Solid::from_open_mesh };
    built(&vertices, &facets).ok()
}

/// Reads two bodies, their poses and a direction. The first byte selects the rotated bodies.
fn read_setting(reader: &mut Reader) -> Option<(Setting, Bodies)> {
    let turned = reader.byte();
    let (moving, fixed) = (reader.points(MOST_JUDGED), reader.points(MOST_JUDGED));
    let mut pose = |is_turned: bool| {
        let rotation = if is_turned { reader.rotation() } else { DQuat::IDENTITY };
        Pose::new(rotation, reader.vector()).ok()
    };
    let (moving_pose, fixed_pose) = (pose(turned & 1 == 1)?, pose(turned & 2 == 2)?);
    let direction = reader.vector();
    let setting = Setting {
        family: "fuzz",
        seed: 0,
        moving,
        fixed,
        moving_pose,
        fixed_pose,
        direction,
        graze_tolerance: 0.0,
    };
    let bodies = setting.bodies().ok()?;
    Some((setting, bodies))
}

/// Changes a setting. A pose that is out of range remains unchanged.
fn change_setting(setting: &mut Setting, reader: &mut Reader) {
    match reader.byte() % 8 {
        0 => setting.direction = reader.vector(),
        1 => setting.direction = -setting.direction,
        2 => setting.direction += reader.vector() * 2.0_f64.powi(-20),
        3 => {
            let rotation = reader.rotation();
            replace_valid_pose(&mut setting.moving_pose, Pose::new(rotation, reader.vector()));
        }
        4 => {
            let rotation = reader.rotation();
            replace_valid_pose(&mut setting.fixed_pose, Pose::new(rotation, reader.vector()));
        }
        5 => {
            let moved = setting.moving_pose.translated_by(reader.vector());
            replace_valid_pose(&mut setting.moving_pose, moved);
        }
        6 => {
            let moved = setting.moving_pose.translated_by(reader.vector() * 2.0_f64.powi(-10));
            replace_valid_pose(&mut setting.moving_pose, moved);
        }
        _ => setting.graze_tolerance = f64::from(reader.byte()) / 16.0,
    }
}

/// Replaces a pose if the result is valid.
fn replace_valid_pose(pose: &mut Pose, by: Result<Pose, PoseError>) {
    *pose = by.unwrap_or(*pose);
}

/// Checks that the surface is a sphere: Euler's formula, and two faces at every edge.
fn check_surface(body: &ConvexPolyhedron) {
    let (vertices, edges, faces) = (body.vertices().len(), body.edge_count(), body.face_count());
    match body.dimension() {
        0 => assert_eq!((vertices, edges, faces), (1, 0, 0)),
        1 => assert_eq!((vertices, edges, faces), (2, 1, 0)),
        _ => assert_eq!(vertices + faces, edges + 2, "Euler's formula"),
    }
    let sides: usize = (0..faces as u32).map(|f| body.face_vertices(f).len()).sum();
    assert_eq!(sides, if faces == 0 { 0 } else { 2 * edges }, "an edge has two faces");
    let degrees: usize = (0..vertices as u32).map(|v| body.neighbours(v).len()).sum();
    assert_eq!(degrees, 2 * edges, "an edge has two ends");
}
