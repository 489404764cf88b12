//! Records of first contacts on paths of joints.

use std::collections::{BTreeMap, HashSet};

use super::{Ending, TimeRecord, record, without_negative_zeros};
use colltrans_motion::path::{PathCast, PathContact, PathOutcome, PathPlace};

record! {
    /// First contact of two bodies on a path. Fields that do not apply are omitted.
    #[non_exhaustive]
    pub struct PathRecord {
        /// - `contact`: two bodies meet.
        /// - `grazing`: two bodies come closer than the rounding error.
        /// - `free`: no bodies meet on the whole path.
        /// - `overlapping`: bodies overlap at the start of the path.
        /// - `undecided`: the search took its maximum number of steps. No bodies meet before `time.lower`.
        pub outcome: Ending,
        /// Bounds of the contact in the times of the path. The upper bound is absent if no contact is proven.
        pub time: Option<TimeRecord>,
        /// Position of the contact between two rows of the path.
        pub place: Option<PathPlace>,
        /// Names of the two bodies.
        pub pair: Option<[String; 2]>,
        /// Point of the first body that is nearest to the second one at that time, in the world frame.
        pub point: Option<[f64; 3]>,
        /// Unit normal in the world frame, from the first to the second body.
        pub normal: Option<[f64; 3]>,
        /// Minimum gap, a length. Two bodies meet if their distance falls to it.
        pub min_gap: Option<f64>,
        /// Number of pairs of bodies in the query.
        pub pairs: usize,
        /// Names of the pairs that the query omits although a joint may move one body against the other. No
        /// claim is made about them.
        pub left_out: Vec<[String; 2]>,
        /// For a path that starts with overlaps, the names of all pairs that overlap there or are closer than
        /// `min_gap`.
        pub overlaps: Vec<[String; 2]>,
        /// Links whose meshes are replaced by their convex hulls. A contact of such a link is a contact of
        /// its hull.
        pub hulls: Vec<String>,
        /// Names of bodies whose meshes are convex only within the tolerance, each with the largest depth of
        /// its surface below its hull, a length.
        pub dents: BTreeMap<String, f64>,
        /// Notes for users on differences between the answer and the input.
        pub notes: Vec<String>,
        /// Number of distance samples of two bodies.
        pub looks: u32,
        /// Number of planes of the proof.
        pub planes: usize,
    }
}

impl PathRecord {
    /// Converts an answer. `cast` must be the cast of the query, `names` are the names of its bodies.
    pub fn from_outcome(outcome: &PathOutcome, cast: &PathCast<'_>, names: &[String]) -> Self {
        let ending = match outcome {
            PathOutcome::Contact(_) => Ending::Contact,
            PathOutcome::Grazing(_) => Ending::Grazing,
            PathOutcome::Free(_) => Ending::Free,
            PathOutcome::Overlapping(_) => Ending::Overlapping,
            _ => Ending::Undecided,
        };
        let (looks, planes) = (outcome.steps().looks, outcome.proof().plane_count());
        let pairs = cast.pairs().len();
        let min_gap = Some(cast.min_gap()).filter(|gap| *gap > 0.0);
        let left_out = omitted_pairs(cast, names);
        let overlaps = match outcome {
            PathOutcome::Overlapping(of) => start_overlap_names(cast, of.pair, names),
            _ => Vec::new(),
        };
        let record = Self {
            outcome: ending,
            min_gap,
            pairs,
            left_out,
            overlaps,
            looks,
            planes,
            ..Self::default()
        };
        let name = |body: usize| names.get(body).cloned().unwrap_or_default();
        match outcome {
            PathOutcome::Contact(of)
            | PathOutcome::Grazing(of)
            | PathOutcome::Overlapping(of)
            | PathOutcome::Undecided(of) => {
                let PathContact { lower, upper, place, pair, points, normal, .. } = of;
                let upper = upper.is_finite().then_some(*upper);
                Self {
                    time: Some(TimeRecord { lower: *lower, upper }),
                    place: Some(*place),
                    pair: Some(pair.map(name)),
                    point: points.map(|points| without_negative_zeros(points[0])),
                    normal: normal.map(without_negative_zeros),
                    ..record
                }
            }
            _ => record,
        }
    }
}

/// Returns the names of all pairs that overlap at the start of the path or whose distance there is at most
/// the minimum gap, without duplicates. If this query fails, returns the names of the pair `known`.
fn start_overlap_names(
    cast: &PathCast<'_>,
    known: [usize; 2],
    names: &[String],
) -> Vec<[String; 2]> {
    let found = cast.start_overlaps().unwrap_or_else(|_| vec![known]);
    let mut listed: Vec<[String; 2]> = Vec::new();
    for pair in found {
        let pair = pair.map(|body| names.get(body).cloned().unwrap_or_default());
        if !listed.contains(&pair) {
            listed.push(pair);
        }
    }
    listed
}

/// Returns the pairs of names of bodies that the query omits entirely, without duplicates.
fn omitted_pairs(cast: &PathCast<'_>, names: &[String]) -> Vec<[String; 2]> {
    let named = |pair: &[usize; 2]| pair.map(|body| names.get(body).cloned().unwrap_or_default());
    let mut listed: HashSet<[String; 2]> = cast.pairs().iter().map(named).collect();
    let mut left_out = Vec::new();
    for [a, b] in cast.unqueried_pairs().iter().map(named) {
        if !listed.contains(&[b.clone(), a.clone()]) && listed.insert([a.clone(), b.clone()]) {
            left_out.push([a, b]);
        }
    }
    left_out
}
