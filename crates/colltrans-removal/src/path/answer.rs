//! Removal paths as an answer: legs with their proofs.

use std::sync::atomic::AtomicBool;

use glam::DVec3;

use super::candidates::{candidate_directions, wall_axes};
use super::enclosed::{Enclosure, EnclosureResult, NoRemovalPath, cell_axes};
use super::options::{Order, RemovalOptions, SearchWork};
use super::pairs::{BodyPair, bounding_box};
use super::proof::{LegProof, certified_legs};
use super::scene::RemovalScene;
use super::search::{BodyRoles, Group, Move, Search, SearchEnd, SearchScale};
use crate::directions::FreeError;
use colltrans_convex::body::{Aabb, Placed};
use colltrans_convex::cast::Cast;
use colltrans_convex::setting::error::QueryError;
use colltrans_solid::SolidCast;
use colltrans_solid::body::{AsSolid, Solid, check_is_not_rounded};

/// Tolerance of the search, as a fraction of the tolerance of the answer.
pub(super) const SEARCH_TOLERANCE_SHARE: f64 = 0.8;
/// Distance from a contact at which a leg stops, as a fraction of the difference of both gaps: 0.1 of the tolerance.
const SLACK_SHARE: f64 = 0.5;
/// Bodies below this fraction of the largest one have the minimum moves of a body of this size.
const SMALL_BODY: f64 = 0.125;
/// Maximum number of bodies of a search.
pub const MAX_BODIES: usize = Group::BITS as usize - 1;

/// Moves one after another. The last one has no end.
#[derive(Debug, Clone, PartialEq)]
pub struct RemovalPath {
    /// Moves in order.
    pub legs: Vec<Leg>,
    /// Tolerance. All bodies are offset inwards by half of it.
    pub tolerance: f64,
    /// Amounts of work of the search.
    pub searched: SearchWork,
}

/// Move of some bodies together along a line.
#[derive(Debug, Clone, PartialEq)]
pub struct Leg {
    /// Indices of the bodies that move, in increasing order. The last leg removes them.
    pub bodies: Vec<usize>,
    /// Direction, of length 1 up to rounding.
    pub direction: DVec3,
    /// Length of the move, infinite for the last leg.
    pub travel: f64,
    /// Exact vector of the move, or the direction of the last leg.
    pub motion: DVec3,
    /// One proof for each pair of a moving body and a body at rest.
    pub proofs: Vec<LegProof>,
}

/// Answer whether a removal path in several moves exists.
#[derive(Debug, Clone, PartialEq)]
pub enum RemovalSearch {
    /// A removal path.
    Found(RemovalPath),
    /// It is proven that no sequence of translations separates the two bodies.
    Proven(NoRemovalPath),
    /// The search found no path. One may exist.
    NotFound {
        /// Amounts of work of the search.
        searched: SearchWork,
    },
}

