//! What a proof about solids that turn is, and its entries, as a search writes them down.
//!
//! A [`MotionCover`] lists in preorder what became of each pair of parts in its interval, from both bodies in the
//! whole span on: split, in time or one of the parts, or parted throughout, by a plane that has a name or by a
//! list of planes of its own. Read to its end it covers all pairs of facets at all times.

use super::super::proof::PlaneAt;
use super::window::Plane;
use colltrans_solid::cast::StartProof;

/// What proves an answer about solids that turn.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct SolidMotionProof {
    /// The tolerance: both bodies are shrunk by half of it.
    pub tolerance: f64,
    /// Whether they overlap when the motion begins.
    pub start: StartProof,
    /// For each span of time in which both bodies spin evenly, up to that in which they meet.
    pub spans: Vec<SpanProof>,
    /// That they meet at a time.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "colltrans_kernel::written::given"))]
    pub meeting: Option<FacetsMeeting>,
}

/// Why no facets meet from the beginning of a span up to a time.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct SpanProof {
    /// That time.
    pub until: f64,
    /// All pairs of facets at all times.
    pub cover: MotionCover,
    /// The planes of those facets that it has no letter for, each joined to the next one.
    pub lists: Vec<Vec<PlaneAt>>,
}

/// That two facets meet at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct FacetsMeeting {
    /// When.
    pub time: f64,
    /// Which ones, by their positions in [`Solid::triangles`](colltrans_solid::Solid::triangles).
    pub triangles: [u32; 2],
    /// Why.
    pub met: FacetsMet,
}

/// What proves that two facets meet, or the solids that they are of.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum FacetsMet {
    /// An edge of one passes through the other, by more than computed places may be off.
    Crossing {
        /// Whether the edge is one of the moving body's facet.
        moving: bool,
        /// Which one, from this corner to the next: 0, 1 or 2.
        edge: u8,
    },
    /// Two points are no farther apart than the gap to be kept.
    Near {
        /// The weights of the corners of either facet.
        weights: [[f64; 3]; 2],
    },
    /// A point is inside both solids.
    Inside {
        /// Where, in the frame of the fixed body.
        point: [f64; 3],
    },
    /// A point of a facet of one body is inside the other body.
    Contained {
        /// Whether the facet is the moving body's.
        moving: bool,
        /// The weights of its corners.
        weights: [f64; 3],
    },
}

/// What became of each pair of parts in its interval, in preorder. As text a letter each: `T` its time was halved,
/// `P` or `Q` the moving or the fixed part was split; parted by the plane across the way between the middles `m`,
/// an axis `a b c` of the moving or `x y z` of the fixed body, the moving `p` or the fixed `q` facet, or an edge of
/// each `1` to `9`; by a list of planes `L`.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(into = "String", try_from = "String")
)]
pub struct MotionCover(pub(super) Vec<Entry>);

impl MotionCover {
    /// Entries, splits included.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// What became of a pair of parts in an interval.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Entry {
    /// Its time is halved.
    Halved,
    /// The moving (0) or the fixed (1) part is split in two.
    Split(u8),
    /// A plane parts them throughout.
    Parted(Plane),
    /// Two facets, parted by a list of planes.
    Listed,
}

/// A proof, as it is written down: entries in preorder, and the lists of planes that they speak of.
#[derive(Debug, Clone, Default)]
pub(super) struct Written {
    pub(super) entries: Vec<Entry>,
    pub(super) lists: Vec<Vec<PlaneAt>>,
}

impl SpanProof {
    pub(super) fn new(until: f64, Written { entries, lists }: Written) -> Self {
        Self { until, cover: MotionCover(entries), lists }
    }
}

/// The letters of all entries.
const LETTERS: [(char, Entry); 22] = {
    use Entry::{Halved, Listed, Parted, Split};
    use Plane::{Across, Axis, Edges, Middles};
    [
        ('T', Halved),
        ('P', Split(0)),
        ('Q', Split(1)),
        ('L', Listed),
        ('m', Parted(Middles)),
        ('a', Parted(Axis(0, 0))),
        ('b', Parted(Axis(0, 1))),
        ('c', Parted(Axis(0, 2))),
        ('x', Parted(Axis(1, 0))),
        ('y', Parted(Axis(1, 1))),
        ('z', Parted(Axis(1, 2))),
        ('p', Parted(Across(0))),
        ('q', Parted(Across(1))),
        ('1', Parted(Edges(0, 0))),
        ('2', Parted(Edges(0, 1))),
        ('3', Parted(Edges(0, 2))),
        ('4', Parted(Edges(1, 0))),
        ('5', Parted(Edges(1, 1))),
        ('6', Parted(Edges(1, 2))),
        ('7', Parted(Edges(2, 0))),
        ('8', Parted(Edges(2, 1))),
        ('9', Parted(Edges(2, 2))),
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
            known.map(|(_, entry)| *entry).ok_or_else(|| format!("no entry is written {letter:?}"))
        };
        text.chars().map(entry).collect::<Result<_, _>>().map(Self)
    }
}

/// The time at which an interval is halved.
pub(super) fn middle(from: f64, to: f64) -> f64 {
    from + 0.5 * (to - from)
}
