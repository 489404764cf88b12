//! Contacts between parts (*liaisons*).
//!
//! Two facets are in contact if their normals are nearly opposite and they lie within `reach` of each other somewhere
//! in their common projection along the first normal. Both sides of a curved fit are tessellated differently;
//! therefore the normals need only be nearly opposite, and the reach is the tolerance. Coplanar facets are combined
//! into faces (module `face`). The intersection of two coplanar faces of many facets is computed by a sweep, that of
//! other faces from their pairs of facets.
//!
//! The area of a contact is the sum of clipped pieces, and its rounding error is bounded (`area_error_bound`). The
//! decision whether facets are in contact, within 25 degrees and `reach`, is subject to rounding.
//!
//! Notation: `n` is the outward unit normal of the first part's facet; it points from the first part to the second.

mod face;

use colltrans::Solid;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::bodies::Bodies;
use crate::boxes::{BoxTree, value_range};
use crate::error::AssemblyError;
use crate::watch::{Stage, Watch};
use colltrans::Aabb;

use face::{Face, Swept, twice_area};

/// Minimum cosine between a normal and the reversed other one in a contact: 25 degrees, about the angle between
/// neighbouring facets of a cylinder with 14 sides.
const MIN_OPPOSITE_COSINE: f64 = 0.906;

/// Two flat faces in contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Patch {
    /// Unit normal of the first part's face. It points from the first part to the second.
    pub normal: DVec3,
    /// Reversed unit normal of the second part's face. It points from the first part to the second.
    pub other_normal: DVec3,
    /// Area of the common projection along `normal`, of the facets in contact.
    pub area: f64,
    /// Bound on the rounding error of `area`.
    pub area_error: f64,
    /// Centroid of the area in the world frame, rounded.
    pub center: DVec3,
}

/// Two parts in contact.
#[derive(Debug, Clone, PartialEq)]
pub struct Liaison {
    /// Indices of the parts, the smaller first.
    pub parts: [usize; 2],
    /// The faces in contact.
    pub patches: Vec<Patch>,
}

impl Liaison {
    /// Returns the area of contact.
    pub fn area(&self) -> f64 {
        self.patches.iter().map(|p| p.area).sum()
    }

    /// Returns a lower and an upper bound of the exact area of these patches.
    pub fn area_bounds(&self) -> [f64; 2] {
        let (area, most) = (self.area(), self.patches.len() as f64);
        let error: f64 = self.patches.iter().map(|p| p.area_error).sum();
        let error = 1.01 * (error + most * f64::EPSILON * area);
        [(area - error).next_down().max(0.0), (area + error).next_up()]
    }

    /// Returns the centroid of the contact, weighted by area.
    pub fn centroid(&self) -> DVec3 {
        let sum: DVec3 = self.patches.iter().map(|p| p.center * p.area).sum();
        sum / self.area()
    }
}

/// Returns the maximum distance of surfaces in contact: the tolerance, or the default tolerance if that is larger.
pub fn contact_reach(bodies: &Bodies) -> f64 {
    bodies.fit().tolerance().max(crate::Fit::negligible(bodies.assembly()))
}

/// Computes all contacts of the parts, with the geometry of the files.
///
/// # Errors
/// Returns an error if the run is cancelled or the boxes of too many parts overlap.
pub fn find_liaisons(bodies: &Bodies, watch: Watch) -> Result<Vec<Liaison>, AssemblyError> {
    let reach = contact_reach(bodies);
    let pairs = bodies.neighbouring_pairs(reach)?;
    let tally = watch.start_stage(Stage::Liaisons, pairs.len());
    let parts = bodies.assembly().parts();
    let examine = |&[a, b]: &[usize; 2]| {
        let patches = contact_patches(parts[a].solid(), parts[b].solid(), reach);
        let found = (!patches.is_empty()).then_some(Liaison { parts: [a, b], patches });
        tally.finish_item().map(|()| found)
    };
    let found: Result<Vec<Option<Liaison>>, AssemblyError> =
        pairs.par_iter().map(examine).collect();
    Ok(found?.into_iter().flatten().collect())
}

type Triangle = [DVec3; 3];