impl RemovalSearch {
    /// Searches for a sequence of translations that removes one body from another. A convex body is treated
    /// as a solid.
    ///
    /// The first body has the index 0 and moves. The second one has the index 1 and is fixed.
    ///
    /// # Errors
    /// Returns [`FreeError::Query`] for bodies or options that a cast rejects, [`FreeError::Open`] for an
    /// open shell, and [`FreeError::Overlapping`] if the bodies overlap at the start with 0.8 of the
    /// tolerance.
    ///
    /// ```
    /// use colltrans::glam::DVec3;
    /// use colltrans::removal::path::{RemovalOptions, RemovalSearch};
    /// use colltrans::{ConvexPolyhedron, Pose, Solid};
    ///
    /// // A bar in a channel whose top is closed except for a window at one end.
    /// let block = |low: [f64; 3], high: [f64; 3]| {
    ///     ConvexPolyhedron::cuboid(DVec3::from(low), DVec3::from(high))
    /// };
    /// let walls = [
    ///     block([-1.0, -1.0, -1.0], [9.0, 4.0, 0.0])?,
    ///     block([-1.0, -1.0, 0.0], [9.0, 0.0, 3.0])?,
    ///     block([-1.0, 3.0, 0.0], [9.0, 4.0, 3.0])?,
    ///     block([-1.0, 0.0, 0.0], [0.0, 3.0, 3.0])?,
    ///     block([8.0, 0.0, 0.0], [9.0, 3.0, 3.0])?,
    ///     block([-1.0, -1.0, 3.0], [5.0, 4.0, 4.0])?,
    /// ];
    /// let channel = Solid::from_pieces(&walls)?;
    /// let bar = block([0.5, 0.5, 0.5], [2.5, 2.5, 2.5])?;
    /// let at = Pose::IDENTITY;
    /// let RemovalSearch::Found(way) = RemovalSearch::search(&bar.at(at), &channel.at(at), &RemovalOptions::default())?
    /// else {
    ///     unreachable!("the bar leaves along x, then up")
    /// };
    /// assert_eq!(way.legs.len(), 2);
    /// assert_eq!(way.legs[1].travel, f64::INFINITY);
    /// let bar = Solid::from_pieces([&bar])?;
    /// way.verify(&[bar.at(at), channel.at(at)])?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn search<A: AsSolid, B: AsSolid>(
        moving: &Placed<'_, A>,
        fixed: &Placed<'_, B>,
        options: &RemovalOptions,
    ) -> Result<Self, FreeError> {
        let a = moving.body.as_solid().map_err(QueryError::from)?.at(moving.pose);
        let b = fixed.body.as_solid().map_err(QueryError::from)?.at(fixed.pose);
        Self::search_among(&[a, b], &[1], options, None)
    }

    /// Searches for a removal path of some of several bodies. Bodies in `fixed` do not move. All others may
    /// move, alone or together, before some of them are removed.
    ///
    /// Motions are relative to a *base*, which is the first fixed body, or otherwise the largest one. Among
    /// more than two bodies, those that overlap at the start move together. For fewer than two or more than
    /// 127 bodies the answer is [`Self::NotFound`] without a search.
    ///
    /// # Errors
    /// Returns the errors of [`Self::search`], and [`FreeError::Cancelled`] after the flag is set. Overlaps of
    /// more than two bodies are not errors.
    pub fn search_among(
        bodies: &[Placed<'_, Solid>],
        fixed: &[usize],
        options: &RemovalOptions,
        cancel: Option<&AtomicBool>,
    ) -> Result<Self, FreeError> {
        if !(2..=MAX_BODIES).contains(&bodies.len()) {
            return Ok(Self::NotFound { searched: SearchWork::default() });
        }
        for (k, placed) in bodies.iter().enumerate() {
            check_is_not_rounded(placed.body.radius()).map_err(QueryError::from)?;
            if !placed.body.is_closed() {
                return Err(FreeError::Open { which: if k == 0 { "moving" } else { "fixed" } });
            }
        }
        let tolerance = largest_tolerance(bodies, options)?;
        RemovalScene::with_tolerance(bodies, tolerance).with_fixed(fixed).search(options, cancel)
    }

    /// Searches for a removal path in a scene, see [`RemovalScene::search`].
    pub(super) fn search_scene(
        scene: &RemovalScene<'_>,
        options: &RemovalOptions,
        cancel: Option<&AtomicBool>,
    ) -> Result<Self, FreeError> {
        let wrong = |d: &&DVec3| !(d.is_finite() && d.try_normalize().is_some());
        if let Some(&direction) = options.directions.iter().find(wrong) {
            return Err(QueryError::Direction { direction }.into());
        }
        if !scene.has_valid_count() {
            return Ok(Self::NotFound { searched: SearchWork::default() });
        }
        let (bodies, fixed) = (&scene.bodies, &scene.fixed);
        let tolerances = scene.blocking_pairs().map(|pair| pair.tolerance);
        let tolerance = tolerances.fold(0.0, f64::max);
        let boxes: Vec<Aabb> = bodies.iter().map(bounding_box).collect();
        let slacks = scene.blocking_pairs().map(|pair| pair.slack).filter(|slack| *slack > 0.0);
        let scale = search_scale(bodies, slacks.reduce(f64::min).unwrap_or(0.0), options.step);
        let steps = least_moves(bodies, scale.step, options.step);
        let mut pairs = Vec::new();
        for j in 1..bodies.len() {
            for i in 0..j {
                let relation = scene.relation([i, j]).0;
                let step = steps[i].min(steps[j]);
                pairs.push(BodyPair::new(
                    relation,
                    [bodies[i], bodies[j]],
                    [boxes[i], boxes[j]],
                    step,
                )?);
            }
        }
        if let [BodyPair { overlap: Some(place), .. }] = pairs[..] {
            return Err(FreeError::Overlapping { place });
        }
        let members = |list: &[usize]| {
            list.iter().filter(|&&k| k < bodies.len()).fold(0, |mask: Group, &k| mask | 1 << k)
        };
        let mask = members(fixed);
        let first_fixed = fixed.iter().copied().find(|&k| k < bodies.len());
        let base = first_fixed.unwrap_or_else(|| largest_body(bodies));
        let directions = candidate_directions(bodies, &options.directions);
        let roles = BodyRoles {
            fixed: mask | 1 << base,
            base,
            leaving: scene.leaving.as_ref().map_or(Group::MAX, |leaving| members(leaving)),
            steps,
        };
        let mut search = Search::new(pairs, roles, directions, scale, options, cancel);
        let certified = |moves: &[Move]| certified_legs(scene, moves);
        let closed =
            scene.blocking_pairs().all(|pair| pair.proven.iter().all(|b| b.body.is_closed()));
        let provable_pair = scene.blocking_pairs().next().filter(|_| bodies.len() == 2 && closed);
        let mut provable = provable_pair.is_some() && options.cells > 0;
        let fewest = options.order == Some(Order::FewestLegs);
        let (mut cells, mut proposal, mut places) =
            (None, None, RemovalOptions::FIRST_PROOF_PLACEMENTS);
        let mut legs = loop {
            let run = search.run(if provable { places } else { usize::MAX }, certified)?;
            if let SearchEnd::Found(legs) = run {
                break Some(legs);
            }
            let ended = matches!(run, SearchEnd::Ended);
            if provable {
                let enclosure = match &mut cells {
                    Some(enclosure) => enclosure,
                    none => {
                        let axes =
                            cell_axes(&wall_axes(&bodies[base], box_center(&bodies[1 - base])));
                        let both = provable_pair.map_or([bodies[0], bodies[1]], |pair| pair.proven);
                        none.insert(Enclosure::new(both, tolerance, scale.far, axes)?)
                    }
                };
                let own =
                    if ended { usize::MAX } else { RemovalOptions::CELLS_PER_PLACEMENT * places };
                match enclosure.continue_search(own.min(options.cells), cancel)? {
                    Some(EnclosureResult::Proven(proof)) => return Ok(Self::Proven(proof)),
                    Some(EnclosureResult::Way(found)) => {
                        (provable, proposal) = (false, Some(found));
                    }
                    None => (),
                }
            }
            // A path through cells may have more legs than necessary.
            if let Some(proposal) = proposal.take_if(|_| ended || !fewest) {
                let way = (&proposal[..], scale.grid, if base == 1 { 1.0 } else { -1.0 });
                if let Some(legs) = search.shortened_path(1 - base, way, certified)? {
                    break Some(legs);
                }
            }
            if ended {
                break None;
            }
            places *= 2;
        };
        // More than two bodies have too many pairs.
        if legs.is_none() && bodies.len() == 2 && search.searched.complete {
            legs = search.last_leg_in_any_direction(certified)?;
        }
        let searched = search.searched;
        Ok(match legs {
            Some(legs) => Self::Found(RemovalPath { legs, tolerance, searched }),
            None => Self::NotFound { searched },
        })
    }
}

