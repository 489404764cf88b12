//! Proofs about paths of joints: planes between the bodies of each pair, and the proof of a contact.

use super::super::proof::{ContactProof, TimedPlane};
use super::mechanism::PathPlace;

/// Proof of an answer: planes between the bodies of each pair, and a contact if two bodies meet.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct PathProof {
    /// One cover for each pair, in the order of the query.
    pub covers: Vec<PathCover>,
    /// Proof that two bodies meet.
    #[cfg_attr(
        feature = "serde",
        serde(deserialize_with = "colltrans_kernel::serialization::required_option")
    )]
    pub meeting: Option<PathProvenContact>,
    /// Numbers of the convex bodies that the proof converts to solids: those of a pair whose search as convex bodies
    /// took its maximum number of steps.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Vec::is_empty"))]
    pub solids: Vec<usize>,
}

/// Proof that two pieces do not meet up to a place: steps, each from the end of the previous one.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct PathCover {
    /// The steps in order.
    pub steps: Vec<CoverStep>,
}

/// A step of a cover.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum CoverStep {
    /// Planes between both pieces. Within a stretch, each plane is joined to the next one. The last plane of a stretch
    /// and the first plane of the next one prove all times between them by their gaps.
    Planes(Vec<PlaneStretch>),
    /// A cover for each part of one piece.
    Parts {
        /// The piece that is split: the first (0) or the second (1).
        which: usize,
        /// Maximum end of the covers.
        until: PathPlace,
        /// One cover for each part.
        covers: Vec<PathCover>,
    },
}

/// Planes between two consecutive rows. Their times are shares of the interval, and their normals are in the frame that
/// contains both bodies.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct PlaneStretch {
    /// Index of the row.
    pub row: usize,
    /// Planes in the order of time.
    pub planes: Vec<TimedPlane>,
}

/// Proof that two bodies meet.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct PathProvenContact {
    /// Index of the pair in the query.
    pub pair: usize,
    /// Place of the contact on the path.
    pub place: PathPlace,
    /// Proof for this place.
    pub how: PathContactProof,
}

/// Proof that two bodies meet at a place.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum PathContactProof {
    /// Two pieces of the bodies meet.
    Pieces {
        /// Numbers of the pieces.
        pieces: [usize; 2],
        /// Proof that the pieces meet.
        met: ContactProof,
    },
    /// A point is inside both solids. It was guessed from two facets that have passed each other, or that lie in one
    /// plane and face the same way.
    Point {
        /// Numbers of the pieces of two facets near the point.
        pieces: [usize; 2],
        /// The point, in the frame of the second body.
        point: [f64; 3],
    },
    /// One body contains the other one, or a part of it. Only valid at the start of the path.
    Inside,
}

impl PathProof {
    /// Returns the number of planes.
    pub fn plane_count(&self) -> usize {
        self.covers.iter().map(PathCover::plane_count).sum()
    }

    /// Checks whether the proof, if it holds, shows for all pairs that the bodies do not meet at the start of the path.
    #[cfg(feature = "json")]
    #[doc(hidden)]
    pub fn proves_start(&self) -> bool {
        self.covers.iter().all(PathCover::proves_start)
    }
}

impl PathCover {
    /// Checks whether the cover, if it holds, shows that the pieces do not meet at its start.
    pub(super) fn proves_start(&self) -> bool {
        self.steps.iter().any(|step| match step {
            CoverStep::Planes(stretches) => !stretches.is_empty(),
            CoverStep::Parts { covers, .. } => covers.iter().all(Self::proves_start),
        })
    }

    /// Returns the number of planes in the cover.
    fn plane_count(&self) -> usize {
        let of = |step: &CoverStep| match step {
            CoverStep::Planes(stretches) => {
                stretches.iter().map(|stretch| stretch.planes.len()).sum()
            }
            CoverStep::Parts { covers, .. } => covers.iter().map(Self::plane_count).sum::<usize>(),
        };
        self.steps.iter().map(of).sum()
    }
}
