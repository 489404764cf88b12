//! What holds parts that do not come apart, and how that is said.

use glam::DVec3;

use super::{Moves, Stuck};
use crate::blocking::Blocking;
use crate::bodies::{Bodies, Fit};
use crate::digits::short;
use crate::matrix::Matrix;

/// Least sets are listed up to this many for a part.
const MOST_SETS: usize = 4;
/// In a sentence so many parts are named, and one more.
const MOST_NAMES: usize = 3;

/// The least that would have to go for a part to come out.
#[derive(Debug, Clone, PartialEq)]
pub struct Hold {
    /// The part.
    pub part: usize,
    /// The smallest sets of other parts without which it is free along one of the directions asked,
    /// each with such a direction; some, if there are many.
    pub by: Vec<(Vec<usize>, DVec3)>,
}

/// Why these parts do not come apart along any direction: the least sets over those of the matrix.
pub(super) fn explain(
    bodies: &Bodies,
    left: &[usize],
    matrix: &Matrix,
    fixed: bool,
    (directions, proven, moves): (usize, Option<usize>, Moves),
) -> Stuck {
    let among = bodies.mask(left);
    let mut holds: Vec<Hold> = Vec::new();
    for &part in left.iter().filter(|&&k| !bodies.assembly().parts()[k].fixed()) {
        holds.push(Hold { part, by: Vec::new() });
    }
    let mut overlapping = Vec::new();
    let constraints = bodies.assembly().constraints();
    let order = constraints.arcs(&among);
    for (k, &d) in matrix.directions().iter().enumerate() {
        let graph = Blocking::with_order(matrix, k, &order, &among);
        for hold in &mut holds {
            if constraints.allows(&[hold.part], d) {
                keep_least(&mut hold.by, graph.blockers(hold.part), d);
            }
        }
        let met = matrix.meetings(k).iter().filter(|m| m.stop.is_none());
        overlapping.extend(
            met.filter(|m| m.moving < m.fixed && among[m.moving] && among[m.fixed])
                .map(|m| [m.moving, m.fixed]),
        );
    }
    overlapping.sort_unstable();
    overlapping.dedup();
    let constrained = constraints.concern(left);
    Stuck {
        parts: left.to_vec(),
        directions,
        proven,
        moves,
        holds,
        overlapping,
        fixed,
        constrained,
    }
}

fn keep_least(sets: &mut Vec<(Vec<usize>, DVec3)>, set: Vec<usize>, d: DVec3) {
    match sets.first().map_or(usize::MAX, |s| s.0.len()).cmp(&set.len()) {
        std::cmp::Ordering::Greater => *sets = vec![(set, d)],
        std::cmp::Ordering::Equal if sets.len() < MOST_SETS && sets.iter().all(|s| s.0 != set) => {
            sets.push((set, d));
        }
        _ => (),
    }
}

impl Stuck {
    /// Why, in one sentence.
    pub fn reason(&self, bodies: &Bodies) -> String {
        if let Some(near) = self.near(bodies) {
            return near;
        }
        let name = |k: usize| bodies.assembly().parts()[k].name();
        let count = self.parts.len();
        let pulled = if count == 2 { "it is pulled" } else { "they are pulled" };
        let way = match (self.proven, self.directions) {
            (Some(_), _) => format!("Whichever way {pulled}"),
            (None, 1) => "In the direction that was asked".into(),
            (None, directions) => format!("In all {directions} directions that were tried"),
        };
        let asked =
            if self.constrained { ", as the order and directions are asked for" } else { "" };
        match self.easiest() {
            Some((part, by)) if count == 2 => {
                format!("{way}, {} is held by {}{asked}.", name(part), listed(bodies, by))
            }
            Some((part, by)) => format!(
                "{way}, these {count} parts hold each other{asked}, and {} is held by the fewest, {}.",
                name(part),
                listed(bodies, by)
            ),
            None => format!("{way}, none of these {count} parts leaves the others{asked}."),
        }
    }

    /// Which parts overlap with this fit, or are nearer than the length to keep, if any do.
    fn near(&self, bodies: &Bodies) -> Option<String> {
        let [first, rest @ ..] = &self.overlapping[..] else { return None };
        let names = bodies.assembly().names(first).join(" and ");
        let (one, several) = match bodies.fit() {
            Fit::Apart(_) => ("is", "are"),
            _ => ("does", "do"),
        };
        let more = match rest.len() {
            0 => String::new(),
            1 => format!(", and so {one} one more pair"),
            more => format!(", and so {several} {more} more pairs"),
        };
        Some(match bodies.fit() {
            Fit::Apart(length) => format!(
                "Where they stand, {names} are nearer to each other than the {} to keep{more}, and such parts are not \
                 moved apart.",
                short(length)
            ),
            _ if bodies.overlap_as_given(first[0], first[1]).is_none() => format!(
                "Shrunk by half of the tolerance each, {names} run into each other{more}, which they do not as they \
                 are drawn: a smaller tolerance may part them."
            ),
            _ => format!(
                "As they are drawn, {names} run into each other{more}, and such parts cannot be parted."
            ),
        })
    }

