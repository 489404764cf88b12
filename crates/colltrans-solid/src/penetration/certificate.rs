//! Proofs of depths, verified without a search.
//!
//! - Upper bound: a translation of the moving body, and a [`DistanceCertificate`] that the bodies are apart after it.
//! - Lower bound: a *core* inside each body, a box or a point swept by a ball. The depth of two cores is the distance
//!   from the origin to the surface of their Minkowski difference, a box swept by a ball. Several pairs of boxes prove
//!   that the bodies overlap after each translation in one of their differences ([`cover`](super::cover)).
//! - For each core, a cover proves that no facet is nearer to the box than the radius. Exact tests decide that the box
//!   is inside the body, and that no shell of the body is inside the box.
//! - Lower bound of convex bodies: an [`Enclosure`] proves the depth of the hulls of the vertices, less the length by
//!   which the hulls must be shrunk to be inside the bodies ([`shrinking_loss`]).

use std::collections::HashMap;

use glam::DVec3;

use super::cover::{BoxPair, nearest_outside};
use super::depth::depth_with_boxes;
use super::inner::InnerPair;
use super::placed_solids;
use crate::body::Solid;
use crate::cast::{Cover, SolidCast};
use crate::pair::{
    DistanceCertificate, SolidPair, least_proven_distance, pair_scene, search_nearest,
};
use crate::solve::hulls::{ConvexBody, HEIGHT_ROUNDING, HullPair};
use crate::solve::inside::shell_inside;
use crate::solve::nearest::search::{SearchEnd, facet_corners};
use crate::solve::nearest::{Apart, SolidNear};
use crate::solve::overlap::{Overlap, find_contact};
use crate::solve::scene::PairFrame;
use crate::solve::steps::SolidSteps;
use colltrans_convex::answer::{CertificateError, Enclosure};
use colltrans_convex::body::{Aabb, ConvexPolyhedron, Placed, Pose};
use colltrans_convex::cast::Cast;
use colltrans_convex::pair::Pair;
use colltrans_convex::setting::VertexPair;
use colltrans_convex::setting::error::QueryError;
use colltrans_kernel::range::with_tiny_components_zeroed;

/// Distances in noises by which the bodies are moved farther apart until that is proven.
const MARGINS: [f64; 3] = [32.0, 1024.0, 32768.0];
/// Maximum number of times that the bodies are pushed along normals of facets in contact, for each of these distances.
const MOST_PUSHES: u32 = 6;
/// Maximum number of pairs of cores in a proof. The search finds at most 25.
const MAX_CORES: usize = 32;
/// Factor above 1 that covers the rounding errors of a length.
const LENGTH_ROUNDING: f64 = 1.0 + 8.0 * f64::EPSILON;
/// Factor by which the loss of shrunk hulls is raised, above the rounding errors of its computation.
const LOSS_MARGIN: f64 = 1.01;
/// Points of a distance that only covers without a plane between facets use.
const NO_POINTS: SolidNear = SolidNear::Meeting(Overlap::Facets(0, 0));

/// A proof of the depth of two solids, verified by
/// [`SolidPenetration::verify_depth`](super::SolidPenetration::verify_depth).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct DepthCertificate {
    /// Proven lower bound in world units: after every shorter translation of the moving body the interiors have common
    /// points. It is 0 if nothing is proven.
    pub lower: f64,
    /// Proven upper bound in world units: at least the length of the translation from the pose of the moving body to
    /// `translation`.
    pub upper: f64,
    /// Translation of the pose of the moving body at which the bodies are apart, in the world.
    pub translation: DVec3,
    /// Proof that the bodies are apart there.
    pub apart: DistanceCertificate,
    /// Proof of the lower bound by parts of the moving and of the fixed body. Empty if `enclosure` proves the bound or
    /// if it is 0.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Vec::is_empty"))]
    pub cores: Vec<[InnerCore; 2]>,
    /// Proof of the lower bound for convex bodies: a surface around the origin whose corners are differences of their
    /// vertices, which are named by their positions in [`Solid::vertices`](crate::Solid::vertices).
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub enclosure: Option<Enclosure>,
}

