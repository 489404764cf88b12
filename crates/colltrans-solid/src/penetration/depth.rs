//! The depth of two overlapping solids: the length of the shortest translation after which their interiors are
//! disjoint.
//!
//! - Upper bound: the length of a translation after which the exact test finds no overlap. The translations tested are
//!   exits along directions (axes of the world, the line of the centres, normals of facets near the overlap), heights
//!   between parallel facets, and points of a ball. From the shortest of them the moving body slides back towards its
//!   place: each cast ends at a plane, and the next one runs along the planes met, until no way is shorter.
//! - Lower bound: convex pieces inside both bodies ([`inner`](super::inner), [`cover`](super::cover)). For convex bodies, the depth of their
//!   hulls less how far bodies and hulls differ: a hull scaled by `1 - dent / inner_radius` about a point inside is
//!   within the body.
//! - Rounded bodies: cores whose distance is at most `d` are at least `r + s - d` deep, the sum of the radii less `d`.
//!
//! Proofs: `docs/theory/depth-of-solids.md`.

use glam::DVec3;

use super::cells::{common_box, near_facets};
use super::cover::{BoxPair, cover_bound};
use super::inner::{InnerPair, find_inner_pair};
use super::prepared::PreparedPair;
use super::surface::{core_distance, core_distances};
use super::{ROUNDING, placed_solids};
use crate::body::Solid;
use crate::cast::{SolidCast, SolidOptions};
use crate::pair::pair_scene;
use crate::solve::hulls::HullPair;
use crate::solve::nearest::triangle::Corners;
use crate::solve::overlap::{Overlap, find_overlap, is_overlap};
use crate::solve::projected::Projected;
use crate::solve::scene::PairFrame;
use crate::solve::steps::SolidSteps;
use colltrans_convex::answer::Clearance;
use colltrans_convex::cast::Cast;
use colltrans_convex::pair::Pair;
use colltrans_convex::setting::error::QueryError;
use colltrans_kernel::range::with_tiny_components_zeroed;

/// Maximum number of directions whose exits are computed.
const MAX_DIRECTIONS: usize = 24;
/// Cosine from which on two directions count as equal.
const SAME_DIRECTION: f64 = 0.999;
/// Sine up to which two facets count as parallel.
const PARALLEL: f64 = 1e-9;
/// Maximum number of planes of each body, for each direction, whose differences of heights are candidates.
const MAX_PLANES: usize = 16;
/// Maximum number of these candidates that are tested, the shortest first.
const MAX_HEIGHTS: usize = 24;
/// Addition to a height for rounding errors, in noises.
const HEIGHT_MARGIN: f64 = 16.0;
/// Number of exits from which the body slides back.
const SLIDES: usize = 4;
/// Maximum number of casts of a slide.
const MAX_CASTS: u32 = 24;
/// Tolerance of these casts, in noises.
const SLIDE_TOLERANCE: f64 = 8.0;
/// Number of points of the cube around the ball of the shortest translation. Those in the ball are tested.
const SAMPLES: u32 = 48;
/// Distances from the planes met at which the end of a slide is tested, in noises.
const CLEARANCES: [f64; 6] = [0.0, 4.0, 16.0, 64.0, 512.0, 4096.0];
/// Maximum number of pairs of facets that are tested before the search of an overlap.
const MAX_WITNESSES: usize = 8;
/// Part of the noise for each unit of length of the radii.
const NOISE_OF_RADII: f64 = 16.0 * f64::EPSILON;
/// Relative margin for rounding errors of the depth of hulls.
const HULL_ROUNDING: f64 = 1e-12;

/// Bounds of the depth of two solids.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SolidDepth {
    /// Lower bound in world units, rounded down: after every shorter translation the interiors have common points.
    pub lower: f64,
    /// Upper bound in world units, rounded up: the length of the shortest translation that was found. A shorter one may
    /// exist. It is infinite only if translations of this length are out of range.
    pub upper: f64,
    /// Unit vector of [`Self::translation`]; 0 if no overlap was found.
    pub direction: DVec3,
    /// Translation of the moving body, in the world, that separates the interiors. The exact test finds no overlap if
    /// the pose of the moving body has the sum of its translation and of this one, as computed in `f64`.
    pub translation: DVec3,
    /// The deepest convex bodies found inside both. The lower bound is their depth, or more if it takes several of them.
    /// `None` if the bound is 0, that of convex hulls, or that of rounded bodies whose cores do not overlap.
    pub inner: Option<InnerPair>,
}

