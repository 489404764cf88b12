//! Proofs about the first contact of bodies in motion: separating planes, and the proof of a contact. `solid` has the
//! proofs about solids.

mod plane;
mod solid;

pub use self::plane::TimedPlane;
pub(super) use self::solid::{Entry, PlaneName, RecordedProof, interval_middle};
pub use self::solid::{FacetContact, FacetContactProof, MotionCover, SolidMotionProof, SpanProof};
use colltrans_convex::answer::{Depth, NearPoints};

/// Proof of an answer: separating planes, and a contact if the bodies meet.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct MotionProof {
    /// For each span in which both bodies rotate at a constant rate, up to the one with the contact: planes in the
    /// order of time, each joined to the next one. A list is empty if the bodies meet, or cannot be separated, at the
    /// start of its span.
    pub spans: Vec<Vec<TimedPlane>>,
    /// Proof that the bodies meet at a time.
    #[cfg_attr(
        feature = "serde",
        serde(deserialize_with = "colltrans_kernel::serialization::required_option")
    )]
    pub meeting: Option<ProvenContact>,
    /// Proof of the same query for the bodies as solids, in place of planes. `None` unless the search between convex
    /// bodies took its maximum number of steps.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub solids: Option<Box<SolidMotionProof>>,
}

/// Proof that the bodies are too near at a time.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum ContactProof {
    /// The bodies overlap by more than the tolerated depth.
    Deep(Box<Depth>),
    /// Two points are not farther apart than the minimum gap.
    Near(NearPoints),
}

/// Proof that the bodies meet at a time, or that their distance is at most the minimum gap.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct ProvenContact {
    /// Time of the contact.
    pub time: f64,
    /// Proof for this time.
    pub met: ContactProof,
}

impl MotionProof {
    /// Returns the number of planes; for solids, the number of entries of the cover.
    pub fn plane_count(&self) -> usize {
        let entries = |solids: &SolidMotionProof| -> usize {
            solids.spans.iter().map(|span| span.cover.len()).sum()
        };
        let planes: usize = self.spans.iter().map(Vec::len).sum();
        planes + self.solids.as_deref().map_or(0, entries)
    }

    /// Returns the time of the last plane; 0 if there are none.
    pub(super) fn reached(&self) -> f64 {
        self.spans.iter().flatten().last().map_or(0.0, |plane| plane.time)
    }
}
