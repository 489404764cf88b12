//! Bodies of a file, exact in bits.
//!
//! A certificate between solids identifies facets by their positions in a tree. Therefore it is computed for
//! bodies that are rebuilt from the file.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::error::ProofFileError;
use colltrans_convex::body::ConvexPolyhedron;
use colltrans_convex::cast::case_file::BodyRecord;
use colltrans_solid::body::{AsSolid, Solid, SolidError};
use colltrans_solid::kinds::{AnyBody, AnyPlaced, ByKind};

/// Body together with its form in a file.
#[derive(Debug, Clone)]
pub(super) struct StoredBody {
    pub(super) body: AnyBody,
    /// Pieces of a solid; empty for a convex body.
    pieces: Vec<PieceRecord>,
}

/// Body in a file.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum BodyFile {
    Convex(BodyRecord),
    Pieces(Vec<PieceRecord>),
    Rounded(RoundedRecord),
}

/// A rounded solid in a file: the union of pieces, swept by a ball.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RoundedRecord {
    pieces: Vec<PieceRecord>,
    radius: f64,
}

impl StoredBody {
    /// Stores a convex body.
    pub(super) fn from_convex(body: &ConvexPolyhedron) -> Self {
        Self { body: AnyBody::from(body.clone()), pieces: Vec::new() }
    }

    /// Stores a solid that is the union of pieces, as if read from a file, with the radius of `expected`. Returns an
    /// error if the result has other facets than `expected`.
    pub(super) fn from_pieces(
        pieces: &[&Solid],
        expected: &Solid,
        body: usize,
    ) -> Result<Self, ProofFileError> {
        let pieces = pieces.iter().map(|piece| PieceRecord::of_solid(piece)).collect();
        let made = Self::from_piece_records(pieces, expected.radius(), body)?;
        if made.has_same_facets(expected) {
            Ok(made)
        } else {
            Err(ProofFileError::Changed { body })
        }
    }

    /// Stores a placed body, as if read from a file.
    pub(super) fn rebuild(placed: AnyPlaced<'_>, body: usize) -> Result<Self, ProofFileError> {
        let solid = match placed {
            ByKind::Convex(placed) => return Ok(Self::from_convex(placed.body)),
            ByKind::Solid(placed) => placed.body,
        };
        // For a union, each connected component is a piece of its own.
        let ways = [|of: &Solid| vec![PieceRecord::of_solid(of)], PieceRecord::components];
        let mut made = ways.iter().filter_map(|pieces| {
            Self::from_piece_records(pieces(solid), solid.radius(), body).ok()
        });
        made.find(|made| made.has_same_facets(solid)).ok_or(ProofFileError::Changed { body })
    }

    fn from_piece_records(
        pieces: Vec<PieceRecord>,
        radius: f64,
        body: usize,
    ) -> Result<Self, ProofFileError> {
        let rounded = union_of_pieces(&pieces, body)?.rounded(radius);
        let made = rounded.map_err(|error| ProofFileError::Body { body, error: error.into() })?;
        Ok(Self { body: AnyBody::from(made), pieces })
    }

    pub(super) fn from_file(file: BodyFile, body: usize) -> Result<Self, ProofFileError> {
        match file {
            BodyFile::Convex(record) => {
                let made = record.to_body();
                let made =
                    made.map_err(|error| ProofFileError::Body { body, error: error.into() })?;
                Ok(Self { body: AnyBody::from(made), pieces: Vec::new() })
            }
            BodyFile::Pieces(pieces) => Self::from_piece_records(pieces, 0.0, body),
            BodyFile::Rounded(RoundedRecord { pieces, radius }) => {
                Self::from_piece_records(pieces, radius, body)
            }
        }
    }

    /// Returns the body with an index.
    pub(super) fn at_index(bodies: &[Self], body: usize) -> Result<&Self, ProofFileError> {
        bodies.get(body).ok_or(ProofFileError::NoBody { body, known: bodies.len() })
    }