/// A box inside a body, swept by a ball.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct InnerCore {
    /// Lowest corner of the box in the world.
    pub origin: DVec3,
    /// Lengths of the sides of the box along the axes of the world: all positive, or all 0 for a point.
    pub size: DVec3,
    /// Radius of the ball in world units.
    pub radius: f64,
    /// Proof that no facet of the body is nearer to the surface of the box than `radius`. The box is the moving body of
    /// this cover.
    pub cover: Cover<Apart>,
}

impl InnerCore {
    /// Returns the box as a body with its lowest corner at 0, and its pose; `None` if its size or place is invalid.
    fn placed_box(&self) -> Option<(ConvexPolyhedron, Pose)> {
        let size = self.size;
        let body = if size == DVec3::ZERO {
            ConvexPolyhedron::from_points(&[DVec3::ZERO])
        } else if size.min_element() > 0.0 {
            ConvexPolyhedron::cuboid(DVec3::ZERO, size)
        } else {
            return None;
        };
        Some((body.ok()?, Pose::from_translation(self.origin).ok()?))
    }

    /// Builds the proof that a box is inside a body, swept by the largest ball that is proven; `None` if the box is not
    /// proven to be inside.
    fn prove(
        [origin, size]: [DVec3; 2],
        solid: Placed<'_, Solid>,
    ) -> Result<Option<Self>, QueryError> {
        let mut core = Self { origin, size, radius: 0.0, cover: Cover::default() };
        let Some((body, pose)) = core.placed_box() else { return Ok(None) };
        let pair = <Pair<'_, Solid> as SolidPair>::between(body.at(pose), solid)?;
        let scene = pair_scene(&pair)?;
        let Some(cover) = search_nearest(&pair, &scene, SearchEnd::LEAST, true).cover else {
            return Ok(None);
        };
        let Ok(proven) = least_proven_distance(&scene, &NO_POINTS, &cover) else {
            return Ok(None);
        };
        (core.radius, core.cover) = (proven, cover);
        Ok(is_inside(&scene).then_some(core))
    }

    /// Verifies that the core is inside a body.
    fn verify(&self, solid: Placed<'_, Solid>) -> Result<(), CertificateError> {
        let (body, pose) = self.placed_box().ok_or(CertificateError::StartClaim)?;
        let pair = <Pair<'_, Solid> as SolidPair>::between(body.at(pose), solid)?;
        let scene = pair_scene(&pair)?;
        let proven = least_proven_distance(&scene, &NO_POINTS, &self.cover)?;
        if !(0.0..=proven).contains(&self.radius) {
            return Err(CertificateError::Bound { proven, claimed: self.radius });
        }
        if is_inside(&scene) { Ok(()) } else { Err(CertificateError::StartClaim) }
    }
}

/// Returns the box of translations after which the boxes of two cores overlap, and the sum of both radii.
fn difference_of_cores([moving, fixed]: &[InnerCore; 2]) -> (Aabb, f64) {
    let between = fixed.origin - moving.origin;
    let exact = Aabb { low: between - moving.size, high: between + fixed.size };
    let lengths = between.abs() + moving.size + fixed.size;
    let rounding = 4.0 * f64::EPSILON * lengths.max_element();
    (exact.expanded(-rounding), (moving.radius + fixed.radius).next_down())
}