impl SolidDepth {
    /// Depth of bodies whose interiors have no common point.
    const ZERO: Self = Self {
        lower: 0.0,
        upper: 0.0,
        direction: DVec3::ZERO,
        translation: DVec3::ZERO,
        inner: None,
    };

    /// Returns `[lower, upper]`.
    pub const fn bounds(&self) -> [f64; 2] {
        [self.lower, self.upper]
    }
}

/// Computes bounds of the depth of two bodies, and the boxes inside both if it takes several to prove the lower bound.
pub(super) fn depth_with_boxes(
    pair: &Pair<'_, Solid>,
) -> Result<(SolidDepth, Vec<BoxPair>), QueryError> {
    prepared_depth(&PreparedPair::new(pair)?)
}

/// Computes [`depth_with_boxes`] of a prepared pair.
pub(super) fn prepared_depth(
    prepared: &PreparedPair,
) -> Result<(SolidDepth, Vec<BoxPair>), QueryError> {
    let PreparedPair { pair, scene, .. } = prepared;
    let is_round = pair.moving().radius() + pair.fixed().radius() > 0.0;
    let has_interior = |body: &Solid| body.has_interior() || body.radius() > 0.0;
    let overlaps = has_interior(pair.moving())
        && has_interior(pair.fixed())
        && if is_round { !are_separated(pair)? } else { prepared.overlap().is_some() };
    if !overlaps {
        return Ok((SolidDepth::ZERO, Vec::new()));
    }
    let hulls = bounds_of_hulls(pair);
    let mut found = Shortest::new(pair, scene);
    found.try_box_exits(scene);
    if let Some((_, translation)) = hulls {
        let outwards = translation.normalize_or_zero();
        found.accept_near(translation, outwards);
    }
    let is_final = hulls.is_some_and(|(lower, _)| found.length <= lower * (1.0 + 1e-9));
    if !is_final {
        found.search(scene);
    }
    let inner = if hulls.is_some() { None } else { find_inner_pair(pair, scene, found.length) };
    let mut boxes = Vec::new();
    let lower = match (hulls, &inner) {
        (Some((lower, _)), _) => lower,
        (None, Some(inner)) if found.radii > 0.0 => inner.depth(),
        (None, Some(inner)) => {
            let (bound, pairs) = cover_bound(&mut found, inner);
            boxes = pairs;
            inner.depth().max(bound)
        }
        (None, None) if found.radii > 0.0 => found.bound_of_balls()?,
        (None, None) => 0.0,
    };
    let depth = SolidDepth {
        lower: lower.min(found.length),
        upper: found.length,
        translation: found.translation,
        direction: found.translation.normalize_or_zero(),
        inner,
    };
    Ok((depth, boxes))
}

/// Checks whether the interiors of two bodies have no common point: exactly for solids, and if the distance is certainly
/// positive for rounded ones.
fn are_separated(pair: &Pair<'_, Solid>) -> Result<bool, QueryError> {
    if pair.moving().radius() + pair.fixed().radius() > 0.0 {
        return Ok(pair.distance()?.lower > 0.0);
    }
    Ok(find_overlap(&pair_scene(pair)?, &mut SolidSteps::default()).is_none())
}

/// The shortest translation found that separates two bodies.
pub(super) struct Shortest<'p, 'a> {
    pub(super) pair: &'p Pair<'a, Solid>,
    /// Bound of rounding errors of a coordinate, also of the poses in the world.
    pub(super) noise: f64,
    /// Sum of the radii of both bodies.
    radii: f64,
    pub(super) length: f64,
    translation: DVec3,
    /// Facets that showed overlaps after other translations, the last one first. They often show the next overlap, too.
    witnesses: Vec<Overlap>,
}

impl<'p, 'a> Shortest<'p, 'a> {
    fn new(pair: &'p Pair<'a, Solid>, scene: &PairFrame) -> Self {
        let [moving, fixed] = pair.bodies.translations.map(|t| t.abs().max_element());
        let radii = pair.moving().radius() + pair.fixed().radius();
        let noise = scene.noise.max(f64::EPSILON * moving.max(fixed)) + NOISE_OF_RADII * radii;
        let (length, translation, witnesses) = (f64::INFINITY, DVec3::ZERO, Vec::new());
        Self { pair, noise, radii, length, translation, witnesses }
    }