/// Returns a patch for each pair of faces of two solids in contact.
fn contact_patches(a: &Solid, b: &Solid, reach: f64) -> Vec<Patch> {
    let mut patches = Vec::new();
    each_facing_pair(a, b, reach, &mut |[p, q]| {
        let mut patch = Patch::empty(p.normal, -q.normal);
        let error = each_common_piece(p, q, reach, &mut |piece| patch.add(piece));
        patches.extend(patch.finished(twice_area(&p.facets[0]).length() * MIN_AREA, error));
    });
    patches
}

/// Returns the corners of the areas in which a part touches another one with facets whose normals are along `down`,
/// within [`MIN_OPPOSITE_COSINE`].
pub(crate) fn footprint_corners(a: &Solid, b: &Solid, reach: f64, down: DVec3) -> Vec<DVec3> {
    let mut corners = Vec::new();
    each_facing_pair(a, b, reach, &mut |[p, q]| {
        if p.normal.dot(down) >= MIN_OPPOSITE_COSINE {
            each_common_piece(p, q, reach, &mut |piece| {
                // Pieces between boundaries that agree up to rounding carry nothing.
                if piece.area > piece.error {
                    corners.extend(piece.world_corners());
                }
            });
        }
    });
    corners
}

/// Calls a function with all pairs of faces that face each other and are near.
fn each_facing_pair(a: &Solid, b: &Solid, reach: f64, call: &mut impl FnMut([&Face; 2])) {
    let (p, q) = (a.bounds().expanded(reach), b.bounds().expanded(reach));
    let region = Aabb { low: p.low.max(q.low), high: p.high.min(q.high) };
    let [first, second] = [a, b].map(|solid| Face::all_in(solid, &region, reach));
    let tree = BoxTree::new(second.iter().map(|face| face.bounds));
    for face in &first {
        for k in tree.intersecting(&face.bounds.expanded(reach)) {
            if -face.normal.dot(second[k].normal) >= MIN_OPPOSITE_COSINE {
                call([face, &second[k]]);
            }
        }
    }
}

/// Fraction of twice a facet's area up to which a piece is ignored.
const MIN_AREA: f64 = 1e-9;
/// Number of pairs of facets from which on two faces are compared as wholes.
const MANY_PAIRS: usize = 64;
/// Two faces are coplanar if the distances between their planes differ by at most this fraction of the reach.
const COPLANAR: f64 = 1.0 / 64.0;

/// Calls a function with the pieces of the intersection of two faces, projected along the first normal. Returns the
/// error of their total area beyond the errors of the pieces.
fn each_common_piece(p: &Face, q: &Face, reach: f64, call: &mut impl FnMut(&Piece)) -> f64 {
    let mut clipping = Clipping::default();
    let many = p.facets.len() * q.facets.len() >= MANY_PAIRS;
    if many {
        let height = |at: DVec3| (q.facets[0][0] - at).dot(q.normal) / p.normal.dot(q.normal);
        let heights = p.corners().map(height);
        let [low, high] = value_range(heights);
        if low > reach || high < -reach {
            return 0.0;
        }
        if high - low <= reach * COPLANAR {
            return each_swept_piece(p, q, &mut clipping, call);
        }
    }
    let tree = many.then(|| BoxTree::new(q.facets.iter().map(|t| Aabb::from_points(*t))));
    for first in &p.facets {
        let Some(plane) = Plane::from_facet(first) else { continue };
        let mut examine = |second: &Triangle| {
            if let Some(piece) = plane.contact_piece(second, reach, &mut clipping) {
                call(&piece);
            }
        };
        match &tree {
            Some(tree) => {
                let near = tree.intersecting(&Aabb::from_points(*first).expanded(reach));
                for k in near {
                    examine(&q.facets[k]);
                }
            }
            None => q.facets.iter().for_each(examine),
        }
    }
    0.0
}

/// Calls a function with the pieces of the intersection of two coplanar faces, found by a sweep. Returns the error of
/// their total area beyond the errors of the pieces.
fn each_swept_piece(
    p: &Face,
    q: &Face,
    clipping: &mut Clipping,
    call: &mut impl FnMut(&Piece),
) -> f64 {
    let Some(plane) = Plane::from_facet(&p.facets[0]) else { return 0.0 };
    let range = |face: &Face| value_range(face.corners().map(|at| plane.plane_coordinates(at).x));
    let ([low, high], [least, most]) = (range(p), range(q));
    let range = [low.max(least), high.min(most)];
    let [first, second] = [(p, 1.0), (q, -1.0)]
        .map(|(face, way)| Swept::new(face, |at| plane.plane_coordinates(at), way, range));
    let off = plane.coordinate_error(p.corners().chain(q.corners()));
    first.each_pair(&second, |a, b| {
        let ([a, b], reached) = ([a.corners(), b.corners()], &mut *clipping);
        let error = area_error_bound(off, [perimeter(&a), perimeter(&b)]);
        if let Some(piece) = plane.common_piece(&a, &b, error, reached) {
            call(&piece);
        }
    });
    area_error_bound(off, [p.perimeter(), q.perimeter()])
}