/// Returns the tolerance of all casts: the given one, or the largest default of all pairs.
fn largest_tolerance(
    bodies: &[Placed<'_, Solid>],
    options: &RemovalOptions,
) -> Result<f64, QueryError> {
    let mut most = 0.0_f64;
    for j in 1..bodies.len() {
        for i in 0..j {
            let cast = Cast::new(bodies[i], bodies[j], DVec3::Z)?;
            most = most.max(match options.tolerance {
                // An error shows the given tolerance, not the one of the search.
                Some(given) => cast.with_tolerance(given)?.tolerance(),
                None => cast.tolerance(),
            });
        }
    }
    Ok(most)
}

fn box_volume(body: &Placed<'_, Solid>) -> f64 {
    body.body.bounds().side_lengths().element_product()
}

fn largest_body(bodies: &[Placed<'_, Solid>]) -> usize {
    let volume = |k: &usize| box_volume(&bodies[*k]);
    (0..bodies.len()).rev().max_by(|a, b| volume(a).total_cmp(&volume(b))).unwrap_or(0)
}

/// Returns the center of a body's bounding box, in the world frame.
fn box_center(body: &Placed<'_, Solid>) -> DVec3 {
    body.pose.transform_point(body.body.bounds().center())
}

fn body_size(body: &Placed<'_, Solid>) -> f64 {
    body.body.bounds().side_lengths().max_element()
}

/// Returns the lengths of a search. `slack` is the least difference of the gaps of the search and of the proofs.
fn search_scale(bodies: &[Placed<'_, Solid>], slack: f64, step: f64) -> SearchScale {
    let far = bodies.iter().map(body_size).sum::<f64>() * 2.0;
    let step = step * bodies.iter().map(body_size).fold(0.0, f64::max);
    // Without a tolerance there is no slack. The grid only has to keep sums exact.
    let off = if slack > 0.0 { (SLACK_SHARE * slack).min(0.1 * step) } else { 1e-6 * step };
    let fine = if slack > 0.0 { off / 16.0 } else { far * f64::EPSILON * 4096.0 };
    SearchScale { far, step, off, grid: power_of_two(fine) }
}

/// Returns the minimum length of a move for each body: a share of its size, or of an eighth of the largest size if
/// that is more. For two bodies it is `step` for both.
fn least_moves(bodies: &[Placed<'_, Solid>], step: f64, share: f64) -> Vec<f64> {
    let least = |body: &Placed<'_, Solid>| match bodies.len() {
        2 => step,
        _ => (share * body_size(body)).max(step * SMALL_BODY).min(step),
    };
    bodies.iter().map(least).collect()
}

/// Returns the largest power of two that does not exceed a number.
fn power_of_two(x: f64) -> f64 {
    f64::from_bits(x.max(f64::MIN_POSITIVE).to_bits() & (0x7ff << 52))
}