    /// Returns the pair after a translation of the moving body; `None` if that is out of range.
    pub(super) fn displaced(&self, by: DVec3) -> Option<Pair<'a, Solid>> {
        let [moving, fixed] = placed_solids(self.pair);
        let pose = moving.pose.with_translation(moving.pose.translation() + by).ok()?;
        Pair::new(moving.body.at(pose), fixed).ok()
    }

    /// Checks whether a translation separates the bodies and is shorter than those known, and stores it.
    fn accept(&mut self, by: DVec3) -> bool {
        let Some(pair) = self.displaced(by) else { return false };
        let moved = pair.bodies.translations[0] - self.pair.bodies.translations[0];
        let length = by.length().max(moved.length()) * (1.0 + ROUNDING);
        let is_shorter = length < self.length && self.is_separated(&pair).unwrap_or(false);
        if is_shorter {
            (self.length, self.translation) = (length, by);
        }
        is_shorter
    }

    /// Checks [`are_separated`] for the pair after a translation.
    fn is_separated(&mut self, pair: &Pair<'_, Solid>) -> Result<bool, QueryError> {
        if self.radii > 0.0 {
            return are_separated(pair);
        }
        let scene = pair_scene(pair)?;
        if let Some(k) = self.witnesses.iter().position(|place| is_overlap(&scene, *place)) {
            self.witnesses[..=k].rotate_right(1);
            return Ok(false);
        }
        let found = find_overlap(&scene, &mut SolidSteps::default());
        if let Some(place @ Overlap::Facets(..)) = found {
            self.witnesses.insert(0, place);
            self.witnesses.truncate(MAX_WITNESSES);
        }
        Ok(found.is_none())
    }

    /// Accepts a translation or one that is longer by some noises in a direction.
    pub(super) fn accept_near(&mut self, by: DVec3, outwards: DVec3) -> bool {
        CLEARANCES.iter().any(|noises| self.accept(by + outwards * (noises * self.noise)))
    }

    /// Tries the exits of the boxes of both bodies along the axes of the world. No other test is needed for these.
    fn try_box_exits(&mut self, scene: &PairFrame) {
        let [moving, fixed] = Projected::root_bounds(scene).map(|projected| projected.bounds);
        for (k, axis) in DVec3::AXES.into_iter().enumerate() {
            let margin = self.radii + 16.0 * self.noise;
            self.accept(axis * (fixed.high[k] - moving.low[k] + margin));
            self.accept(-axis * (moving.high[k] - fixed.low[k] + margin));
        }
    }

    /// Returns a lower bound of the depth of rounded bodies, from balls around the nearest points of their cores.
    ///
    /// The interior of a body without radius may be far from a point of its surface. There the search takes a point
    /// inside, next to the surface, and the ball of the other body around its nearest point.
    fn bound_of_balls(&self) -> Result<f64, QueryError> {
        let nearest = core_distance(self.pair)?;
        let bound = |distance: f64| ((self.radii - distance) * (1.0 - ROUNDING)).max(0.0);
        let bodies = placed_solids(self.pair);
        let Some(plain) = bodies.iter().position(|solid| solid.body.radius() == 0.0) else {
            return Ok(bound(nearest.upper));
        };
        let (solid, other) = (bodies[plain], bodies[1 - plain]);
        let corners = solid.body.triangles()[nearest.triangles[plain] as usize];
        let [a, b, c] =
            corners.map(|v| solid.pose.transform_point(solid.body.vertices()[v as usize]));
        let Some(outwards) = (b - a).cross(c - a).try_normalize() else { return Ok(0.0) };
        let on_surface = [nearest.on_moving, nearest.on_fixed][plain];
        // The nearest point may be at an edge of the facet.
        let inwards = ((a + b + c) / 3.0 - on_surface).normalize_or_zero();
        let distance = |solid, at| Some(*core_distances(solid, &[at]).ok()?.first()?);
        let bounds = CLEARANCES.iter().skip(1).filter_map(|noises| {
            let at = on_surface + (inwards - outwards * 0.25) * (noises * self.noise);
            distance(solid, at).filter(|found| found.is_inside)?;
            Some(bound(distance(other, at)?.upper))
        });
        Ok(bounds.fold(0.0, f64::max))
    }

    /// Searches shorter translations.
    fn search(&mut self, scene: &PairFrame) {
        let room = common_box(scene).expanded(self.radii);
        let facets = [true, false].map(|moving| near_facets(scene, scene.side(moving), &room));
        let normals = facets.each_ref().map(|facets| normals_and_areas(facets));
        let [moving, fixed] = Projected::root_bounds(scene).map(|side| side.bounds.center());
        let directions = candidate_directions(moving - fixed, &normals);
        let mut exits = Vec::new();
        for &direction in &directions {
            let Some(exit) = self.exit(direction) else { continue };
            self.accept_near(direction * exit, direction);
            exits.push((exit, direction));
        }
        for &direction in &directions {
            self.try_heights(direction, &facets, &normals);
        }
        exits.sort_by(|f, g| f.0.total_cmp(&g.0));
        let best = self.translation;
        self.slide_back(best);
        for (exit, direction) in exits.into_iter().take(SLIDES) {
            self.slide_back(direction * exit);
        }
        for k in 1..=SAMPLES {
            let place = [2, 3, 5].map(|base| 2.0 * radical_inverse(k, base) - 1.0);
            let by = DVec3::from_array(place) * self.length;
            if self.accept(by) {
                self.slide_back(by);
            }
        }
    }

    /// Computes the exit along a direction, a length; `None` if the bodies never meet.
    fn exit(&self, direction: DVec3) -> Option<f64> {
        let [moving, fixed] = placed_solids(self.pair);
        let exit = Cast::new(moving, fixed, direction).ok()?.exit()?;
        Some(exit.upper.max(0.0))
    }

    /// Tries the distances along a direction between the facets of the moving body that face against it and those of
    /// the fixed body that face along it. After the shortest one that separates the bodies, they may meet again.
    fn try_heights(
        &mut self,
        direction: DVec3,
        facets: &[Vec<Corners>; 2],
        normals: &[Vec<DVec3>; 2],
    ) {
        let heights = |body: usize, along: DVec3| {
            let is_parallel =
                |n: &DVec3| n.dot(along) > 0.0 && n.cross(along).length() <= PARALLEL * n.length();
            let all = facets[body].iter().zip(&normals[body]);
            let all = all.filter(|(_, normal)| is_parallel(normal));
            let mut heights: Vec<f64> = all.map(|([a, ..], _)| direction.dot(*a)).collect();
            heights.sort_by(f64::total_cmp);
            heights.dedup_by(|f, g| *f - *g <= 8.0 * self.noise);
            heights
        };
        let (bottoms, tops) = (heights(0, -direction), heights(1, direction));
        let bottoms = bottoms.iter().take(MAX_PLANES);
        let tops = || tops.iter().rev().take(MAX_PLANES);
        let mut ways: Vec<f64> = bottoms
            .flat_map(|bottom| tops().map(move |top| top - bottom))
            .map(|way| way + self.radii)
            .filter(|way| 0.0 < *way && *way < self.length)
            .collect();
        ways.sort_by(f64::total_cmp);
        let margin = HEIGHT_MARGIN * self.noise;
        for way in ways.into_iter().take(MAX_HEIGHTS) {
            if self.accept(direction * way) || self.accept(direction * (way + margin)) {
                return self.slide_back(direction * way);
            }
        }
    }

    /// Moves the separated body towards its place, along the planes that it meets, until no way is shorter. Accepts the
    /// end.
    fn slide_back(&mut self, from: DVec3) {
        let mut at = from;
        let mut normals: Vec<DVec3> = Vec::new();
        for _ in 0..MAX_CASTS {
            let way = way_back(at, &normals);
            if way.length() <= PARALLEL * at.length() {
                break;
            }
            let Some((share, normal)) = self.cast_back(at, way) else { break };
            if share * way.length() > 64.0 * self.noise {
                at += way * share;
                normals.clear();
            }
            normals.extend(normal);
        }
        let outwards = normals.iter().fold(DVec3::ZERO, |sum, normal| sum - *normal);
        self.accept_near(at, outwards);
        self.accept_near(at, at.normalize_or_zero());
    }

    /// Casts the displaced body along a way. Returns the share of the way before the next contact, and its normal.
    fn cast_back(&self, at: DVec3, way: DVec3) -> Option<(f64, Option<DVec3>)> {
        let displaced = self.displaced(at)?.bodies;
        let options = SolidOptions::default()
            .with_tolerance(SLIDE_TOLERANCE * self.noise)
            .with_overlapping(false);
        let cast = Cast::new(displaced.moving_placed(), displaced.fixed_placed(), way).ok()?;
        match cast.with_options(options).ok()?.clearance().ok()? {
            Clearance::Blocked { distance, contact } if distance < 1.0 => {
                Some((distance, Some(contact.normal)))
            }
            Clearance::Overlapping(_) => None,
            _ => Some((1.0, None)),
        }
    }
}