/// The plane of a facet with its axes.
struct Plane<'t> {
    facet: &'t Triangle,
    normal: DVec3,
    axes: [DVec3; 2],
    /// The corners of the facet in plane coordinates.
    corners: [DVec2; 3],
}

/// A piece of the intersection of two faces, in the plane of the first.
struct Piece<'c> {
    origin: DVec3,
    axes: [DVec3; 2],
    shadow: &'c [DVec2],
    area: f64,
    error: f64,
    middle: DVec2,
}

impl<'t> Plane<'t> {
    fn from_facet(facet: &'t Triangle) -> Option<Self> {
        let normal = twice_area(facet).try_normalize()?;
        let along = (facet[1] - facet[0]).try_normalize()?;
        let axes = [along, normal.cross(along)];
        let mut plane = Self { facet, normal, axes, corners: [DVec2::ZERO; 3] };
        plane.corners = facet.map(|at| plane.plane_coordinates(at));
        Some(plane)
    }

    fn plane_coordinates(&self, at: DVec3) -> DVec2 {
        let from = at - self.facet[0];
        DVec2::new(from.dot(self.axes[0]), from.dot(self.axes[1]))
    }

    /// Returns the common piece of the plane's facet and another one, or `None` if they are not in contact.
    fn contact_piece<'c>(
        &self,
        other: &Triangle,
        reach: f64,
        clipping: &'c mut Clipping,
    ) -> Option<Piece<'c>> {
        let n = self.normal;
        let m = twice_area(other).try_normalize()?;
        if -n.dot(m) < MIN_OPPOSITE_COSINE {
            return None;
        }
        // The second facet is clockwise if seen along the first normal.
        let seen = [other[0], other[2], other[1]].map(|at| self.plane_coordinates(at));
        let largest = perp_area(&self.corners);
        let mut piece = self.common_piece(&self.corners, &seen, 0.0, clipping)?;
        if piece.area <= largest * MIN_AREA {
            return None;
        }
        // Height of the second facet's plane above the first one.
        let height = |s: &DVec2| (other[0] - piece.world_position(*s)).dot(m) / n.dot(m);
        let heights = piece.shadow.iter().map(height);
        let [low, high] = value_range(heights);
        let off = self.coordinate_error(self.facet.iter().chain(other).copied());
        piece.error = area_error_bound(off, [perimeter(&self.corners), perimeter(&seen)]);
        (low <= reach && high >= -reach).then_some(piece)
    }

    /// Returns the intersection of two convex counter-clockwise polygons in the plane, or `None` if it has no area.
    fn common_piece<'c>(
        &self,
        first: &[DVec2],
        second: &[DVec2],
        error: f64,
        clipping: &'c mut Clipping,
    ) -> Option<Piece<'c>> {
        let shadow = clipping.intersect(first, second);
        let (area, middle) = area_and_centroid(shadow)?;
        Some(Piece { origin: self.facet[0], axes: self.axes, shadow, area, error, middle })
    }

    /// Returns a bound on the rounding error of the plane coordinates of some points (derived in
    /// `docs/theory/disassembly.md`).
    fn coordinate_error(&self, points: impl Iterator<Item = DVec3>) -> f64 {
        const U: f64 = f64::EPSILON / 2.0;
        let farthest = points.map(|p| p.distance(self.facet[0])).fold(0.0, f64::max);
        let (e, f) = (self.facet[1] - self.facet[0], self.facet[2] - self.facet[0]);
        let inverse_sine = e.length() * f.length() / e.cross(f).length();
        32.0 * U * farthest * (1.0 + inverse_sine)
    }
}

impl Piece<'_> {
    fn world_position(&self, seen: DVec2) -> DVec3 {
        self.origin + self.axes[0] * seen.x + self.axes[1] * seen.y
    }

    fn world_corners(&self) -> impl Iterator<Item = DVec3> {
        self.shadow.iter().map(|seen| self.world_position(*seen))
    }
}

