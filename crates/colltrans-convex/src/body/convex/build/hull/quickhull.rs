//! Quickhull on exact decisions.
//!
//! Invariant: the triangles are the boundary of the exact convex hull of the points inserted so far.
//! A point is inserted if it lies more than the tolerance outside a triangle's plane; the triangles
//! it sees, decided by exact orientations, are replaced by a cone from their rim to the point. A
//! triangle whose plane contains the point counts as hidden, so a planar cap is not torn down for
//! each of its corners. A point collinear with a rim edge would lie in the plane of the triangle
//! seen there and not see it, so no degenerate triangle is ever made; and what is seen is what a
//! point moved slightly inwards sees, so it is one disk.
//!
//! Barber, Dobkin, Huhdanpaa, "The quickhull algorithm for convex hulls", ACM TOMS 22(4), 1996, for
//! the conflict lists.

use std::collections::VecDeque;

use glam::DVec3;

use super::distinct_sorted;
use super::fan::ConeSectors;
use crate::body::Aabb;
use colltrans_kernel::plane::triangle_normal;
use colltrans_kernel::work;

const NONE: u32 = u32::MAX;

/// A triangle of a hull.
#[derive(Debug, Clone, Copy)]
pub(super) struct Triangle {
    pub(super) corners: [u32; 3],
    /// The triangles across the edges `corners[k] -> corners[k + 1]`.
    pub(super) neighbours: [u32; 3],
    /// Unit normal, outwards; 0 if rounding leaves no area.
    pub(super) normal: DVec3,
}

/// A triangle of a hull that grows.
#[derive(Debug, Clone)]
struct GrowingTriangle {
    corners: [u32; 3],
    neighbours: [u32; 3],
    normal: DVec3,
    /// Its first corner.
    origin: DVec3,
    /// Distance below which a rounded distance from the plane may have the wrong sign.
    sign_error: f64,
    /// Head of the list of points outside.
    outside: u32,
    /// The farthest of them, and how far.
    farthest: (f64, u32),
    alive: bool,
    /// The last insertion that looked at this triangle, and whether it was seen.
    stamp: u32,
    is_visible: bool,
}

/// A hull of triangles.
#[derive(Debug)]
pub(super) struct Simplicial {
    pub(super) triangles: Vec<Triangle>,
    /// Points not inserted that are outside by up to, or inside by less than, the tolerance. All others
    /// are inside, exactly.
    pub(super) near: Vec<u32>,
}

impl Simplicial {
    /// The points that are corners, ascending.
    pub(super) fn sorted_vertices(&self) -> Vec<u32> {
        distinct_sorted(self.triangles.iter().flat_map(|t| t.corners))
    }
}

/// A point set without volume: what spans it.
#[derive(Debug, Clone, Copy)]
pub(super) enum Flat {
    Point(u32),
    Segment([u32; 2]),
    /// With the unit normal of the plane.
    Plane(DVec3),
}

/// Refinement goes in breadth until this many points are left for each one inserted, then in depth.
///
/// In depth, what is looked at is still in the cache (spheres of 200,000 points: 1.5 times faster).
/// But of two rings, one would be finished before the other: then every point of the other one sees
/// a fan over half the ring, and each of its orphans is held against the new fan, which is quadratic.
/// In breadth both rings grow together. Patches of a bounded number of points cannot do much harm.
const POINTS_PER_PATCH: u32 = 128;

/// Of a new cone with more triangles the one that an orphan sees is found by its [`Fan`]: of two rings close
/// together, as along a chamfer, a patch of one is still finished before the other's. Of smaller cones all are
/// looked at, and an orphan goes where it is farthest outside.
const MAX_SCANNED_CONE: usize = 16;

/// The hull of the points in `kept`, or what dimension they have instead. Points within the tolerance
/// of a triangle and outside none by more are left out, unless they are in `forced` (ascending).
pub(super) fn simplicial_hull(
    points: &[DVec3],
    kept: &[u32],
    forced: &[u32],
    tolerance: f64,
) -> Result<Simplicial, Flat> {
    let simplex = first_simplex(points, kept, tolerance)?;
    let mut builder = HullBuilder::new(points, kept, forced, tolerance);
    builder.add_simplex(simplex, kept);
    let in_breadth = kept.len() as u32 / POINTS_PER_PATCH;
    let mut inserted = 0;
    while let Some(face) = builder.next_pending(inserted < in_breadth) {
        let triangle = &builder.triangles[face as usize];
        if triangle.alive && triangle.outside != NONE {
            builder.insert_farthest(face);
            inserted += 1;
        }
    }
    Ok(builder.into_simplicial())
}