/// Returns the shortest vector from `at` to the nearest point to the origin that the planes with these normals leave:
/// the projection of `-at` to the cone of the vectors that have no positive component along a normal.
fn way_back(at: DVec3, normals: &[DVec3]) -> DVec3 {
    let back = -at;
    let along = |normal: &DVec3| back - *normal * normal.dot(back);
    let pairs = (0..normals.len()).flat_map(|i| (0..i).map(move |j| [i, j]));
    let edges = pairs.filter_map(|[i, j]| {
        let edge = normals[i].cross(normals[j]).try_normalize()?;
        Some(edge * edge.dot(back))
    });
    let ways = std::iter::once(back).chain(normals.iter().map(along)).chain(edges);
    let is_free = |way: &DVec3| normals.iter().all(|n| n.dot(*way) <= PARALLEL * back.length());
    let best = ways.filter(is_free).max_by(|v, w| v.length().total_cmp(&w.length()));
    let best = best.unwrap_or(DVec3::ZERO);
    with_tiny_components_zeroed(best / at.length().max(f64::MIN_POSITIVE)) * at.length()
}

/// Returns the normals of facets, not normalised: their lengths are twice the areas.
fn normals_and_areas(facets: &[Corners]) -> Vec<DVec3> {
    facets.iter().map(|[a, b, c]| (*b - *a).cross(*c - *a)).collect()
}

