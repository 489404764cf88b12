//! What proves answers about paths: planes between the bodies of each pair, and that two meet.

use super::super::proof::{Met, PlaneAt};
use super::mechanism::Place;

/// What proves an answer: planes between the bodies of each pair, and that two meet.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct PathProof {
    /// For each pair, in the order in which they are asked about.
    pub covers: Vec<Cover>,
    /// That two bodies meet.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "colltrans_kernel::written::given"))]
    pub meeting: Option<PathMeeting>,
    /// Numbers of the convex bodies that the proof takes as solids: those of a pair whose search as convex bodies took its
    /// maximum number of steps.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Vec::is_empty"))]
    pub solids: Vec<usize>,
}

/// What proves that two pieces do not meet up to some place: steps, each from where the last one ends.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Cover {
    /// One after the other.
    pub steps: Vec<Step>,
}

/// A step of a cover.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum Step {
    /// Planes between both pieces: within a row each is joined to the next; the last one of a stretch and the first one
    /// of the next prove all between them by their gaps.
    Planes(Vec<Stretch>),
    /// Each part of one piece for itself.
    Parts {
        /// Which piece is taken apart, the first (0) or the second one (1).
        which: usize,
        /// Up to where, at most.
        until: Place,
        /// For each of its parts.
        covers: Vec<Cover>,
    },
}

/// Planes on the way from a row to the next one. Their times are shares of that way; normals are in the frame that
/// both bodies share.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Stretch {
    /// The row.
    pub row: usize,
    /// In the order of their times.
    pub planes: Vec<PlaneAt>,
}

/// That two bodies meet.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct PathMeeting {
    /// The number of the pair among those that are asked about.
    pub pair: usize,
    /// Where on the path.
    pub place: Place,
    /// Why.
    pub how: How,
}

/// Why two bodies meet.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum How {
    /// Pieces of them do.
    Pieces {
        /// Their numbers.
        pieces: [usize; 2],
        /// What proves it.
        met: Met,
    },
    /// A point is inside both solids, near these facets of theirs: of such as meet face to face.
    Point {
        /// The numbers of the facets, as pieces.
        pieces: [usize; 2],
        /// Where, in the frame of the second one.
        point: [f64; 3],
    },
    /// One is inside the other one, or a part of it is: only where the path begins.
    Inside,
}

impl PathProof {
    /// How many planes it has.
    pub fn planes(&self) -> usize {
        self.covers.iter().map(Cover::planes).sum()
    }

    /// Whether it proves of all pairs, if it holds, that the bodies do not meet where the path begins.
    #[cfg(feature = "json")]
    #[doc(hidden)]
    pub fn is_of_the_beginning(&self) -> bool {
        self.covers.iter().all(Cover::is_of_the_beginning)
    }
}

impl Cover {
    /// Whether it proves, if it holds, that two pieces do not meet where it begins.
    pub(super) fn is_of_the_beginning(&self) -> bool {
        self.steps.iter().any(|step| match step {
            Step::Planes(stretches) => !stretches.is_empty(),
            Step::Parts { covers, .. } => covers.iter().all(Self::is_of_the_beginning),
        })
    }

    fn planes(&self) -> usize {
        let of = |step: &Step| match step {
            Step::Planes(stretches) => stretches.iter().map(|stretch| stretch.planes.len()).sum(),
            Step::Parts { covers, .. } => covers.iter().map(Self::planes).sum::<usize>(),
        };
        self.steps.iter().map(of).sum()
    }
}
