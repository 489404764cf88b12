//! Explanations of interlocked groups: what blocks their parts, and the sentences about it.
//!
//! All sentences about what is proven are made from one record ([`Claim`]), so that no text claims more than another. A
//! proof covers translations of a *group as one body*. It covers neither turns nor parts that move at the same time in
//! different directions.

use glam::DVec3;

use super::{Interlocked, PathSearch};
use crate::blocking::BlockingGraph;
use crate::bodies::{Bodies, Fit};
use crate::digits::short_number;
use crate::matrix::ContactMatrix;

/// Maximum number of smallest blocking sets that are listed for a part.
const MAX_SETS: usize = 4;
/// Number of names in a sentence before the number of the others is given. If there is only one other, it is named too.
const MAX_NAMES: usize = 3;

/// The smallest sets of parts that block a part.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockingSets {
    /// Index of the part.
    pub part: usize,
    /// The smallest sets of other parts without which the part is free along a tested direction, each with such a
    /// direction. At most 4 sets are listed.
    pub sets: Vec<(Vec<usize>, DVec3)>,
}

/// Builds the description of an interlocked group. The blocking sets are taken over the directions of the matrix.
pub(super) fn explain_stuck(
    bodies: &Bodies,
    left: &[usize],
    matrix: &ContactMatrix,
    fixed: bool,
    (directions, proven, moves): (usize, Option<usize>, PathSearch),
) -> Interlocked {
    let among = bodies.part_mask(left);
    let mut holds: Vec<BlockingSets> = Vec::new();
    for &part in left.iter().filter(|&&k| !bodies.assembly().parts()[k].is_fixed()) {
        holds.push(BlockingSets { part, sets: Vec::new() });
    }
    let mut overlapping = Vec::new();
    let constraints = bodies.assembly().constraints();
    let order = constraints.order_arcs(&among);
    for (k, &d) in matrix.directions().iter().enumerate() {
        let graph = BlockingGraph::with_order(matrix, k, &order, &among);
        for hold in &mut holds {
            if constraints.allows_direction(&[hold.part], d) {
                keep_smallest_sets(&mut hold.sets, graph.direct_blockers(hold.part), d);
            }
        }
        let met = matrix.contacts_along(k).iter().filter(|m| m.stop.is_none());
        overlapping.extend(
            met.filter(|m| m.moving < m.fixed && among[m.moving] && among[m.fixed])
                .map(|m| [m.moving, m.fixed]),
        );
    }
    overlapping.sort_unstable();
    overlapping.dedup();
    let constrained = constraints.is_concerned(left);
    Interlocked {
        parts: left.to_vec(),
        tested_directions: directions,
        proof_cells: proven,
        path_search: moves,
        blocking_sets: holds,
        overlapping_pairs: overlapping,
        has_fixed_parts: fixed,
        is_constrained: constrained,
    }
}

fn keep_smallest_sets(sets: &mut Vec<(Vec<usize>, DVec3)>, set: Vec<usize>, d: DVec3) {
    match sets.first().map_or(usize::MAX, |s| s.0.len()).cmp(&set.len()) {
        std::cmp::Ordering::Greater => *sets = vec![(set, d)],
        std::cmp::Ordering::Equal if sets.len() < MAX_SETS && sets.iter().all(|s| s.0 != set) => {
            sets.push((set, d));
        }
        _ => (),
    }
}

/// The established facts about an interlocked group, as text. Every sentence about what is proven is made from these.
struct Claim {
    /// Heading of the group in a list.
    heading: &'static str,
    /// The motions that separate nothing, as a sentence without its full stop.
    sentence: String,
    /// The evidence, as a sentence.
    evidence: String,
}