/// Returns a lower bound of the length of a translation that separates all pairs of cores: the distance from the origin
/// to the surface of the Minkowski difference of one pair, or to the nearest point outside of all differences of boxes.
/// `None` if the cores of no pair have a common point.
fn depth_of_cores(cores: &[[InnerCore; 2]]) -> Option<f64> {
    let differences: Vec<(Aabb, f64)> = cores.iter().map(difference_of_cores).collect();
    let of_one = |(bounds, radii): &(Aabb, f64)| {
        let between = bounds.high.min(-bounds.low).min_element();
        (between >= 0.0).then(|| (between + radii).next_down())
    };
    let one = differences.iter().filter_map(of_one).max_by(f64::total_cmp)?;
    let boxes = differences.iter().map(|(bounds, _)| *bounds);
    let boxes: Vec<Aabb> = boxes.filter(|of| of.low.cmplt(of.high).all()).collect();
    Some(one.max(nearest_outside(&boxes).length() * (1.0 - 8.0 * f64::EPSILON)))
}

/// Checks whether the moving body, whose surface is apart from that of the fixed one, is inside the fixed one with all
/// points.
fn is_inside(scene: &PairFrame) -> bool {
    shell_inside(scene, true).is_some() && shell_inside(scene, false).is_none()
}

/// Computes the depth of two bodies and proves bounds of it.
pub(super) fn certified_depth(pair: &Pair<'_, Solid>) -> Result<DepthCertificate, QueryError> {
    let (found, boxes) = depth_with_boxes(pair)?;
    let UpperProof { translation, upper, apart } = prove_upper(pair, found.translation)?;
    let (mut lower, mut cores, mut enclosure) = (0.0, Vec::new(), None);
    if let Some(inner) = &found.inner {
        let [moving, fixed] = placed_solids(pair);
        let mut pairs = vec![ends_of(inner)];
        if boxes.len() > 1 {
            pairs.extend(boxes.iter().map(ends_of_boxes));
            pairs.dedup();
        }
        for [in_moving, in_fixed] in pairs {
            let proven = [InnerCore::prove(in_moving, moving)?, InnerCore::prove(in_fixed, fixed)?];
            if let [Some(moving), Some(fixed)] = proven {
                cores.push([moving, fixed]);
            }
        }
        lower = depth_of_cores(&cores).map_or(0.0, |depth| swept_depth(pair, depth));
    } else if found.lower > 0.0
        && let Some(convex) = HullPair::of_convex(&pair.bodies)
    {
        let surface = Pair { bodies: convex.hulls }.depth()?.enclosure;
        if let Ok(proven) = enclosed_depth(&convex, &surface) {
            let vertex = |k: usize, v: u32| Some(convex.surfaces[k].body.solid_vertex(v));
            (lower, enclosure) = (swept_depth(pair, proven), with_vertices(surface, vertex));
        }
    }
    let lower = lower.clamp(0.0, upper);
    Ok(DepthCertificate { lower, upper, translation, apart, cores, enclosure })
}

/// Returns the lowest corners and the sizes of two boxes.
fn ends_of_boxes(boxes: &BoxPair) -> [[DVec3; 2]; 2] {
    boxes.map(|of| [of.low, of.high - of.low])
}

/// Returns the lowest corner and the size of a box in each body; those of balls are points.
fn ends_of(inner: &InnerPair) -> [[DVec3; 2]; 2] {
    match *inner {
        InnerPair::Balls { center, .. } => [[center, DVec3::ZERO]; 2],
        InnerPair::Boxes { moving, fixed } => ends_of_boxes(&[moving, fixed]),
    }
}

/// Adds the radii of rounded bodies to the depth of parts of their cores, rounded down.
fn swept_depth(pair: &Pair<'_, Solid>, depth: f64) -> f64 {
    match pair.bodies.core_gap_bounds(0.0)[0] {
        radii if radii > 0.0 && depth >= 0.0 => (depth + radii).next_down(),
        _ => depth,
    }
}

