//! What holds parts that do not come apart, and how that is said.

use std::fmt::Write;

use glam::DVec3;

use super::{Moves, Stuck};
use crate::blocking::Blocking;
use crate::bodies::Bodies;
use crate::matrix::Matrix;

/// Least sets are listed up to this many for a part.
const MOST_SETS: usize = 4;

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
    /// The reason in words.
    pub fn because(&self, bodies: &Bodies) -> String {
        let name = |k: usize| bodies.assembly().parts()[k].name();
        let directions = match self.proven {
            Some(cells) => {
                format!("in any direction, which is proven in {cells} cells of the sphere,")
            }
            None if self.directions == 1 => "along the direction asked".into(),
            None => format!("along the {} directions asked", self.directions),
        };
        let mut text = match (&self.overlapping[..], self.fixed) {
            ([], false) => {
                format!("no single straight motion {directions} takes them apart")
            }
            ([], true) => {
                format!(
                    "no single straight motion {directions} takes any of them from what is fixed or \
                     from each other"
                )
            }
            ([[a, b], rest @ ..], _) => {
                let more = match rest.len() {
                    0 => String::new(),
                    1 => ", and so do those of one more pair".into(),
                    more => format!(", and so do those of {more} more pairs"),
                };
                let parts = bodies.assembly().parts();
                let open = self.parts.iter().filter(|&&part| parts[part].is_surface()).count();
                let open = match open {
                    0 => String::new(),
                    open => format!(
                        "; {open} of these {} are open surfaces, of which it is not known what is \
                         inside",
                        self.parts.len()
                    ),
                };
                format!(
                    "{} and {} run into each other as they are drawn{more}, and such parts move as \
                     one, unless a tolerance or a role is given for them{open}",
                    name(*a),
                    name(*b)
                )
            }
        };
        if self.constrained {
            text.push_str("; what is asked of their order and directions counts");
        }
        text.push_str(&self.moves.words());
        let easiest =
            self.holds.iter().filter(|h| !h.by.is_empty()).min_by_key(|h| h.by[0].0.len());
        if let Some(hold) = easiest {
            let (set, _) = &hold.by[0];
            let names: Vec<&str> = set.iter().map(|&k| name(k)).collect();
            let _ = write!(
                text,
                "; the least that holds a part: {} is held by {}",
                name(hold.part),
                names.join(", ")
            );
        }
        text
    }
}

impl Moves {
    /// What goes on after what is said of a single move.
    fn words(&self) -> String {
        let several = |count: usize, one: &str, more: &str| match count {
            1 => format!("1 {one}"),
            count => format!("{count} {more}"),
        };
        match self {
            Self::NotAsked(why) => format!("; several moves were not looked for: {why}"),
            Self::NotKept => {
                "; several moves that were found do not keep what is asked of order and directions"
                    .into()
            }
            Self::Proven { cells } => format!(
                "; nor do several moves, whichever, which is proven in {cells} cells of displacements"
            ),
            Self::NotFound { legs, searched } => {
                let places = several(searched.places, "place", "places");
                let end =
                    if searched.complete { "" } else { ", where the limit of work was reached" };
                format!(
                    "; up to {legs} moves one after another, searched from {places} along {} directions{end}, \
                     were not found either",
                    searched.directions
                )
            }
        }
    }
}