    /// Why, in words: the [reason](Self::reason), and how that is known.
    pub fn because(&self, bodies: &Bodies) -> String {
        format!("{} {}", self.reason(bodies), self.details(bodies))
    }

    /// How that is known, and what may help, in sentences.
    pub fn details(&self, bodies: &Bodies) -> String {
        let overlaps = !self.overlapping.is_empty();
        let mut said = Vec::new();
        if overlaps {
            said.push(self.as_one(bodies));
        }
        said.push(self.single());
        said.push(self.moves.words());
        if self.constrained {
            said.push("What is asked of their order and directions counts.".into());
        }
        // The reason names them all if they are few.
        let held = self.easiest().filter(|(_, by)| overlaps || by.len() > MOST_NAMES + 1);
        if let Some((part, by)) = held {
            let names = bodies.assembly().names(by).join(", ");
            let part = bodies.assembly().parts()[part].name();
            said.push(format!("The least that holds a part: {part} is held by {names}."));
        }
        said.join(" ")
    }

    /// What is known of single moves.
    fn single(&self) -> String {
        let apart = if self.fixed {
            "takes any of them from what is fixed or from each other"
        } else {
            "takes them apart"
        };
        let single = "No single straight motion";
        match (self.proven, self.directions) {
            (Some(cells), _) => format!(
                "{single} in any direction {apart}, which is proven in {cells} cells of the sphere."
            ),
            (None, 1) => {
                format!("{single} along the direction asked {apart}; of others it is not known.")
            }
            (None, count) => format!(
                "{single} along the {count} directions asked {apart}; of others it is not known."
            ),
        }
    }

    /// What becomes of parts that overlap.
    fn as_one(&self, bodies: &Bodies) -> String {
        let parts = bodies.assembly().parts();
        let open = self.parts.iter().filter(|&&part| parts[part].is_surface()).count();
        let open = match open {
            0 => String::new(),
            open => format!(
                "; {open} of these {} are open surfaces, of which it is not known what is inside",
                self.parts.len()
            ),
        };
        let near = match bodies.fit() {
            Fit::Apart(_) => "are too near to each other",
            _ => "overlap",
        };
        format!("Parts that {near} move as one, unless a role or a tolerance lets them pass{open}.")
    }

    /// The part that the fewest others hold, and those.
    fn easiest(&self) -> Option<(usize, &[usize])> {
        let held = self.holds.iter().filter_map(|hold| Some((hold.part, &hold.by.first()?.0[..])));
        held.filter(|(_, by)| !by.is_empty()).min_by_key(|(_, by)| by.len())
    }
}

/// Names in a sentence, of many the first ones.
fn listed(bodies: &Bodies, parts: &[usize]) -> String {
    let names = bodies.assembly().names(parts);
    match &names[..] {
        [first @ .., last] if (1..=MOST_NAMES).contains(&first.len()) => {
            format!("{} and {last}", first.join(", "))
        }
        [first @ .., _] if !first.is_empty() => {
            let more = names.len() - MOST_NAMES;
            format!("{} and {more} more", names[..MOST_NAMES].join(", "))
        }
        _ => names.concat(),
    }
}

impl Moves {
    /// What is known of several moves, in a sentence.
    fn words(&self) -> String {
        match self {
            Self::NotAsked(why) => {
                format!("Several moves, one after another, were not looked for: {why}.")
            }
            Self::NotKept => {
                "Several moves that were found do not keep what is asked of order and directions."
                    .into()
            }
            Self::Proven { cells } => format!(
                "Nor do several moves, one after another, which is proven in {cells} cells of displacements."
            ),
            Self::NotFound { legs, searched } => {
                let places = match searched.places {
                    1 => "1 place".into(),
                    places => format!("{places} places"),
                };
                let end =
                    if searched.complete { "" } else { ", where the limit of work was reached" };
                format!(
                    "Up to {legs} moves, one after another, were not found either, searched from {places} along {} \
                     directions{end}.",
                    searched.directions
                )
            }
        }
    }
}