/// Verifies both bounds, and returns their difference.
pub(super) fn verify_depth(
    pair: &Pair<'_, Solid>,
    proof: &DepthCertificate,
) -> Result<f64, CertificateError> {
    let DepthCertificate { lower, upper, translation, apart, cores, enclosure } = proof;
    let (lower, upper) = (*lower, *upper);
    let [start, fixed] = placed_solids(pair);
    let proven = length_above(*translation - start.pose.translation());
    if upper.is_nan() || upper < proven {
        return Err(CertificateError::Bound { proven, claimed: upper });
    }
    let pose = start.pose.with_translation(*translation);
    let pose = pose.map_err(|_| CertificateError::StartClaim)?;
    if apart.lower <= 0.0 {
        return Err(CertificateError::Bound { proven: 0.0, claimed: apart.lower });
    }
    Pair::new(start.body.at(pose), fixed)?.verify(apart)?;
    let proven = match (&cores[..], enclosure) {
        ([], None) => 0.0,
        (cores, None) if cores.len() > MAX_CORES => return Err(CertificateError::StartClaim),
        (cores, None) => {
            for [in_moving, in_fixed] in cores {
                in_moving.verify(start)?;
                in_fixed.verify(fixed)?;
            }
            depth_of_cores(cores).map_or(0.0, |depth| swept_depth(pair, depth))
        }
        ([], Some(surface)) => {
            let convex = HullPair::of_convex(&pair.bodies).ok_or(CertificateError::StartClaim)?;
            let numbers = convex.surfaces.map(|surface| {
                let named = surface.body.hull.input_indices().iter().zip(0..);
                named.map(|(known, v)| (known.0, v)).collect::<HashMap<u32, u32>>()
            });
            let vertex = |k: usize, v: u32| numbers[k].get(&v).copied();
            let surface = with_vertices(surface.clone(), vertex);
            let surface = surface.ok_or(CertificateError::StartClaim)?;
            swept_depth(pair, enclosed_depth(&convex, &surface)?)
        }
        (_, Some(_)) => return Err(CertificateError::StartClaim),
    };
    if !(0.0..=proven).contains(&lower) {
        return Err(CertificateError::Bound { proven, claimed: lower });
    }
    if lower > upper {
        return Err(CertificateError::Order { lower, upper });
    }
    Ok(upper - lower)
}

/// Returns an upper bound of the length of a difference of two positions.
fn length_above(between: DVec3) -> f64 {
    between.length() * LENGTH_ROUNDING
}

/// A translation after which the bodies are apart.
struct UpperProof {
    translation: DVec3,
    /// Upper bound of the length of the displacement.
    upper: f64,
    apart: DistanceCertificate,
}

impl UpperProof {
    /// Builds the proof for a displacement of the moving body; `None` if it does not prove that the bodies are apart.
    fn new(pair: &Pair<'_, Solid>, displacement: DVec3) -> Result<Option<Self>, QueryError> {
        let Some(displaced) = displaced(pair, displacement)? else { return Ok(None) };
        let (_, apart) = displaced.certified_distance()?;
        let translation = displaced.bodies.translations[0];
        let upper = length_above(translation - pair.bodies.translations[0]);
        Ok((apart.lower > 0.0).then_some(Self { translation, upper, apart }))
    }
}

/// Returns the pair after a displacement of the moving body; `None` if the displacement is out of range.
fn displaced<'a>(
    pair: &Pair<'a, Solid>,
    displacement: DVec3,
) -> Result<Option<Pair<'a, Solid>>, QueryError> {
    let [moving, fixed] = placed_solids(pair);
    let pose = moving.pose.translated_by(with_tiny_components_zeroed(displacement));
    pose.ok().map(|pose| Pair::new(moving.body.at(pose), fixed)).transpose()
}