/// Four points that span a volume, the first three counter-clockwise as seen from the outside, away
/// from the fourth.
fn first_simplex(points: &[DVec3], kept: &[u32], tolerance: f64) -> Result<[u32; 4], Flat> {
    let at = |i: u32| points[i as usize];
    let farthest = |from: &dyn Fn(DVec3) -> f64| {
        kept.iter().fold((f64::NEG_INFINITY, kept[0]), |best, &i| {
            let distance = from(at(i));
            if distance > best.0 { (distance, i) } else { best }
        })
    };
    let (_, a) = farthest(&|p| -p.x);
    let a = farthest(&|p| p.distance(at(a))).1;
    let (length, b) = farthest(&|p| p.distance(at(a)));
    if length <= tolerance {
        return Err(Flat::Point(a));
    }
    let axis = (at(b) - at(a)) / length;
    let (width, c) = farthest(&|p| (p - at(a)).cross(axis).length());
    if width <= tolerance {
        return Err(Flat::Segment([a, b]));
    }
    let normal = triangle_normal([at(a), at(b), at(c)]).normalize();
    let (height, e) = farthest(&|p| (p - at(a)).dot(normal).abs());
    let above = orientation(at(a), at(b), at(c), at(e));
    if height <= tolerance || above == 0.0 {
        return Err(Flat::Plane(normal));
    }
    Ok(if above > 0.0 { [a, c, b, e] } else { [a, b, c, e] })
}

pub(super) use colltrans_kernel::predicates::orient3d as orientation;

/// Where a point went.
enum Assigned {
    /// On the list of a triangle.
    To(u32),
    /// Within the tolerance of a triangle, outside none by more.
    Near,
    /// Nowhere: it is inside of all, exactly.
    Inside,
}

struct HullBuilder<'a> {
    points: &'a [DVec3],
    forced: &'a [u32],
    tolerance: f64,
    /// Bound on the distance between two points.
    extent: f64,
    triangles: Vec<GrowingTriangle>,
    /// Triangles that may have points outside.
    pending: VecDeque<u32>,
    /// For each point, the next in its list.
    next: Vec<u32>,
    /// For each point, the new triangle whose rim edge starts there.
    rim_start: Vec<u32>,
    near: Vec<u32>,
    insertion: u32,
    // Scratch space of one insertion.
    visible: Vec<u32>,
    rim: Vec<(u32, u32, u32)>,
    free: Vec<u32>,
}

impl<'a> HullBuilder<'a> {
    fn new(points: &'a [DVec3], kept: &[u32], forced: &'a [u32], tolerance: f64) -> Self {
        let bounds = Aabb::of_points(kept.iter().map(|&i| points[i as usize]));
        Self {
            points,
            forced,
            tolerance,
            extent: bounds.size().length(),
            triangles: Vec::new(),
            pending: VecDeque::new(),
            next: vec![NONE; points.len()],
            rim_start: vec![NONE; points.len()],
            near: Vec::new(),
            insertion: 0,
            visible: Vec::new(),
            rim: Vec::new(),
            free: Vec::new(),
        }
    }

    fn next_pending(&mut self, in_breadth: bool) -> Option<u32> {
        if in_breadth { self.pending.pop_front() } else { self.pending.pop_back() }
    }

    fn point_at(&self, i: u32) -> DVec3 {
        self.points[i as usize]
    }

