//! The pseudocode of figure 7 by brute force: steps with the paper's cuts and cells, and with those of the library.
//!
//! | | the paper | the library |
//! |---|---|---|
//! | line 5, cell | between the nearest vertex levels above and below on both bodies: the *drums* (III-A, III-C) | the complete cell of an edge contact |
//! | line 7, cut | through the best point `q` of the cell | at the best value found so far |
//!
//! All variants have the complete cell of a vertex contact and an ideal exit test, which compares with the known
//! minimum. Therefore they differ in cuts and cells only.

use colltrans::observe::{Observer, Sections};
use colltrans::{Cast, ConvexPolyhedron, Outcome, Pose, Solver};
use glam::{DVec2, DVec3};

use super::levels::centroid;
use super::planar::{Features, View};
use super::setting::{Setting, below};

/// Cells and cuts of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Variant {
    /// Whether cells end at the levels of vertices.
    pub(crate) has_drums: bool,
    /// Whether the cut passes through the best point of the cell.
    pub(crate) cuts_at_best_point: bool,
}

/// The variants: the library's, each of the paper's rules alone, and both.
pub(crate) const VARIANTS: [(&str, Variant); 4] = [
    (
        "complete cells, cuts at the best value",
        Variant { has_drums: false, cuts_at_best_point: false },
    ),
    ("complete cells, cuts through q", Variant { has_drums: false, cuts_at_best_point: true }),
    (
        "cells within drums, cuts at the best value",
        Variant { has_drums: true, cuts_at_best_point: false },
    ),
    (
        "the paper: cells within drums, cuts through q",
        Variant { has_drums: true, cuts_at_best_point: true },
    ),
];

/// Maximum number of steps.
const MAX_STEPS: u32 = 100;

/// Excess over the minimum, in units of the extent of levels, at which a search ends.
const PRECISION: f64 = 1e-9;

/// Observer that stores the section axes of a query.
#[derive(Default)]
struct AxesOf(Option<Sections>);

impl Observer for AxesOf {
    fn sections(&mut self, sections: impl FnOnce() -> Sections) {
        self.0 = Some(sections());
    }
}

/// Counts the steps of each variant, and those of the library. Returns `None` if the bodies do not meet, or if a search
/// does not end.
pub(crate) fn count_steps(
    bodies: &[ConvexPolyhedron; 2],
    poses: [Pose; 2],
    direction: DVec3,
) -> Option<[u32; VARIANTS.len() + 1]> {
    let [moving, fixed] = [0, 1].map(|body| bodies[body].at(poses[body]));
    let cast = Cast::new(moving, fixed, direction).ok()?.with_solver(Solver::Cta);
    let mut seen = AxesOf::default();
    let Ok(Outcome::Contact(contact)) = cast.first_contact_observed(&mut seen) else { return None };
    let sections = seen.0?;
    let view = View::new(&Setting { bodies: bodies.clone(), poses, direction }, &sections);
    let levels = [0, 1].map(|body| view.vertex_levels(body));
    let mut steps = [contact.steps.planar_problems; VARIANTS.len() + 1];
    for (steps, (_, variant)) in steps.iter_mut().zip(VARIANTS) {
        *steps = minimise(&view, &levels, contact.translation, variant)?;
    }
    Some(steps)
}

/// Searches the levels at which `phi` has its known minimum, from the centre of all levels. Returns the number of steps.
fn minimise(view: &View, levels: &[Vec<f64>; 2], minimum: f64, variant: Variant) -> Option<u32> {
    let ends = levels.each_ref().map(|levels| [levels[0], levels[levels.len() - 1]]);
    let [low, high] = [0, 1].map(|k| DVec2::new(ends[0][k], ends[1][k]));
    let mut region = vec![low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
    let mut best = f64::INFINITY;
    for steps in 1..=MAX_STEPS {
        if region.len() < 3 {
            return None;
        }
        let at = centroid(&region);
        let found = view.instance(at)?;
        let limit = match found.features {
            Features::Apart(..) => 0.0,
            Features::Touching(faces) => {
                let mut cell = view.cell(faces, [low, high]);
                if variant.has_drums {
                    cell = within_drums(cell, levels, at);
                }
                let falls = |q: &DVec2| found.gradient.dot(*q - at);
                let fall = cell.iter().map(falls).fold(0.0, f64::min);
                let value = found.value + fall;
                best = best.min(value);
                if best - minimum <= PRECISION * (high - low).max_element() {
                    return Some(steps);
                }
                if variant.cuts_at_best_point { value } else { best }
            }
        };
        region = below(&region, found.gradient, found.gradient.dot(at) + limit - found.value);
    }
    None
}

/// Returns the part of a cell between the vertex levels next to a pair of levels.
fn within_drums(mut cell: Vec<DVec2>, levels: &[Vec<f64>; 2], at: DVec2) -> Vec<DVec2> {
    for (body, axis) in DVec2::AXES.into_iter().enumerate() {
        let above = levels[body].partition_point(|level| *level <= at[body]);
        let above = above.clamp(1, levels[body].len() - 1);
        let [low, high] = [levels[body][above - 1], levels[body][above]];
        cell = below(&below(&cell, axis, high), -axis, -low);
    }
    cell
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::{self, Meeting};
    use crate::shapes::{Kind, bodies};
    use colltrans_testkit::random::Random;

    /// The library tests its exit by features, and its cells of vertex contacts are smaller. Therefore it takes more steps
    /// than the ideal search, but far fewer than one in cells within drums.
    #[test]
    fn library_takes_more_steps_than_ideal_search_and_fewer_than_drums() {
        let bodies = bodies(3, Kind::Balanced, 200, 0);
        let mut random = Random::new(3);
        let (mut sums, mut count) = ([0; VARIANTS.len() + 1], 0);
        for _ in 0..100 {
            let s = settings::Setting::draw(&bodies, Meeting::Colliding, &mut random);
            if let Some(steps) = count_steps(&bodies.pair, [s.moving, s.fixed], s.direction) {
                sums.iter_mut().zip(steps).for_each(|(sum, steps)| *sum += steps);
                count += 1;
            }
        }
        assert!(count >= 95, "{count}");
        let [ideal, through, drums, paper, library] = sums;
        assert!(ideal <= through && drums <= paper, "{sums:?}");
        assert!(ideal < library && 3 * library < 2 * drums, "{sums:?}");
    }
}
