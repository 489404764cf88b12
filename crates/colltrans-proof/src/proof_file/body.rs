//! Bodies as a file has them, exact in bits.
//!
//! A certificate between solids tells facets by their places in a tree, so it is made for the bodies as they are read
//! back from the file.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::error::ProofFileError;
use colltrans_convex::body::ConvexPolyhedron;
use colltrans_convex::cast::replay::BodyRecord;
use colltrans_solid::body::{AsSolid, Solid, SolidError};
use colltrans_solid::kinds::{AnyBody, AnyPlaced, ByKind};

/// A body, made of what is written of it.
#[derive(Debug, Clone)]
pub(super) struct StoredBody {
    pub(super) body: AnyBody,
    /// Of a solid.
    pieces: Vec<PieceRecord>,
}

/// A body in a file.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum BodyFile {
    Convex(BodyRecord),
    Pieces(Vec<PieceRecord>),
}

impl StoredBody {
    /// A convex body.
    pub(super) fn convex(body: &ConvexPolyhedron) -> Self {
        Self { body: AnyBody::from(body.clone()), pieces: Vec::new() }
    }

    /// A solid that is the union of pieces, as it is read back from a file.
    pub(super) fn union(
        pieces: &[&Solid],
        asked: &Solid,
        body: usize,
    ) -> Result<Self, ProofFileError> {
        let pieces = pieces.iter().map(|piece| PieceRecord::of(piece)).collect();
        let made = Self::solid(pieces, body)?;
        if made.is_same(asked) { Ok(made) } else { Err(ProofFileError::Changed { body }) }
    }

    /// A body as it is read back from a file.
    pub(super) fn again(placed: AnyPlaced<'_>, body: usize) -> Result<Self, ProofFileError> {
        let solid = match placed {
            ByKind::Convex(placed) => return Ok(Self::convex(placed.body)),
            ByKind::Solid(placed) => placed.body,
        };
        // Of a union whatever hangs together is a piece of its own.
        let ways = [|of: &Solid| vec![PieceRecord::of(of)], PieceRecord::parts];
        let mut made = ways.iter().filter_map(|pieces| Self::solid(pieces(solid), body).ok());
        made.find(|made| made.is_same(solid)).ok_or(ProofFileError::Changed { body })
    }

    fn solid(pieces: Vec<PieceRecord>, body: usize) -> Result<Self, ProofFileError> {
        Ok(Self { body: AnyBody::from(union(&pieces, body)?), pieces })
    }

    pub(super) fn read(file: BodyFile, body: usize) -> Result<Self, ProofFileError> {
        match file {
            BodyFile::Convex(record) => {
                let made = record.body();
                let made =
                    made.map_err(|error| ProofFileError::Body { body, error: error.into() })?;
                Ok(Self { body: AnyBody::from(made), pieces: Vec::new() })
            }
            BodyFile::Pieces(pieces) => Self::solid(pieces, body),
        }
    }

    /// Returns the body of a file with a number.
    pub(super) fn of(bodies: &[Self], body: usize) -> Result<&Self, ProofFileError> {
        bodies.get(body).ok_or(ProofFileError::NoBody { body, known: bodies.len() })
    }

    pub(super) fn file(&self) -> BodyFile {
        match &self.body {
            ByKind::Convex(body) => BodyFile::Convex(BodyRecord::of(body)),
            ByKind::Solid(_) => BodyFile::Pieces(self.pieces.clone()),
        }
    }

    /// Returns the solid that it is, if it is one.
    pub(super) fn as_solid(&self) -> Option<&Arc<Solid>> {
        match &self.body {
            ByKind::Convex(_) => None,
            ByKind::Solid(solid) => Some(solid),
        }
    }

    /// Checks whether it has the same facets as a solid, in whatever order.
    fn is_same(&self, other: &Solid) -> bool {
        self.as_solid().is_some_and(|solid| is_same(solid, other))
    }
}

/// A mesh that a solid is made of.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PieceRecord {
    vertices: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    open: bool,
}

impl PieceRecord {
    fn of(solid: &Solid) -> Self {
        Self {
            vertices: solid.vertices().iter().map(DVec3::to_array).collect(),
            triangles: solid.triangles().to_vec(),
            open: !solid.is_closed(),
        }
    }

    /// The parts of a solid that have no vertex in common, each by itself.
    fn parts(solid: &Solid) -> Vec<Self> {
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

/// Returns the solid that pieces make.
fn union(pieces: &[PieceRecord], body: usize) -> Result<Solid, ProofFileError> {
    let refused = |error: SolidError| ProofFileError::Body { body, error: error.into() };
    let made = |piece: &PieceRecord| {
        // Statements may count vertices: none is left out of a piece.
        let mut is_used = vec![false; piece.vertices.len()];
        for v in piece.triangles.iter().flatten() {
            if let Some(used) = is_used.get_mut(*v as usize) {
                *used = true;
            }
        }
        let solid = piece.solid().map_err(refused)?;
        if is_used.contains(&false) { Err(ProofFileError::Changed { body }) } else { Ok(solid) }
    };
    let mut solids: Vec<Solid> = pieces.iter().map(made).collect::<Result<_, _>>()?;
    if solids.len() == 1 {
        return Ok(solids.remove(0));
    }
    Solid::from_pieces(&solids).map_err(refused)
}

/// Whether two solids have the same facets, in whatever order.
fn is_same(a: &Solid, b: &Solid) -> bool {
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
