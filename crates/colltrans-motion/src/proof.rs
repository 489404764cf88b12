//! What proves when bodies that turn first meet: planes between them, and that they meet.

use glam::DVec3;

use super::solid::SolidMotionProof;
use colltrans_convex::answer::{Depth, NearPoints};

/// What proves an answer: planes, and that the bodies meet.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct MotionProof {
    /// For each span of time in which both bodies spin evenly, up to that in which they meet: planes in the
    /// order of their times, each joined to the next one. None, if they meet when it begins.
    pub spans: Vec<Vec<PlaneAt>>,
    /// That the bodies meet at a time.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "colltrans_kernel::written::given"))]
    pub meeting: Option<Meeting>,
    /// Proof of the same question about the bodies as solids, in the place of planes. `None` unless the search between
    /// convex bodies took its maximum number of steps.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub solids: Option<Box<SolidMotionProof>>,
}

/// A plane between the bodies at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct PlaneAt {
    /// When.
    pub time: f64,
    /// Unit normal in the world, from the moving body to the fixed one.
    pub normal: DVec3,
    /// At most the gap that it leaves, less the gap to be kept, in world units.
    pub gap: f64,
    /// Whether this plane alone proves all times up to the next one, by the arcs of all vertices; else both
    /// together do.
    pub alone: bool,
}

/// What proves that the bodies are too near at a time.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Met {
    /// They overlap, deeper than is tolerated.
    Deep(Box<Depth>),
    /// Two points are no farther apart than what is to be kept.
    Near(NearPoints),
}

/// That the bodies meet at a time, or are not farther apart than the gap to be kept.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Meeting {
    /// When.
    pub time: f64,
    /// Why.
    pub met: Met,
}

impl MotionProof {
    /// How many planes it has; of solids, entries of the cover.
    pub fn planes(&self) -> usize {
        let entries = |solids: &SolidMotionProof| -> usize {
            solids.spans.iter().map(|span| span.cover.len()).sum()
        };
        let planes: usize = self.spans.iter().map(Vec::len).sum();
        planes + self.solids.as_deref().map_or(0, entries)
    }

    /// Up to which time its planes reach; 0 if there are none.
    pub(super) fn reached(&self) -> f64 {
        self.spans.iter().flatten().last().map_or(0.0, |plane| plane.time)
    }
}