impl Patch {
    const fn empty(normal: DVec3, other: DVec3) -> Self {
        Self { normal, other_normal: other, area: 0.0, area_error: 0.0, center: DVec3::ZERO }
    }

    /// Adds a piece. Until [`finished`](Self::finished), the centre is multiplied by the area.
    fn add(&mut self, piece: &Piece) {
        self.area += piece.area;
        // Includes the rounding of the sum.
        self.area_error += piece.error + f64::EPSILON * self.area;
        self.center += piece.world_position(piece.middle) * piece.area;
    }

    /// Returns the finished patch, or `None` if its area is at most `least`. `error` is an additional error of the
    /// area.
    fn finished(self, least: f64, error: f64) -> Option<Self> {
        let (center, area_error) = (self.center / self.area, 1.01 * (self.area_error + error));
        (self.area > least).then_some(Self { area_error, center, ..self })
    }
}

/// Returns a bound on the error of the area of the intersection of two polygons whose corners have an error of `off`.
///
/// `docs/theory/disassembly.md` derives it.
fn area_error_bound(off: f64, perimeters: [f64; 2]) -> f64 {
    10.0 * off * (perimeters[0] + perimeters[1])
}

fn perimeter(corners: &[DVec2]) -> f64 {
    (0..corners.len()).map(|k| corners[k].distance(corners[(k + 1) % corners.len()])).sum()
}

/// Returns twice the area of a triangle.
fn perp_area([a, b, c]: &[DVec2; 3]) -> f64 {
    (b - a).perp_dot(c - a).abs()
}

/// Buffers for clipping polygons.
#[derive(Default)]
struct Clipping {
    kept: Vec<DVec2>,
    next: Vec<DVec2>,
}

impl Clipping {
    /// Returns the intersection of two convex counter-clockwise polygons (Sutherland-Hodgman).
    fn intersect(&mut self, first: &[DVec2], second: &[DVec2]) -> &[DVec2] {
        self.kept.clear();
        self.kept.extend_from_slice(second);
        for (k, &from) in first.iter().enumerate() {
            self.clip_to_left(from, first[(k + 1) % first.len()]);
            if self.kept.is_empty() {
                break;
            }
        }
        &self.kept
    }

    /// Keeps the part of the polygon to the left of a line.
    fn clip_to_left(&mut self, from: DVec2, to: DVec2) {
        let side = |p: DVec2| (to - from).perp_dot(p - from);
        self.next.clear();
        for (k, &p) in self.kept.iter().enumerate() {
            let q = self.kept[(k + 1) % self.kept.len()];
            let (x, y) = (side(p), side(q));
            if x >= 0.0 {
                self.next.push(p);
            }
            if (x > 0.0 && y < 0.0) || (x < 0.0 && y > 0.0) {
                self.next.push(p + (q - p) * (x / (x - y)));
            }
        }
        std::mem::swap(&mut self.kept, &mut self.next);
    }
}

/// Returns area and centroid of a convex polygon, or `None` if it has no area.
fn area_and_centroid(polygon: &[DVec2]) -> Option<(f64, DVec2)> {
    let first = *polygon.first()?;
    let (mut twice, mut sum) = (0.0, DVec2::ZERO);
    for pair in polygon[1..].windows(2) {
        let area = (pair[0] - first).perp_dot(pair[1] - first);
        twice += area;
        sum += (first + pair[0] + pair[1]) * (area / 3.0);
    }
    (twice > 0.0).then(|| (twice / 2.0, sum / twice))
}

#[cfg(test)]
mod tests {
    use colltrans_testkit::oracle::exact::{Dyadic, Vector};
    use colltrans_testkit::random::Random;

    use super::*;

    fn contact_patch(first: &Triangle, second: &Triangle, reach: f64) -> Option<Patch> {
        let normal = |t: &Triangle| (t[1] - t[0]).cross(t[2] - t[0]).normalize();
        let mut patch = Patch::empty(normal(first), -normal(second));
        patch.add(&Plane::from_facet(first)?.contact_piece(
            second,
            reach,
            &mut Clipping::default(),
        )?);
        patch.finished(0.0, 0.0)
    }

