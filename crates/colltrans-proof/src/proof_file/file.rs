//! The file: what it holds, written and read.

use std::collections::BTreeMap;

use glam::DVec3;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::statement::{Contacts, DistanceStatement, FreeStatement, SolidStatement, Statement};
use super::{Along, Bodies, ProofFile};
use colltrans_convex::answer::{Depth, Separation};
use colltrans_convex::body::ConvexPolyhedron;
use colltrans_convex::cast::CaseError;
use colltrans_convex::cast::replay::BodyRecord;
use colltrans_convex::setting::{check_direction, check_keep};
use colltrans_kernel::pose::PoseRecord;
use colltrans_solid::body::{AsSolid, Solid, SolidError};
use colltrans_solid::pair::DistanceCertificate;
use colltrans_solid::solve::nearest::SolidNear;

/// What a file of this version calls itself.
const FORMAT: &str = "colltrans proof 1";

/// What the moving and the fixed body are made of.
pub(super) type Pieces = [Vec<PieceRecord>; 2];

impl ProofFile {
    /// As a file: numbers that read back as the same bits.
    ///
    /// # Panics
    /// Never: all numbers can be written.
    pub fn to_json(&self) -> String {
        let [moving, fixed] = match &self.bodies {
            Bodies::Convex(bodies) => {
                bodies.each_ref().map(|body| BodyFile::Convex(BodyRecord::of(body)))
            }
            Bodies::Solids { of, .. } => of.each_ref().map(|of| BodyFile::Pieces(of.clone())),
        };
        let [moving_pose, fixed_pose] = self.poses.map(PoseRecord::from);
        let file = File {
            format: FORMAT.into(),
            moving,
            moving_pose,
            fixed,
            fixed_pose,
            direction: self.along.map(|along| along.direction.to_array()),
            keep: self.along.map_or(0.0, |along| along.keep),
            statement: self.statement_of_file(),
        };
        serde_json::to_string(&file).expect("numbers and names")
    }

    /// From what [`Self::to_json`] has written. It is read, not believed: see [`Self::check`].
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn from_json(text: &str) -> Result<Self, CaseError> {
        let text = said(text, FORMAT)?;
        let file: File<StatementRecord> = serde_json::from_str(text).map_err(CaseError::Proof)?;
        let bodies = match (file.moving, file.fixed) {
            (BodyFile::Convex(moving), BodyFile::Convex(fixed)) => {
                let moving = convex_body(&moving, "moving")?;
                Bodies::Convex(Box::new([moving, convex_body(&fixed, "fixed")?]))
            }
            (BodyFile::Pieces(moving), BodyFile::Pieces(fixed)) => Bodies::Solids {
                made: Box::new([union(&moving, "moving")?, union(&fixed, "fixed")?]),
                of: [moving, fixed],
            },
            _ => return Err(CaseError::Mixed),
        };
        let mut statement = file.statement.of(matches!(bodies, Bodies::Solids { .. }))?;
        if let (Bodies::Solids { made, .. }, Statement::SolidDistance(of)) =
            (&bodies, &mut statement)
        {
            let place = |k: usize, facet: u32| {
                let facets = made[k].facet_indices();
                facets.iter().position(|known| known.0 == facet).map(|at| at as u32)
            };
            of.near = named(of.near, place).ok_or(CaseError::Statement)?;
        }
        let is_of_pair = statement.is_of_pair();
        if is_of_pair == file.direction.is_some() || is_of_pair && file.keep != 0.0 {
            return Err(CaseError::Statement);
        }
        let poses = [file.moving_pose.try_into()?, file.fixed_pose.try_into()?];
        let direction = file.direction.map(DVec3::from_array);
        direction.map_or(Ok(()), check_direction)?;
        check_keep(file.keep)?;
        let along = direction.map(|direction| Along { direction, keep: file.keep });
        Ok(Self { bodies, poses, along, statement })
    }

    /// Returns the statement with triangles by their numbers in the file.
    fn statement_of_file(&self) -> Statement {
        let mut statement = self.statement.clone();
        if let (Bodies::Solids { made, .. }, Statement::SolidDistance(of)) =
            (&self.bodies, &mut statement)
        {
            let number = |k: usize, at: u32| Some(made[k].facet_indices().get(at as usize)?.0);
            of.near = named(of.near, number).unwrap_or(of.near);
        }
        statement
    }
}