impl Interlocked {
    /// Returns the reason why the parts do not come apart, in one sentence.
    pub fn reason_sentence(&self, bodies: &Bodies) -> String {
        if let Some(near) = self.overlap_reason(bodies) {
            return near;
        }
        let sentence = self.established_claim(bodies).sentence;
        match self.least_held_part().filter(|_| self.parts.len() > 2) {
            Some((part, by)) => format!(
                "{sentence}; along the directions asked, {} is held by the fewest: {}.",
                bodies.assembly().parts()[part].name(),
                join_names(bodies, by)
            ),
            None => format!("{sentence}."),
        }
    }

    /// Returns the heading of the group in a list.
    pub fn heading(&self, bodies: &Bodies) -> &'static str {
        self.established_claim(bodies).heading
    }

    /// Returns the established facts. They cover only translations of a group as one body: parts that move at the
    /// same time in different directions may come apart although no group leaves.
    fn established_claim(&self, bodies: &Bodies) -> Claim {
        let along = match (self.proof_cells, self.tested_directions) {
            (Some(_), _) => "in any direction".into(),
            (None, 1) => "along the direction asked".into(),
            (None, count) => format!("along the {count} directions asked"),
        };
        let nothing = match self.parts[..] {
            [a, b] => {
                let [a, b] = [a, b].map(|part| bodies.assembly().parts()[part].name());
                format!("No straight motion {along} takes {a} from {b}")
            }
            _ => format!(
                "No group of these {} parts leaves the others as one in a straight motion {along}",
                self.parts.len()
            ),
        };
        let condition = if self.is_constrained {
            ", under the constraints on order and directions"
        } else {
            ""
        };
        let sentence = format!("{nothing}{condition}");
        let (heading, evidence) = match self.proof_cells {
            Some(cells) => (
                match (&self.path_search, self.overlapping_pairs.is_empty()) {
                    (PathSearch::Enclosed, _) => "stuck: proven for all motions",
                    (PathSearch::Proven { .. }, true) => {
                        "stuck: proven for all sequences of translations"
                    }
                    (PathSearch::Proven { .. }, false) => {
                        "stuck: proven for all sequences of translations, with what overlaps as one"
                    }
                    (_, true) => "stuck: proven for each single translation of a group as one",
                    (_, false) => {
                        "stuck: proven for each single translation of a group as one, with what overlaps as one"
                    }
                },
                format!("This is proven in {cells} cells of the sphere of directions."),
            ),
            None => (
                "stuck: no single translation found, not proven",
                "Other directions were not tried.".into(),
            ),
        };
        Claim { heading, sentence, evidence }
    }

    /// Returns a sentence about the parts that overlap with this fit or violate the minimum gap. Returns `None` if
    /// there are none.
    fn overlap_reason(&self, bodies: &Bodies) -> Option<String> {
        let [first, rest @ ..] = &self.overlapping_pairs[..] else { return None };
        let names = bodies.assembly().part_names(first).join(" and ");
        let (one, several) = match bodies.fit() {
            Fit::MinGap(_) => ("is", "are"),
            _ => ("does", "do"),
        };
        let more = match rest.len() {
            0 => String::new(),
            1 => format!(", and so {one} one more pair"),
            more => format!(", and so {several} {more} more pairs"),
        };
        Some(match bodies.fit() {
            Fit::MinGap(length) => format!(
                "Where they stand, {names} are nearer to each other than the {} to keep{more}, and such parts are not \
                 moved apart.",
                short_number(length)
            ),
            _ if bodies.least_tolerance(first[0], first[1]).is_none() => format!(
                "Shrunk by half of the tolerance each, {names} run into each other{more}, which they do not as they \
                 are drawn: a smaller tolerance may part them."
            ),
            _ => format!(
                "With this fit, {names} run into each other{more}, and such parts are not moved apart."
            ),
        })
    }

    /// Returns the [reason](Self::reason_sentence) and the [details](Self::evidence_sentences).
    pub fn explain(&self, bodies: &Bodies) -> String {
        format!("{} {}", self.reason_sentence(bodies), self.evidence_sentences(bodies))
    }

    /// Returns sentences with the evidence, its limits, and possible remedies.
    pub fn evidence_sentences(&self, bodies: &Bodies) -> String {
        let overlaps = !self.overlapping_pairs.is_empty();
        let Claim { sentence, evidence, .. } = self.established_claim(bodies);
        let mut sentences = Vec::new();
        if overlaps {
            sentences.push(self.describe_overlapping(bodies));
            sentences.push(format!("{sentence}."));
        }
        sentences.push(evidence);
        sentences.push(self.path_search.describe());
        if self.parts.len() > 2 && self.path_search != PathSearch::Enclosed {
            sentences
                .push("Motions of several parts at once, each its own way, were not tried.".into());
        }
        if self.is_constrained {
            sentences.push("Constraints on their order and directions apply.".into());
        }
        // If they are few, the reason already names them all.
        let held = self.least_held_part().filter(|(_, by)| overlaps || by.len() > MAX_NAMES + 1);
        if let Some((part, by)) = held {
            let names = bodies.assembly().part_names(by).join(", ");
            let part = bodies.assembly().parts()[part].name();
            sentences.push(format!(
                "The least that holds a part along the directions asked: {part} is held by {names}."
            ));
        }
        sentences.join(" ")
    }

    /// Returns a sentence about the treatment of overlapping parts.
    fn describe_overlapping(&self, bodies: &Bodies) -> String {
        let parts = bodies.assembly().parts();
        let open = self.parts.iter().filter(|&&part| parts[part].is_surface()).count();
        let open = match open {
            0 => String::new(),
            open => format!(
                "; {open} of these {} are open surfaces, whose interior is unknown",
                self.parts.len()
            ),
        };
        let near = match bodies.fit() {
            Fit::MinGap(_) => "are too near to each other",
            _ => "overlap",
        };
        format!("Parts that {near} move as one, unless a role or a tolerance lets them pass{open}.")
    }

    /// Returns the part with the smallest blocking set, and this set. Returns `None` if no part is blocked.
    fn least_held_part(&self) -> Option<(usize, &[usize])> {
        let held = self
            .blocking_sets
            .iter()
            .filter_map(|hold| Some((hold.part, &hold.sets.first()?.0[..])));
        held.filter(|(_, by)| !by.is_empty()).min_by_key(|(_, by)| by.len())
    }
}