    /// Triangles in parallel planes whose unit normal has no floating-point representation. The second one's
    /// projection covers the first, a part of it, or more. The areas are known as fractions.
    #[test]
    fn exact_contact_area_is_within_area_bounds() {
        let mut random = Random::new(5);
        let mut seen = [0; 3];
        for round in 0..3_000 {
            let mut vector =
                || DVec3::from_array([0; 3].map(|_| (random.unit() * 64.0).floor() - 32.0));
            let (e, mut f, far) = (vector(), vector(), vector() * 64.0);
            if round % 3 == 0 {
                // Slivers.
                f = e * 512.0 + f;
            }
            let (scale, shift, share) = match round % 4 {
                0 => (0.5, e * 0.25 + f * 0.25, 0.25),
                1 => (1.0, e * 0.5, 0.25),
                _ => (4.0, -(e + f), 1.0),
            };
            let first = [far, far + e, far + f];
            let second = [far, far + f, far + e].map(|p| far + (p - far) * scale + shift);
            let Some(patch) = contact_patch(&first, &second, 1.0) else { continue };
            let both = Liaison { parts: [0, 1], patches: vec![patch] };
            let [low, high] = both.area_bounds().map(Dyadic::new);
            let normal = Vector::new(e).cross(&Vector::new(f));
            let share = Dyadic::new(share / 2.0);
            let squared = &normal.dot(&normal) * &(&share * &share);
            assert!(&low * &low <= squared && squared <= &high * &high, "{patch:?}");
            assert!(round % 3 == 0 || patch.area_error < 1e-8 * patch.area, "{patch:?}");
            seen[round % 3] += 1;
        }
        assert!(seen.iter().all(|&n| n > 700), "{seen:?}");
    }

    #[test]
    fn contact_of_stacked_triangles_is_their_overlap() {
        let low = [DVec3::ZERO, DVec3::new(4.0, 0.0, 0.0), DVec3::new(0.0, 4.0, 0.0)];
        let up =
            |z: f64| [DVec3::new(0.0, 0.0, z), DVec3::new(0.0, 2.0, z), DVec3::new(2.0, 0.0, z)];
        let patch = contact_patch(&low, &up(0.01), 0.02).expect("they touch");
        assert_eq!(patch.normal, DVec3::Z);
        assert!((patch.area - 2.0).abs() < 1e-12);
        assert!((patch.center - DVec3::new(2.0 / 3.0, 2.0 / 3.0, 0.0)).length() < 1e-12);
        assert!(contact_patch(&low, &up(0.03), 0.02).is_none());
        let beside = up(0.0).map(|p| p + DVec3::new(5.0, 0.0, 0.0));
        assert!(contact_patch(&low, &beside, 0.02).is_none());
        let facing_away = [low[0], low[1], low[2]];
        assert!(contact_patch(&low, &facing_away, 0.02).is_none());
    }

    /// Returns a sheet of the squares of a grid, each of two facets, with some squares left out.
    fn random_sheet(random: &mut Random, place: impl Fn(DVec2) -> DVec3, turned: bool) -> Solid {
        const SIDE: usize = 7;
        let at = |k: usize| DVec2::new((k % SIDE) as f64, (k / SIDE) as f64);
        let vertices: Vec<DVec3> = (0..SIDE * SIDE).map(|k| place(at(k))).collect();
        let mut faces = Vec::new();
        for k in (0..SIDE * (SIDE - 1)).filter(|k| k % SIDE + 1 < SIDE) {
            if random.unit() < 0.75 {
                let [a, b, c, d] = [k, k + 1, k + SIDE + 1, k + SIDE].map(|v| v as u32);
                faces.extend([vec![a, b, c], vec![a, c, d]]);
            }
        }
        if turned {
            for face in &mut faces {
                face.reverse();
            }
        }
        Solid::from_open_mesh(&vertices, &faces).expect("a sheet")
    }

