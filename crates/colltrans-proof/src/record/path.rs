//! A first contact on a path of joints, as front ends write it.

use std::collections::{BTreeMap, HashSet};

use super::{Ending, TimeRecord, coordinates, record};
use colltrans_motion::path::{PathCast, PathContact, PathOutcome, Place};

record! {
    /// Which two bodies first meet on a path, and when. Fields that do not apply are left out.
    #[non_exhaustive]
    pub struct PathRecord {
        /// `contact`; `grazing`: nearer than rounding can tell; `free` throughout; `overlapping` where the path begins;
        /// `undecided`: the search took its maximum number of steps, and `time.lower` is up to when none meet.
        pub outcome: Ending,
        /// Of a contact, in the times of the path; of a grazing one the upper bound is missing.
        pub time: Option<TimeRecord>,
        /// Where that is between two rows.
        pub place: Option<Place>,
        /// The names of the two bodies.
        pub pair: Option<[String; 2]>,
        /// Where the first one is nearest to the second then, in the world.
        pub point: Option<[f64; 3]>,
        /// Unit vector in the world, from the first to the second.
        pub normal: Option<[f64; 3]>,
        /// The gap that is kept, a length: two bodies count as meeting where they are as near as that.
        pub keep: Option<f64>,
        /// How many pairs of bodies were asked about.
        pub pairs: usize,
        /// The names of those that were not, though a joint may move one against the other: nothing is said of them.
        pub left_out: Vec<[String; 2]>,
        /// Where the path begins with overlaps: the names of all pairs that overlap there, or are as near as `keep`.
        pub overlaps: Vec<[String; 2]>,
        /// Links for whose meshes their convex hulls stand: a contact of one is that of its hull.
        pub hulls: Vec<String>,
        /// Names of bodies whose meshes are convex only to within the tolerance, each with the largest depth of its
        /// surface below the hull that stands for it, a length.
        pub dents: BTreeMap<String, f64>,
        /// For people: in what the answer is about less than the input.
        pub notes: Vec<String>,
        /// How often two bodies were looked at.
        pub looks: u32,
        /// Planes in the proof.
        pub planes: usize,
    }
}

impl PathRecord {
    /// Of an answer; `cast` is the one that was asked, `names` are those of its bodies.
    pub fn of(outcome: &PathOutcome, cast: &PathCast<'_>, names: &[String]) -> Self {
        let ending = match outcome {
            PathOutcome::Contact(_) => Ending::Contact,
            PathOutcome::Grazing(_) => Ending::Grazing,
            PathOutcome::Free(_) => Ending::Free,
            PathOutcome::Overlapping(_) => Ending::Overlapping,
            _ => Ending::Undecided,
        };
        let (looks, planes) = (outcome.steps().looks, outcome.proof().planes());
        let pairs = cast.pairs().len();
        let keep = Some(cast.keep()).filter(|gap| *gap > 0.0);
        let left_out = left_out(cast, names);
        let overlaps = match outcome {
            PathOutcome::Overlapping(of) => overlaps(cast, of.pair, names),
            _ => Vec::new(),
        };
        let record = Self {
            outcome: ending,
            keep,
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
                    point: points.map(|points| coordinates(points[0])),
                    normal: normal.map(coordinates),
                    ..record
                }
            }
            _ => record,
        }
    }
}

/// The names of all pairs that overlap where the path begins, each once; at least those of one that is known.
fn overlaps(cast: &PathCast<'_>, known: [usize; 2], names: &[String]) -> Vec<[String; 2]> {
    let found = cast.start_overlaps().unwrap_or_else(|_| vec![known]);
    let mut told: Vec<[String; 2]> = Vec::new();
    for pair in found {
        let pair = pair.map(|body| names.get(body).cloned().unwrap_or_default());
        if !told.contains(&pair) {
            told.push(pair);
        }
    }
    told
}

/// The names of bodies none of whose parts were asked about, each two once.
fn left_out(cast: &PathCast<'_>, names: &[String]) -> Vec<[String; 2]> {
    let named = |pair: &[usize; 2]| pair.map(|body| names.get(body).cloned().unwrap_or_default());
    let mut told: HashSet<[String; 2]> = cast.pairs().iter().map(named).collect();
    let mut left_out = Vec::new();
    for [a, b] in cast.left_out().iter().map(named) {
        if !told.contains(&[b.clone(), a.clone()]) && told.insert([a.clone(), b.clone()]) {
            left_out.push([a, b]);
        }
    }
    left_out
}