/// Finds a translation after which the bodies are proven to be apart: the given one, made slightly longer, or an exit.
/// Bodies that touch there are pushed along the normals of the facets in contact.
fn prove_upper(pair: &Pair<'_, Solid>, way: DVec3) -> Result<UpperProof, QueryError> {
    let scene = pair_scene(pair)?;
    if let Some(proof) = prove_near(pair, &scene, way)? {
        return Ok(proof);
    }
    let directions = exit_directions(&scene, way);
    let mut exits: Vec<DVec3> = directions.into_iter().filter_map(|way| exit(pair, way)).collect();
    exits.sort_by(|v, w| v.length().total_cmp(&w.length()));
    // Beyond their boxes the bodies are apart.
    let [p, q] = [&scene.moving, &scene.fixed].map(|side| {
        let facets = 0..side.solid.triangles().len();
        Aabb::from_points(facets.flat_map(|t| facet_corners(side, t)))
    });
    let [ahead, behind] = [q.high - p.low, q.low - p.high];
    let along_axes = (0..3).flat_map(|k| [ahead[k], behind[k]].map(|by| DVec3::AXES[k] * by));
    let beyond = along_axes.min_by(|v, w| v.length().total_cmp(&w.length()));
    for way in exits.into_iter().chain(beyond) {
        if let Some(proof) = prove_near(pair, &scene, way)? {
            return Ok(proof);
        }
    }
    let reason = "the bodies are not proven to be apart after any translation".into();
    Err(QueryError::NotASolid { reason })
}

/// Returns the displacement of the moving body to the end of contact along a direction; `None` if there is none.
fn exit(pair: &Pair<'_, Solid>, direction: DVec3) -> Option<DVec3> {
    let unit = with_tiny_components_zeroed(direction.try_normalize()?);
    let [moving, fixed] = placed_solids(pair);
    Some(unit * Cast::new(moving, fixed, unit).ok()?.exit()?.upper)
}

/// Proves that the bodies are apart after a displacement or a slightly different one; `None` if none is proven.
fn prove_near(
    pair: &Pair<'_, Solid>,
    scene: &PairFrame,
    displacement: DVec3,
) -> Result<Option<UpperProof>, QueryError> {
    let outwards = displacement.normalize_or_zero();
    for margin in MARGINS.map(|noises| noises * scene.noise) {
        let mut by = displacement + outwards * margin;
        for _ in 0..MOST_PUSHES {
            if let Some(proof) = UpperProof::new(pair, by)? {
                return Ok(Some(proof));
            }
            let Some(displaced) = displaced(pair, by)? else { break };
            let place = find_contact(&pair_scene(&displaced)?, &mut SolidSteps::default());
            let Some(Overlap::Facets(f, g)) = place else { break };
            let [moving, fixed] = facet_normals(scene, [f, g]);
            let Some(push) = (fixed - moving).try_normalize() else { break };
            by += push * margin;
        }
    }
    Ok(None)
}

/// Returns unit normals of a facet of the moving and one of the fixed body; 0 for a facet without area.
fn facet_normals(scene: &PairFrame, [f, g]: [u32; 2]) -> [DVec3; 2] {
    let corners =
        [facet_corners(&scene.moving, f as usize), facet_corners(&scene.fixed, g as usize)];
    corners.map(|[a, b, c]| (b - a).cross(c - a).normalize_or_zero())
}

/// Returns directions of exits: the given one, the axes of the world and, if the bodies meet, the normals of facets in
/// contact.
fn exit_directions(scene: &PairFrame, first: DVec3) -> Vec<DVec3> {
    let mut directions = vec![first];
    directions.extend(DVec3::AXES.iter().flat_map(|axis| [*axis, -*axis]));
    if let Some(Overlap::Facets(f, g)) = find_contact(scene, &mut SolidSteps::default()) {
        let [moving, fixed] = facet_normals(scene, [f, g]);
        directions.extend([-moving, fixed]);
    }
    directions
}

/// Replaces the vertices of an enclosure; `None` if one has no replacement.
fn with_vertices(
    surface: Enclosure,
    vertex: impl Fn(usize, u32) -> Option<u32>,
) -> Option<Enclosure> {
    let pair = |pair: &VertexPair| {
        let [p, q] = pair.indices();
        Some(VertexPair::from_indices(vertex(0, p)?, vertex(1, q)?))
    };
    let pairs = surface.pairs.iter().map(pair).collect::<Option<_>>()?;
    Some(Enclosure { pairs, ..surface })
}