/// Returns different directions, as unit vectors: the line of the centres, the axes of the world, and the normals of
/// the largest facets, outwards from the fixed body.
fn candidate_directions(line: DVec3, normals: &[Vec<DVec3>; 2]) -> Vec<DVec3> {
    let mut near: Vec<DVec3> =
        normals[0].iter().map(|normal| -*normal).chain(normals[1].iter().copied()).collect();
    near.sort_by(|f, g| g.length_squared().total_cmp(&f.length_squared()));
    let axes = DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]);
    let mut directions: Vec<DVec3> = Vec::new();
    for direction in axes.chain([line]).chain(near) {
        let Some(unit) = direction.try_normalize() else { continue };
        if directions.len() >= MAX_DIRECTIONS {
            break;
        }
        let unit = with_tiny_components_zeroed(unit);
        if directions.iter().all(|other| other.dot(unit) < SAME_DIRECTION) {
            directions.push(unit);
        }
    }
    directions
}

/// Returns the digits of a number in a base behind the point, in reverse order: a term of the Halton sequence.
pub(super) fn radical_inverse(mut number: u32, base: u32) -> f64 {
    let (mut sum, mut share) = (0.0, 1.0);
    while number > 0 {
        share /= f64::from(base);
        sum += share * f64::from(number % base);
        number /= base;
    }
    sum
}

/// Returns a lower bound of the depth of convex bodies that are not rounded, and the translation of their hulls. `None`
/// if a body is not convex, or the hulls prove nothing.
fn bounds_of_hulls(pair: &Pair<'_, Solid>) -> Option<(f64, DVec3)> {
    if pair.moving().radius() + pair.fixed().radius() > 0.0 {
        return None;
    }
    let convex = HullPair::of_convex(&pair.bodies)?;
    let found = Pair { bodies: convex.hulls }.depth().ok()?;
    let [mut loss, mut excess] = [0.0, 0.0];
    for (surface, solid) in convex.surfaces.iter().zip([pair.moving(), pair.fixed()]) {
        let body = surface.body;
        let diameter = solid.bounds().side_lengths().length();
        loss += body.dent_share()? * diameter * 1.01;
        excess += body.dent * 1.01;
    }
    let lower = (found.lower - loss) * (1.0 - HULL_ROUNDING);
    (lower > 0.0).then(|| (lower, found.direction * (found.upper + excess)))
}