/// Returns the same with other names of triangles; `None` if one has none.
fn named(near: SolidNear, name: impl Fn(usize, u32) -> Option<u32>) -> Option<SolidNear> {
    let SolidNear::Points { triangles: [p, q], weights, distance } = near else {
        return Some(near);
    };
    Some(SolidNear::Points { triangles: [name(0, p)?, name(1, q)?], weights, distance })
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File<S> {
    format: String,
    moving: BodyFile,
    moving_pose: PoseRecord,
    fixed: BodyFile,
    fixed_pose: PoseRecord,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    direction: Option<[f64; 3]>,
    #[serde(default, skip_serializing_if = "colltrans_kernel::written::is_zero")]
    keep: f64,
    statement: S,
}

/// A [`Statement`] as it is read.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StatementRecord {
    contacts: Option<Contacts>,
    separation: Option<Separation>,
    clearance: Option<SolidStatement>,
    distance: Option<DistanceStatement>,
    depth: Option<Depth>,
    solid_distance: Option<DistanceCertificate>,
    free_directions: Option<FreeStatement>,
}

impl StatementRecord {
    /// The one thing that is said of such bodies.
    fn of(self, solids: bool) -> Result<Statement, CaseError> {
        let Self { contacts, separation, clearance, .. } = self;
        let Self { distance, depth, solid_distance, free_directions, .. } = self;
        let contacts =
            contacts.map(|of| (of.first.is_some() || of.last.is_some(), Statement::Contacts(of)));
        let distance =
            distance.map(|of| (of.gap.is_some() || of.near.is_some(), Statement::Distance(of)));
        let said = [
            contacts.map(|(something, of)| (something && !solids, of)),
            distance.map(|(something, of)| (something && !solids, of)),
            separation.map(|of| (!solids, Statement::Separation(of))),
            depth.map(|of| (!solids, Statement::Depth(of))),
            clearance.map(|of| (solids, Statement::Clearance(of))),
            solid_distance.map(|of| (solids, Statement::SolidDistance(of))),
            free_directions.map(|of| (solids, Statement::FreeDirections(of))),
        ];
        let mut said = said.into_iter().flatten();
        match (said.next(), said.next()) {
            (Some((true, statement)), None) => Ok(statement),
            _ => Err(CaseError::Statement),
        }
    }
}

/// A file of this format, as it is read: some editors begin one with a byte-order mark.
pub(crate) fn said<'a>(text: &'a str, known: &'static str) -> Result<&'a str, CaseError> {
    #[derive(Deserialize)]
    struct Named {
        format: String,
    }
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let Named { format: found } = nested(text)?;
    if found == known { Ok(text) } else { Err(CaseError::Format { found, known }) }
}

/// Lists and objects within each other in a file of proof, at most: the cover of two bodies of a million facets takes
/// 250 of them.
const MOST_NESTED: usize = 400;

/// Reads a file whose covers are nested as trees of parts are: deeper than `serde_json` reads by itself.
pub(crate) fn nested<T: DeserializeOwned>(text: &str) -> Result<T, CaseError> {
    if depth_of(text) > MOST_NESTED {
        let reason = format!("lists and objects are nested more than {MOST_NESTED} deep");
        return Err(CaseError::Proof(serde::de::Error::custom(reason)));
    }
    let mut reader = serde_json::Deserializer::from_str(text);
    reader.disable_recursion_limit();
    let read = T::deserialize(&mut reader).map_err(CaseError::Proof)?;
    reader.end().map_err(CaseError::Proof)?;
    Ok(read)
}

/// Returns how deep lists and objects of JSON are nested, at least.
fn depth_of(text: &str) -> usize {
    let (mut depth, mut deepest) = (0_usize, 0);
    let (mut in_text, mut escaped) = (false, false);
    for byte in text.bytes() {
        match byte {
            _ if escaped => escaped = false,
            b'\\' if in_text => escaped = true,
            b'"' => in_text = !in_text,
            b'[' | b'{' if !in_text => {
                depth += 1;
                deepest = deepest.max(depth);
            }
            b']' | b'}' if !in_text => depth = depth.saturating_sub(1),
            _ => {}
        }
    }
    deepest
}

pub(crate) fn convex_body(
    record: &BodyRecord,
    which: &'static str,
) -> Result<ConvexPolyhedron, CaseError> {
    record.body().map_err(|error| CaseError::Body { which, error: error.into() })
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum BodyFile {
    Convex(BodyRecord),
    Pieces(Vec<PieceRecord>),
}

/// A mesh that a solid is made of.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PieceRecord {
    vertices: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    open: bool,
}

impl PieceRecord {
    pub(super) fn of(solid: &Solid) -> Self {
        Self {
            vertices: solid.vertices().iter().map(DVec3::to_array).collect(),
            triangles: solid.triangles().to_vec(),
            open: !solid.is_closed(),
        }
    }