    fn add_simplex(&mut self, [a, b, c, e]: [u32; 4], kept: &[u32]) {
        let faces = [[a, b, c], [b, a, e], [c, b, e], [a, c, e]];
        let neighbours = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];
        for (corners, neighbours) in faces.into_iter().zip(neighbours) {
            let face = self.add_triangle(corners);
            self.triangles[face as usize].neighbours = neighbours;
        }
        for &i in kept {
            if ![a, b, c, e].contains(&i) && matches!(self.assign_point(i, 0..4), Assigned::Near) {
                self.near.push(i);
            }
        }
        self.pending.extend([0, 1, 2, 3]);
    }

    /// A new triangle without neighbours.
    fn add_triangle(&mut self, corners: [u32; 3]) -> u32 {
        let [a, b, c] = corners.map(|i| self.point_at(i));
        let normal = triangle_normal([a, b, c]);
        let area = normal.length();
        // The product of the two shorter edges, and the distance of a point `extent` away, are off
        // by a few roundings.
        let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(p, q)| p.distance_squared(q));
        let product = (ab * bc).min(bc * ca).min(ca * ab).sqrt();
        let sign_error = 16.0 * f64::EPSILON * product * self.extent / area;
        let triangle = GrowingTriangle {
            corners,
            neighbours: [NONE; 3],
            normal: if area > 0.0 { normal / area } else { DVec3::ZERO },
            origin: a,
            sign_error: if area > 0.0 { sign_error } else { f64::INFINITY },
            outside: NONE,
            farthest: (f64::NEG_INFINITY, NONE),
            alive: true,
            stamp: 0,
            is_visible: false,
        };
        if let Some(slot) = self.free.pop() {
            self.triangles[slot as usize] = triangle;
            slot
        } else {
            self.triangles.push(triangle);
            self.triangles.len() as u32 - 1
        }
    }

    /// Signed distance of a point from a triangle's plane, rounded.
    fn plane_distance(&self, face: u32, p: DVec3) -> f64 {
        let triangle = &self.triangles[face as usize];
        triangle.normal.dot(p - triangle.origin)
    }

    /// Puts a point on the list of the triangle it is farthest outside of, if by more than the
    /// tolerance or the point is forced: then the exact sign alone decides, whatever the rounded
    /// distance says.
    fn assign_point(&mut self, i: u32, faces: impl Iterator<Item = u32>) -> Assigned {
        let p = self.point_at(i);
        let is_forced = self.forced.binary_search(&i).is_ok();
        let mut best = (if is_forced { f64::NEG_INFINITY } else { self.tolerance }, NONE);
        let mut is_near = false;
        for face in faces {
            work::count(1);
            let distance = self.plane_distance(face, p);
            if distance > best.0 && self.is_outside(face, p, distance) {
                best = (distance, face);
            }
            // The rounded distance from a sliver's plane says little.
            is_near = is_near || distance > -self.tolerance || self.is_outside(face, p, distance);
        }
        let (distance, face) = best;
        if face == NONE {
            return if is_near { Assigned::Near } else { Assigned::Inside };
        }
        let triangle = &mut self.triangles[face as usize];
        self.next[i as usize] = triangle.outside;
        triangle.outside = i;
        if distance > triangle.farthest.0 {
            triangle.farthest = (distance, i);
        }
        Assigned::To(face)
    }

    /// Whether a point at a rounded distance is really outside: slivers have arbitrary rounded
    /// normals.
    fn is_outside(&self, face: u32, p: DVec3, distance: f64) -> bool {
        let triangle = &self.triangles[face as usize];
        if distance.abs() > triangle.sign_error {
            return distance > 0.0;
        }
        let [a, b, c] = triangle.corners.map(|i| self.point_at(i));
        orientation(a, b, c, p) > 0.0
    }

    /// Assigns a point that lost its triangle.
    ///
    /// In exact arithmetic one of the new triangles sees it if any triangle does. But it may be
    /// within the tolerance of that one and far outside an older one (a corner of a box in the
    /// planes of its faces): then the triangles that see it are searched from the rim on.
    fn reassign_orphan(&mut self, i: u32, cone: &[u32], sectors: Option<&ConeSectors>) {
        let guess = sectors.map(|sectors| sectors.candidates(self.point_at(i)));
        if guess
            .is_some_and(|near| matches!(self.assign_point(i, near.into_iter()), Assigned::To(_)))
        {
            return;
        }
        if !matches!(self.assign_point(i, cone.iter().copied()), Assigned::Near) {
            return;
        }
        let p = self.point_at(i);
        self.insertion += 1;
        let mut stack: Vec<u32> = self.rim.iter().map(|&(_, _, hidden)| hidden).collect();
        while let Some(face) = stack.pop() {
            if self.triangles[face as usize].stamp == self.insertion {
                continue;
            }
            self.set_visibility(face, false);
            if let Assigned::To(face) = self.assign_point(i, std::iter::once(face)) {
                self.pending.push_back(face);
                return;
            }
            work::count(1);
            if self.is_visible_from(face, p) {
                stack.extend(self.triangles[face as usize].neighbours);
            }
        }
        self.near.push(i);
    }

    /// Whether a point sees a triangle, strictly; exact.
    fn is_visible_from(&self, face: u32, p: DVec3) -> bool {
        self.is_outside(face, p, self.plane_distance(face, p))
    }

    /// Inserts the farthest point of a triangle's list.
    fn insert_farthest(&mut self, face: u32) {
        let apex = self.triangles[face as usize].farthest.1;
        let p = self.point_at(apex);
        self.find_rim(face, p);
        let mut orphans = NONE;
        for k in 0..self.visible.len() {
            let face = self.visible[k];
            let triangle = &mut self.triangles[face as usize];
            triangle.alive = false;
            let mut i = std::mem::replace(&mut triangle.outside, NONE);
            while i != NONE {
                let next = self.next[i as usize];
                if i != apex {
                    self.next[i as usize] = orphans;
                    orphans = i;
                }
                i = next;
            }
        }
        let cone = self.build_cone(apex);
        let sectors =
            (orphans != NONE && cone.len() > MAX_SCANNED_CONE).then(|| self.cone_sectors(p, &cone));
        while orphans != NONE {
            let next = self.next[orphans as usize];
            self.reassign_orphan(orphans, &cone, sectors.as_ref());
            orphans = next;
        }
        self.pending.extend(&cone);
        self.free.append(&mut self.visible);
    }

    /// Collects the triangles that `p` sees and the rim edges `(from, to, hidden triangle)`.
    fn find_rim(&mut self, first: u32, p: DVec3) {
        self.insertion += 1;
        self.rim.clear();
        self.set_visibility(first, true);
        self.visible.push(first);
        let mut k = 0;
        while k < self.visible.len() {
            let face = self.visible[k];
            k += 1;
            let GrowingTriangle { corners, neighbours, .. } = self.triangles[face as usize];
            for side in 0..3 {
                let other = neighbours[side];
                work::count(1);
                if self.triangles[other as usize].stamp != self.insertion {
                    let is_visible = self.is_visible_from(other, p);
                    self.set_visibility(other, is_visible);
                    if is_visible {
                        self.visible.push(other);
                    }
                }
                if !self.triangles[other as usize].is_visible {
                    self.rim.push((corners[side], corners[(side + 1) % 3], other));
                }
            }
        }
    }

    fn set_visibility(&mut self, face: u32, is_visible: bool) {
        let triangle = &mut self.triangles[face as usize];
        (triangle.stamp, triangle.is_visible) = (self.insertion, is_visible);
    }

    /// The triangles from the rim to the new point, linked to each other and to the hidden ones.
    fn build_cone(&mut self, apex: u32) -> Vec<u32> {
        let rim = std::mem::take(&mut self.rim);
        let mut cone = Vec::with_capacity(rim.len());
        for &(from, to, hidden) in &rim {
            let face = self.add_triangle([from, to, apex]);
            self.triangles[face as usize].neighbours[0] = hidden;
            let back = &mut self.triangles[hidden as usize];
            let side = back.corners.iter().position(|&c| c == to).unwrap_or(0);
            back.neighbours[side] = face;
            self.rim_start[from as usize] = face;
            cone.push(face);
        }
        for (&(_, to, _), &face) in rim.iter().zip(&cone) {
            let following = self.rim_start[to as usize];
            self.triangles[face as usize].neighbours[1] = following;
            self.triangles[following as usize].neighbours[2] = face;
        }
        self.rim = rim;
        cone
    }

    /// The triangles of a cone by their sectors.
    fn cone_sectors(&self, apex: DVec3, cone: &[u32]) -> ConeSectors {
        work::count(cone.len());
        let start = |&face: &u32| (self.point_at(self.triangles[face as usize].corners[0]), face);
        ConeSectors::new(apex, cone.iter().map(start))
    }

    /// Drops the dead triangles and renumbers the rest.
    fn into_simplicial(self) -> Simplicial {
        let mut number = vec![NONE; self.triangles.len()];
        let alive = || self.triangles.iter().enumerate().filter(|(_, t)| t.alive);
        for (n, (k, _)) in alive().enumerate() {
            number[k] = n as u32;
        }
        let renumbered = |t: &GrowingTriangle| Triangle {
            corners: t.corners,
            neighbours: t.neighbours.map(|n| number[n as usize]),
            normal: t.normal,
        };
        let triangles = alive().map(|(_, t)| renumbered(t)).collect();
        Simplicial { triangles, near: self.near }
    }
}