    /// Sheets with holes face each other, in any plane, on equal, rotated or arbitrary grids. The sweep finds the
    /// same area, centroid and corners as all pairs of facets.
    #[test]
    fn sweep_of_coplanar_faces_equals_all_pairs_of_facets() {
        let mut random = Random::new(8);
        for round in 0..200 {
            let (turn, shift) = match round % 4 {
                0 => (0.0, DVec2::ZERO),
                1 => (0.0, DVec2::new(0.5, -1.0)),
                2 => (std::f64::consts::FRAC_PI_2, DVec2::new(6.0, 0.25)),
                _ => (random.unit(), DVec2::new(random.unit(), random.unit())),
            };
            let world = if round % 8 < 4 { glam::DQuat::IDENTITY } else { random.rotation() };
            let place = |p: DVec2| world * p.extend(0.0);
            let first = random_sheet(&mut random, place, false);
            let turn = DVec2::from_angle(turn);
            let second = random_sheet(&mut random, |p| place(turn.rotate(p) + shift), true);
            let patches = contact_patches(&first, &second, 1e-3);
            let corners = |solid: &Solid| -> Vec<Triangle> {
                let corner = |v: u32| solid.vertices()[v as usize];
                solid.triangles().iter().map(|t| t.map(corner)).collect()
            };
            let (first_facets, second_facets) = (corners(&first), corners(&second));
            let each =
                || first_facets.iter().flat_map(|p| second_facets.iter().map(move |q| (p, q)));
            let all: Vec<Patch> = each().filter_map(|(p, q)| contact_patch(p, q, 1e-3)).collect();
            let sum = |patches: &[Patch]| {
                let area: f64 = patches.iter().map(|p| p.area).sum();
                let error: f64 = patches.iter().map(|p| p.area_error).sum();
                let center: DVec3 = patches.iter().map(|p| p.center * p.area).sum();
                (area, error, center)
            };
            let ([area, other], [error, more], [center, middle]) = {
                let (a, b) = (sum(&patches), sum(&all));
                ([a.0, b.0], [a.1, b.1], [a.2, b.2])
            };
            assert!((area - other).abs() <= error + more, "{round}: {area} {other}");
            assert!(error < 1e-8 && area > 1.0, "{round}: {area}, {error}");
            assert!(center.distance(middle) < 1e-9, "{round}: {center} {middle}");
            assert!(patches.len() <= 16, "{round}: {}", patches.len());
            let down = world * DVec3::Z;
            let seen = |p: DVec3| (world.inverse() * p).truncate();
            let reached = |points: Vec<DVec3>| -> Vec<f64> {
                let along = |d: DVec2| points.iter().map(|p| seen(*p).dot(d)).fold(0.0, f64::max);
                (0..16).map(|k| along(DVec2::from_angle(f64::from(k) * 0.4))).collect()
            };
            let pieces = |(p, q): (&Triangle, &Triangle)| {
                let mut clipping = Clipping::default();
                let piece = Plane::from_facet(p)?
                    .contact_piece(q, 1e-3, &mut clipping)?
                    .world_corners()
                    .collect();
                Some::<Vec<DVec3>>(piece)
            };
            let ends = reached(each().filter_map(pieces).flatten().collect());
            for (a, b) in
                reached(footprint_corners(&first, &second, 1e-3, down)).into_iter().zip(ends)
            {
                assert!((a - b).abs() < 1e-4, "{round}: {a} {b}");
            }
        }
    }

    /// Discs of a thousand thin facets that share a corner, a different one in each disc. The number of pieces is
    /// proportional to the boundary edges, not to the pairs of facets that cross.
    #[test]
    fn sweep_of_thin_facets_makes_few_pieces() {
        const SIDES: u32 = 1_000;
        let disc = |corner: u32, turned: bool| {
            let angle = |k: u32| f64::from(k) / f64::from(SIDES) * std::f64::consts::TAU;
            let vertices: Vec<DVec3> =
                (0..SIDES).map(|k| DVec2::from_angle(angle(k)).extend(0.0)).collect();
            let side = |k: u32| [corner, (corner + k) % SIDES, (corner + k + 1) % SIDES];
            let mut faces: Vec<[u32; 3]> = (1..SIDES - 1).map(side).collect();
            if turned {
                for face in &mut faces {
                    face.reverse();
                }
            }
            Solid::from_open_mesh(&vertices, &faces).expect("a sheet")
        };
        let (first, second) = (disc(0, false), disc(SIDES / 3, true));
        let (mut faces, mut pieces) = (0, 0);
        each_facing_pair(&first, &second, 1e-6, &mut |[p, q]| {
            faces += 1;
            each_common_piece(p, q, 1e-6, &mut |_| pieces += 1);
        });
        assert!(faces == 1 && pieces <= 4 * SIDES, "{faces} {pieces}");
        let [low, high] =
            Liaison { parts: [0, 1], patches: contact_patches(&first, &second, 1e-6) }
                .area_bounds();
        let area = 0.5 * f64::from(SIDES) * (std::f64::consts::TAU / f64::from(SIDES)).sin();
        assert!(low <= area && area <= high && high - low < 1e-6, "{low} {area} {high}");
    }
}