    /// The parts of a solid that have no vertex in common, each by itself.
    pub(super) fn parts(solid: &Solid) -> Vec<Self> {
        // Every vertex leads to a lower one that it hangs together with, the lowest to itself.
        let mut lower: Vec<u32> = (0..solid.vertices().len() as u32).collect();
        for triangle in solid.triangles() {
            let roots = triangle.map(|v| lowest(&lower, v));
            let least = roots.into_iter().min().unwrap_or_default();
            roots.into_iter().chain(*triangle).for_each(|v| lower[v as usize] = least);
        }
        let mut parts: BTreeMap<u32, Vec<[u32; 3]>> = BTreeMap::new();
        for triangle in solid.triangles() {
            parts.entry(lowest(&lower, triangle[0])).or_default().push(*triangle);
        }
        let part = |triangles: Vec<[u32; 3]>| {
            let (mut vertices, mut numbers) = (Vec::new(), BTreeMap::new());
            let mut number = |v: u32| {
                *numbers.entry(v).or_insert_with(|| {
                    vertices.push(solid.vertices()[v as usize].to_array());
                    vertices.len() as u32 - 1
                })
            };
            let triangles = triangles.into_iter().map(|t| t.map(&mut number)).collect();
            Self { vertices, triangles, open: !solid.is_closed() }
        };
        parts.into_values().map(part).collect()
    }

    fn solid(&self) -> Result<Solid, SolidError> {
        let vertices: Vec<DVec3> = self.vertices.iter().copied().map(DVec3::from_array).collect();
        let count = vertices.len();
        if self.open && matches!((count, &self.triangles[..]), (1, [[0, 0, 0]]) | (2, [[0, 1, 1]]))
        {
            // A point or a segment.
            let body = ConvexPolyhedron::from_points(&vertices).map_err(|_| SolidError::Empty)?;
            return body.as_surface().cloned();
        }
        if self.open {
            Solid::from_open_mesh(&vertices, &self.triangles)
        } else {
            Solid::from_mesh(&vertices, &self.triangles)
        }
    }
}

/// The lowest vertex that one leads to.
fn lowest(lower: &[u32], mut v: u32) -> u32 {
    while lower[v as usize] != v {
        v = lower[v as usize];
    }
    v
}

pub(super) fn union(pieces: &[PieceRecord], which: &'static str) -> Result<Solid, CaseError> {
    let refused = |error: SolidError| CaseError::Body { which, error: error.into() };
    let made = |piece: &PieceRecord| {
        // Statements may count vertices: none is left out of a piece.
        let mut is_used = vec![false; piece.vertices.len()];
        for v in piece.triangles.iter().flatten() {
            if let Some(used) = is_used.get_mut(*v as usize) {
                *used = true;
            }
        }
        let solid = piece.solid().map_err(refused)?;
        if is_used.contains(&false) { Err(CaseError::Changed { which }) } else { Ok(solid) }
    };
    let mut solids: Vec<Solid> = pieces.iter().map(made).collect::<Result<_, _>>()?;
    if solids.len() == 1 {
        return Ok(solids.remove(0));
    }
    Solid::from_pieces(&solids).map_err(refused)
}

/// Both bodies made once more of their pieces, as they are read back from a file.
pub(super) fn again(
    pieces: [&[&Solid]; 2],
    asked: [&Solid; 2],
) -> Result<(Box<[Solid; 2]>, Pieces), CaseError> {
    let of: Pieces =
        pieces.map(|pieces| pieces.iter().map(|piece| PieceRecord::of(piece)).collect());
    let made = Box::new([union(&of[0], "moving")?, union(&of[1], "fixed")?]);
    for (k, which) in ["moving", "fixed"].into_iter().enumerate() {
        if !is_same(&made[k], asked[k]) {
            return Err(CaseError::Changed { which });
        }
    }
    Ok((made, of))
}

/// Whether two solids have the same facets, in whatever order.
pub(super) fn is_same(a: &Solid, b: &Solid) -> bool {
    let facets = |solid: &Solid| {
        // Without -0.
        let corner = |v: u32| (solid.vertices()[v as usize] + 0.0).to_array().map(f64::to_bits);
        let turned = |t: &[u32; 3]| {
            let [a, b, c] = t.map(corner);
            [[a, b, c], [b, c, a], [c, a, b]].into_iter().min()
        };
        let mut all: Vec<_> = solid.triangles().iter().map(turned).collect();
        all.sort_unstable();
        all
    };
    a.is_closed() == b.is_closed() && facets(a) == facets(b)
}
