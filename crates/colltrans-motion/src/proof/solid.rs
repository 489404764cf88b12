//! Proofs about solids in motion, and their entries as a search records them.
//!
//! A [`MotionCover`] lists in preorder how each pair of parts is treated in its interval, starting with both bodies in
//! the whole span. The time or one of the parts is split, or the parts are separated throughout, by a named plane or by
//! a list of planes. The complete list covers all pairs of facets at all times.

use super::plane::TimedPlane;
use colltrans_solid::cast::StartProof;

/// Proof of an answer about solids in motion.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct SolidMotionProof {
    /// Tolerance, in world units. Both solids are shrunk by half of it.
    pub tolerance: f64,
    /// Proof whether the solids overlap at the start of the motion.
    pub start: StartProof,
    /// A proof for each span in which both bodies rotate at a constant rate, up to the one with the contact.
    pub spans: Vec<SpanProof>,
    /// Proof that the solids meet at a time.
    #[cfg_attr(
        feature = "serde",
        serde(deserialize_with = "colltrans_kernel::serialization::required_option")
    )]
    pub meeting: Option<FacetContact>,
}

/// Proof that no facets meet from the start of a span up to a time.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct SpanProof {
    /// End of the proven interval.
    pub until: f64,
    /// Entries for all pairs of facets at all times.
    pub cover: MotionCover,
    /// Planes for each entry that has a list, each joined to the next one.
    pub lists: Vec<Vec<TimedPlane>>,
}

/// Proof that two facets meet at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct FacetContact {
    /// Time of the contact.
    pub time: f64,
    /// Indices of the facets in [`Solid::triangles`](colltrans_solid::Solid::triangles).
    pub triangles: [u32; 2],
    /// Proof for this time.
    pub met: FacetContactProof,
}

/// Proof that two facets, or their solids, meet.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum FacetContactProof {
    /// An edge of one facet passes through the other one, by more than the error of computed places.
    Crossing {
        /// Whether the edge belongs to the facet of the moving body.
        moving: bool,
        /// Index of the edge, from this corner to the next one: 0, 1 or 2.
        edge: u8,
    },
    /// Two points are not farther apart than the minimum gap.
    Near {
        /// Weights of the corners of both facets.
        weights: [[f64; 3]; 2],
    },
    /// A point is inside both solids.
    Inside {
        /// The point, in the frame of the fixed body.
        point: [f64; 3],
    },
    /// A point of a facet of one body is inside the other body.
    Contained {
        /// Whether the facet belongs to the moving body.
        moving: bool,
        /// Weights of the corners of the facet.
        weights: [f64; 3],
    },
}

/// The treatment of each pair of parts in its interval, in preorder. As text it has one letter for each entry:
///
/// | letter | entry |
/// |---|---|
/// | `T` | the interval is halved |
/// | `P`, `Q` | the moving or the fixed part is split |
/// | `m` | separated by the plane perpendicular to the line between the middles |
/// | `a b c`, `x y z` | separated along an axis of the moving or the fixed body |
/// | `p`, `q` | separated by the plane of the moving or the fixed facet |
/// | `1` to `9` | separated by the plane parallel to an edge of each facet |
/// | `L` | separated by a list of planes |
#[derive(Debug, Clone, PartialEq, Eq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(into = "String", try_from = "String")
)]
pub struct MotionCover(pub(crate) Vec<Entry>);

impl MotionCover {
    /// Returns the number of entries, splits included.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Checks whether there are no entries.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// The treatment of a pair of parts in an interval.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Entry {
    /// The interval is halved.
    Halved,
    /// The moving (0) or the fixed (1) part is split in two.
    Split(u8),
    /// One plane separates the parts throughout.
    Separated(PlaneName),
    /// A list of planes separates all facets of the parts.
    PlaneList,
}

/// Name of a direction that two parts determine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PlaneName {
    /// From the middle of the moving part to that of the fixed part.
    Middles,
    /// An axis (second index) of the frame of the moving (0) or the fixed (1) body.
    Axis(u8, u8),
    /// The normal of the moving (0) or the fixed (1) facet.
    FacetNormal(u8),
    /// Perpendicular to an edge of each facet, the moving one first.
    Edges(u8, u8),
}

/// A recorded proof: entries in preorder, and the lists of planes that they refer to.
#[derive(Debug, Clone, Default)]
pub(crate) struct RecordedProof {
    pub(crate) entries: Vec<Entry>,
    pub(crate) lists: Vec<Vec<TimedPlane>>,
}

impl RecordedProof {
    /// Checks whether one list of planes for both bodies proves all times up to `until`.
    pub(crate) fn is_list_until(&self, until: f64) -> bool {
        let reached = |planes: &Vec<TimedPlane>| planes.last().map(|plane| plane.time);
        self.entries == [Entry::PlaneList] && self.lists.first().and_then(reached) == Some(until)
    }
}

impl SpanProof {
    /// Builds the proof of a span from the recorded entries.
    pub(crate) fn new(until: f64, RecordedProof { entries, lists }: RecordedProof) -> Self {
        Self { until, cover: MotionCover(entries), lists }
    }
}

/// The letter of each entry.
const LETTERS: [(char, Entry); 22] = {
    use Entry::{Halved, PlaneList, Separated, Split};
    use PlaneName::{Axis, Edges, FacetNormal, Middles};
    [
        ('T', Halved),
        ('P', Split(0)),
        ('Q', Split(1)),
        ('L', PlaneList),
        ('m', Separated(Middles)),
        ('a', Separated(Axis(0, 0))),
        ('b', Separated(Axis(0, 1))),
        ('c', Separated(Axis(0, 2))),
        ('x', Separated(Axis(1, 0))),
        ('y', Separated(Axis(1, 1))),
        ('z', Separated(Axis(1, 2))),
        ('p', Separated(FacetNormal(0))),
        ('q', Separated(FacetNormal(1))),
        ('1', Separated(Edges(0, 0))),
        ('2', Separated(Edges(0, 1))),
        ('3', Separated(Edges(0, 2))),
        ('4', Separated(Edges(1, 0))),
        ('5', Separated(Edges(1, 1))),
        ('6', Separated(Edges(1, 2))),
        ('7', Separated(Edges(2, 0))),
        ('8', Separated(Edges(2, 1))),
        ('9', Separated(Edges(2, 2))),
    ]
};

impl From<MotionCover> for String {
    fn from(cover: MotionCover) -> Self {
        let letter = |entry: &Entry| {
            LETTERS.iter().find(|(_, known)| known == entry).map_or('?', |(letter, _)| *letter)
        };
        cover.0.iter().map(letter).collect()
    }
}

impl TryFrom<String> for MotionCover {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let entry = |letter: char| {
            let known = LETTERS.iter().find(|(known, _)| *known == letter);
            known
                .map(|(_, entry)| *entry)
                .ok_or_else(|| format!("{letter:?} is not a letter of a cover"))
        };
        text.chars().map(entry).collect::<Result<_, _>>().map(Self)
    }
}

/// Returns the time at which an interval is halved.
pub(crate) fn interval_middle(from: f64, to: f64) -> f64 {
    from + 0.5 * (to - from)
}