/// Returns a lower bound of the depth of two convex solids, proven by an enclosure of their hulls.
///
/// # Errors
/// Returns an error if the enclosure proves no positive depth of the hulls.
fn enclosed_depth(convex: &HullPair<'_>, surface: &Enclosure) -> Result<f64, CertificateError> {
    let proven = Pair { bodies: convex.hulls }.verify(surface)?;
    let loss: f64 = convex.surfaces.iter().map(|of| shrinking_loss(of.solid, of.body)).sum();
    let lower = (proven - loss * LOSS_MARGIN).next_down();
    if lower > 0.0 { Ok(lower) } else { Err(CertificateError::StartClaim) }
}

/// Returns the length by which the hull of a solid moves inwards at most until it is inside the solid. Infinite if the
/// mean `c` of the vertices is not inside.
///
/// A facet with the normal `n` is above the height `h = min n.v` of its corners. If all vertices are below `h + e` and
/// `c` is at `h - r`, `r > 0`, then the facet does not meet the interior of the hull shrunk towards `c` by the share
/// `e / (e + r)`. With the largest share of a facet, the shrunk hull is inside the solid.
fn shrinking_loss(solid: &Solid, body: &ConvexBody) -> f64 {
    let (vertices, hull) = (solid.vertices(), &body.hull);
    let rounding = HEIGHT_ROUNDING * solid.reach();
    let center = vertices.iter().sum::<DVec3>() / vertices.len() as f64;
    let share = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|v| vertices[v as usize]);
        let Some(normal) = (b - a).cross(c - a).try_normalize() else { return f64::INFINITY };
        let height = [a, b, c].map(|p| normal.dot(p)).into_iter().fold(f64::INFINITY, f64::min);
        let highest = normal.dot(hull.vertices()[hull.support(normal).index()]) + hull.hull_error();
        let (excess, below) = (highest - height + rounding, height - normal.dot(center) - rounding);
        if below > 0.0 { excess.max(0.0) / (excess.max(0.0) + below) } else { f64::INFINITY }
    };
    let most = solid.triangles().iter().map(share).fold(0.0, f64::max);
    let radius = vertices.iter().map(|v| (*v - center).length()).fold(0.0, f64::max);
    most * radius
}

#[cfg(test)]
mod tests {
    use super::*;

    /// No facet of the cavity is near the surface of a box around it.
    #[test]
    fn core_around_a_cavity_is_not_inside() {
        let cuboid = |low: f64, high: f64| {
            let body = ConvexPolyhedron::cuboid(DVec3::splat(low), DVec3::splat(high));
            Solid::from_convex(&body.expect("a box")).expect("a solid")
        };
        let [outer, cavity] = [cuboid(0.0, 8.0), cuboid(3.5, 4.5)];
        let first = outer.vertices().len() as u32;
        let vertices = [outer.vertices(), cavity.vertices()].concat();
        let inwards = cavity.triangles().iter().map(|t| [t[2], t[1], t[0]].map(|v| v + first));
        let triangles: Vec<[u32; 3]> = outer.triangles().iter().copied().chain(inwards).collect();
        let hollow = Solid::from_mesh(&vertices, &triangles).expect("a box with a cavity");
        for (low, high, solid, is_core) in [
            (3.0, 5.0, &outer, true),
            (3.0, 5.0, &hollow, false),
            (0.5, 3.25, &hollow, true),
            (3.0, 4.0, &hollow, false),
            (3.75, 4.0, &hollow, false),
            (7.0, 9.0, &outer, false),
            (-1.0, 9.0, &outer, false),
            (4.0, 4.0, &hollow, false),
            (2.0, 2.0, &hollow, true),
        ] {
            let ends = [DVec3::splat(low), DVec3::splat(high - low)];
            let core = InnerCore::prove(ends, solid.at(Pose::IDENTITY)).expect("a query");
            assert_eq!(core.is_some(), is_core, "{low} to {high}");
            if let Some(core) = core {
                core.verify(solid.at(Pose::IDENTITY)).expect("a proof");
            }
        }
    }
}