/// Joins the names of parts for a sentence. Of many parts only the first are named.
fn join_names(bodies: &Bodies, parts: &[usize]) -> String {
    let names = bodies.assembly().part_names(parts);
    match &names[..] {
        [first @ .., last] if (1..=MAX_NAMES).contains(&first.len()) => {
            format!("{} and {last}", first.join(", "))
        }
        [first @ .., _] if !first.is_empty() => {
            let more = names.len() - MAX_NAMES;
            format!("{} and {more} more", names[..MAX_NAMES].join(", "))
        }
        _ => names.concat(),
    }
}

impl PathSearch {
    /// Returns a sentence about the search for removal paths of several moves.
    fn describe(&self) -> String {
        match self {
            Self::NotSearched(why) => {
                format!("Several moves, one after another, were not searched: {why}.")
            }
            Self::Enclosed => {
                "Nor does any other motion, which is proven: a closed surface encloses what stays inside. This covers \
                 turns, and parts that move at the same time."
                    .into()
            }
            Self::ConstraintsViolated => {
                "The paths of several moves that were found violate constraints on order and directions."
                    .into()
            }
            Self::Proven { cells } => format!(
                "Nor do several straight moves, one after another, which is proven in {cells} cells of displacements."
            ),
            Self::NotFound { effort, searched } => {
                let places = match searched.places {
                    1 => "1 place".into(),
                    places => format!("{places} places"),
                };
                let end = if searched.complete { "; no more places were found" } else { "" };
                format!(
                    "Several moves, one after another: not found with effort {effort}, from {places} along {} \
                     directions{end}. This is not proven.",
                    searched.directions
                )
            }
        }
    }
}