    pub(super) fn to_file(&self) -> BodyFile {
        match &self.body {
            ByKind::Convex(body) => BodyFile::Convex(BodyRecord::from_body(body)),
            ByKind::Solid(solid) if solid.radius() != 0.0 => {
                let (pieces, radius) = (self.pieces.clone(), solid.radius());
                BodyFile::Rounded(RoundedRecord { pieces, radius })
            }
            ByKind::Solid(_) => BodyFile::Pieces(self.pieces.clone()),
        }
    }

    /// Returns the solid, and `None` for a convex body.
    pub(super) fn as_solid(&self) -> Option<&Arc<Solid>> {
        match &self.body {
            ByKind::Convex(_) => None,
            ByKind::Solid(solid) => Some(solid),
        }
    }

    /// Checks whether the body has the same radius as a solid, and the same facets in any order.
    fn has_same_facets(&self, other: &Solid) -> bool {
        self.as_solid().is_some_and(|solid| have_same_facets(solid, other))
    }
}

/// Mesh of one piece of a solid.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PieceRecord {
    vertices: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    open: bool,
}

impl PieceRecord {
    fn of_solid(solid: &Solid) -> Self {
        Self {
            vertices: solid.vertices().iter().map(DVec3::to_array).collect(),
            triangles: solid.triangles().to_vec(),
            open: !solid.is_closed(),
        }
    }

    /// Splits a solid into components that have no vertex in common.
    fn components(solid: &Solid) -> Vec<Self> {
        // Union-find: each vertex refers to a smaller one of its component, the smallest one to itself.
        let mut lower: Vec<u32> = (0..solid.vertices().len() as u32).collect();
        for triangle in solid.triangles() {
            let roots = triangle.map(|v| component_root(&lower, v));
            let least = roots.into_iter().min().unwrap_or_default();
            roots.into_iter().chain(*triangle).for_each(|v| lower[v as usize] = least);
        }
        let mut parts: BTreeMap<u32, Vec<[u32; 3]>> = BTreeMap::new();
        for triangle in solid.triangles() {
            parts.entry(component_root(&lower, triangle[0])).or_default().push(*triangle);
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

    fn to_solid(&self) -> Result<Solid, SolidError> {
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

/// Returns the smallest vertex that is reached from a vertex.
fn component_root(lower: &[u32], mut v: u32) -> u32 {
    while lower[v as usize] != v {
        v = lower[v as usize];
    }
    v
}

/// Builds the union of pieces.
fn union_of_pieces(pieces: &[PieceRecord], body: usize) -> Result<Solid, ProofFileError> {
    let refused = |error: SolidError| ProofFileError::Body { body, error: error.into() };
    let made = |piece: &PieceRecord| {
        // Statements may count vertices. Therefore a piece must not have unused ones.
        let mut is_used = vec![false; piece.vertices.len()];
        for v in piece.triangles.iter().flatten() {
            if let Some(used) = is_used.get_mut(*v as usize) {
                *used = true;
            }
        }
        let solid = piece.to_solid().map_err(refused)?;
        if is_used.contains(&false) { Err(ProofFileError::Changed { body }) } else { Ok(solid) }
    };
    let mut solids: Vec<Solid> = pieces.iter().map(made).collect::<Result<_, _>>()?;
    if solids.len() == 1 {
        return Ok(solids.remove(0));
    }
    Solid::from_pieces(&solids).map_err(refused)
}

/// Checks whether two solids have the same radius, and the same facets in any order.
fn have_same_facets(a: &Solid, b: &Solid) -> bool {
    let facets = |solid: &Solid| {
        // Replace -0 by 0.
        let corner = |v: u32| (solid.vertices()[v as usize] + 0.0).to_array().map(f64::to_bits);
        let rotated = |t: &[u32; 3]| {
            let [a, b, c] = t.map(corner);
            [[a, b, c], [b, c, a], [c, a, b]].into_iter().min()
        };
        let mut all: Vec<_> = solid.triangles().iter().map(rotated).collect();
        all.sort_unstable();
        all
    };
    a.is_closed() == b.is_closed() && a.radius() == b.radius() && facets(a) == facets(b)
}
