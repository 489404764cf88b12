//! Exact test whether two solids overlap at the start. Their interiors have a common point if and only if
//!
//! 1. two facets cross: their planes differ, and their interiors share a segment; or
//! 2. two facets with the same orientation share a part of a plane; or
//! 3. an edge of one runs through a facet or along an edge of the other, and the wedges of material around it share
//!    interior points; or
//! 4. a shell of one lies inside the other and touches its surface in isolated points at most; or
//! 5. a shell of one lies on the surface of a piece of the other, but inside another piece.
//!
//! Nodes whose boxes or slabs are separated are cut. All other pairs are decided in exact arithmetic. With a minimum
//! gap, two facets count if they are certainly nearer than the gap, computed with its error. Proof, and the cases of
//! open shells, points and segments ([`thin`]): `docs/theory/solid-overlap.md`.

use std::cmp::Ordering;
use std::fmt;

use glam::DVec3;

use super::bound::{Reason, are_separated, dismissal_reason, is_beyond_side};
use super::hulls::is_plane_between;
use super::inside;
use super::leaf::FacetDifference;
use super::projected::Projected;
use super::scene::{PairFrame, PlacedBody, PlacedVertex};
use super::thin;
use super::triangle::Triangle;
use crate::body::tree::{MAX_LEAF_FACETS, Node};
use crate::body::wedge::{AxisSigns, Ray, Wedge};
use crate::solve::steps::SolidSteps;
use colltrans_convex::body::Aabb;
use colltrans_kernel::descent::{node_to_split, pair_with_node};

/// The place of an overlap, as positions in [`Solid::triangles`](crate::Solid::triangles).
/// [`Solid::facet_indices`](crate::Solid::facet_indices) maps them to facets of the input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Overlap {
    /// The bodies overlap at these two triangles, of the moving and of the fixed body.
    Facets(u32, u32),
    /// The shell of the moving body with this triangle lies inside the fixed body.
    MovingInside(u32),
    /// The shell of the fixed body with this triangle lies inside the moving body.
    FixedInside(u32),
}

impl fmt::Display for Overlap {
    /// Writes a noun phrase with the positions of triangles, counted from 0.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Facets(moving, fixed) => {
                write!(
                    f,
                    "triangle {moving} of the moving body and triangle {fixed} of the fixed body"
                )
            }
            Self::MovingInside(triangle) => {
                write!(
                    f,
                    "the shell of the moving body with triangle {triangle}, inside the fixed body"
                )
            }
            Self::FixedInside(triangle) => {
                write!(
                    f,
                    "the shell of the fixed body with triangle {triangle}, inside the moving body"
                )
            }
        }
    }
}

/// Finds a place where the interiors intersect or an open shell passes through the other body. With a minimum gap,
/// finds two facets that are certainly nearer than the gap, or a shell inside the other body. `None` if there is no
/// such place.
///
/// A plane between the hulls of convex bodies replaces the search.
#[inline]
pub fn find_overlap(scene: &PairFrame, steps: &mut SolidSteps) -> Option<Overlap> {
    let [a, b] = Projected::root_bounds(scene);
    if never_overlap(scene, &a, &b) || is_plane_between(scene) {
        steps.count_pair(Some(Reason::Disjoint));
        return None;
    }
    search_overlap(scene, &a, &b, &mut |entry| steps.count_pair(entry))
}

/// Finds an overlap like [`find_overlap`]. Calls `cut` for every pair of nodes in the order of the descent, with `None`
/// if the pair was split, otherwise with the reason.
pub(crate) fn find_overlap_with(
    scene: &PairFrame,
    cut: &mut impl FnMut(Option<Reason>),
) -> Option<Overlap> {
    let [a, b] = Projected::root_bounds(scene);
    if never_overlap(scene, &a, &b) {
        cut(Some(Reason::Disjoint));
        return None;
    }
    search_overlap(scene, &a, &b, cut)
}

/// Searches an overlap of two bodies with these bounds, from the roots of their trees.
fn search_overlap(
    scene: &PairFrame,
    a: &Projected,
    b: &Projected,
    cut: &mut impl FnMut(Option<Reason>),
) -> Option<Overlap> {
    let facets = search_pairs(scene, [0, 0], a, b, PairTest::overlap_test(scene), cut);
    facets.map(|(f, g)| Overlap::Facets(f, g)).or_else(|| nested_shell(scene))
}

/// Checks whether boxes and slabs alone show that the interiors of two whole bodies are disjoint.
pub(crate) fn never_overlap(scene: &PairFrame, a: &Projected, b: &Projected) -> bool {
    let (p, q) = (&scene.moving, &scene.fixed);
    is_beyond_side(scene, (p, a), (q, b))
        || is_beyond_side(scene, (q, b), (p, a))
        || a.bounds.low.cmpge(b.bounds.high).any()
        || b.bounds.low.cmpge(a.bounds.high).any()
}

/// Checks whether the bounds of the two whole bodies (boxes, slabs and facing directions) show that the bodies do not
/// overlap and that nothing blocks the moving one before `limit`, a length.
pub(crate) fn boxes_exclude_contact(scene: &PairFrame, limit: f64) -> bool {
    let [a, b] = Projected::root_bounds(scene);
    never_overlap(scene, &a, &b) && dismissal_reason(&a, &b, limit, true).is_some()
}

/// Finds a shell of one body that lies inside the other, for bodies whose surfaces do not cross; `None` if there is
/// none.
pub(crate) fn nested_shell(scene: &PairFrame) -> Option<Overlap> {
    let moving = inside::shell_inside(scene, true).map(Overlap::MovingInside);
    moving.or_else(|| inside::shell_inside(scene, false).map(Overlap::FixedInside))
}

/// Checks whether the bodies overlap at the given place.
pub(crate) fn is_overlap(scene: &PairFrame, overlap: Overlap) -> bool {
    let count = |side: &PlacedBody| side.solid.triangles().len() as u32;
    match overlap {
        Overlap::Facets(f, g) => {
            f < count(&scene.moving) && g < count(&scene.fixed) && {
                let f = Triangle::new(&scene.moving, f as usize);
                let g = Triangle::new(&scene.fixed, g as usize);
                (PairTest::overlap_test(scene).holds)(scene, &f, &g)
            }
        }
        Overlap::MovingInside(t) => t < count(&scene.moving) && inside::is_inside(scene, true, t),
        Overlap::FixedInside(t) => t < count(&scene.fixed) && inside::is_inside(scene, false, t),
    }
}

/// Returns the largest separation of the facets of an overlap along a candidate normal, and this normal in the world,
/// from the moving body to the fixed one. Candidates are the normals of both facets and the cross products of two
/// edges. The value is rounded, and negative if the facets overlap along all candidates. `None` for nested shells, or
/// if all candidates vanish.
pub(crate) fn widest_separation(scene: &PairFrame, overlap: Overlap) -> Option<(f64, DVec3)> {
    let Overlap::Facets(f, g) = overlap else { return None };
    let corners = |side: &PlacedBody, t: u32| side.corners(t as usize).map(|c| c.at);
    let (f, g) = (corners(&scene.moving, f), corners(&scene.fixed, g));
    let edges = |[a, b, c]: [DVec3; 3]| [b - a, c - b, a - c];
    let (e, h) = (edges(f), edges(g));
    let across = e.into_iter().flat_map(|a| h.map(|b| a.cross(b)));
    let mut widest: Option<(f64, DVec3)> = None;
    for normal in across.chain([e[0].cross(e[1]), h[0].cross(h[1])]) {
        let Some(normal) = normal.try_normalize() else { continue };
        let ends = |corners: [DVec3; 3]| {
            let [a, b, c] = corners.map(|p| normal.dot(p));
            [a.min(b).min(c), a.max(b).max(c)]
        };
        let ([low, high], [least, most]) = (ends(f), ends(g));
        for (gap, normal) in [(least - high, normal), (low - most, -normal)] {
            if widest.is_none_or(|(best, _)| gap > best) {
                widest = Some((gap, normal));
            }
        }
    }
    widest.map(|(gap, normal)| (gap, scene.frame.transpose() * normal))
}

/// Checks whether the solids, as closed sets, have a common point at the given place. The two facets of the place must
/// share a point, or its shell must be inside the other body.
pub(crate) fn is_touch(scene: &PairFrame, place: Overlap) -> bool {
    let count = |side: &PlacedBody| side.solid.triangles().len() as u32;
    match place {
        Overlap::Facets(f, g) => {
            f < count(&scene.moving) && g < count(&scene.fixed) && {
                let f = Triangle::new(&scene.moving, f as usize);
                share_a_point(scene, &f, &Triangle::new(&scene.fixed, g as usize))
            }
        }
        inside => is_overlap(scene, inside),
    }
}

/// Checks whether no two facets of two leaves show an overlap.
pub(crate) fn leaves_apart(scene: &PairFrame, a: &Node, b: &Node) -> bool {
    search_leaves(scene, a, b, PairTest::overlap_test(scene)).is_none()
}

/// Finds a place where the solids, as closed sets, have a common point. With a minimum gap, two facets whose distance
/// is certainly at most the gap count as well. `None` if there is no such place.
pub(crate) fn find_contact(scene: &PairFrame, steps: &mut SolidSteps) -> Option<Overlap> {
    let [a, b] = Projected::root_bounds(scene);
    let mut count = |entry| steps.count_pair(entry);
    if are_separated(scene, &a, &b) || is_plane_between(scene) {
        count(Some(Reason::Disjoint));
        return None;
    }
    let facets = search_pairs(scene, [0, 0], &a, &b, PairTest::contact_test(scene), &mut count);
    facets.map(|(f, g)| Overlap::Facets(f, g)).or_else(|| nested_shell(scene))
}

impl SolidSteps {
    /// Counts a pair of nodes that was split (`None`) or cut for a reason.
    pub(crate) fn count_pair(&mut self, entry: Option<Reason>) {
        self.nodes += 1;
        self.leaves += u32::from(entry == Some(Reason::Examined));
    }
}

/// A test of two triangles, and whether nodes that lie face to face can satisfy it.
#[derive(Clone, Copy)]
struct PairTest {
    holds: fn(&PairFrame, &Triangle, &Triangle) -> bool,
    faces: bool,
}

impl PairTest {
    const OVERLAP: Self = Self { holds: show_overlap, faces: false };
    const TOUCH: Self = Self { holds: share_a_point, faces: true };
    const NEARER: Self = Self { holds: are_nearer, faces: true };
    const AS_NEAR: Self = Self { holds: are_as_near, faces: true };

    /// Returns the test of an overlap, or of a distance below the minimum gap if there is one.
    fn overlap_test(scene: &PairFrame) -> Self {
        if scene.has_min_gap() { Self::NEARER } else { Self::OVERLAP }
    }

    /// Returns the test of contact, or of a distance up to the minimum gap if there is one.
    fn contact_test(scene: &PairFrame) -> Self {
        if scene.has_min_gap() { Self::AS_NEAR } else { Self::TOUCH }
    }

    /// Returns the reason why a pair of nodes needs no further comparison; `None` if it does.
    ///
    /// Two facets in one plane that face each other prove no overlap, because their materials lie on opposite sides of
    /// the plane. An edge of one facet can overlap the material behind the other one only through its neighbour across
    /// this edge. This neighbour is not in the plane, so it is in another node, which shows the overlap.
    fn dismissal_reason(self, scene: &PairFrame, a: &Projected, b: &Projected) -> Option<Reason> {
        if are_separated(scene, a, b) {
            return Some(Reason::Disjoint);
        }
        (!self.faces && a.is_face_to_face(b)).then_some(Reason::FaceToFace)
    }
}

/// Finds a pair of triangles that satisfies `test`, among all pairs whose nodes are not certainly separated.
fn search_pairs(
    scene: &PairFrame,
    nodes: [usize; 2],
    a: &Projected,
    b: &Projected,
    test: PairTest,
    cut: &mut impl FnMut(Option<Reason>),
) -> Option<(u32, u32)> {
    let (m, n) = (&scene.moving.solid.nodes()[nodes[0]], &scene.fixed.solid.nodes()[nodes[1]]);
    let are_leaves = [m.is_leaf(), n.is_leaf()];
    let Some(which) = node_to_split(are_leaves, |k| [m, n][k].squared_diagonal()) else {
        cut(Some(Reason::Examined));
        return search_leaves(scene, m, n, test);
    };
    cut(None);
    for part in [m, n][which].child_positions(nodes[which] as u32) {
        let part = part as usize;
        let projected = Projected::new(scene, scene.side(which == 0), part);
        let [p, q] = pair_with_node([a, b], which, &projected);
        if let Some(reason) = test.dismissal_reason(scene, p, q) {
            cut(Some(reason));
            continue;
        }
        let found = search_pairs(scene, pair_with_node(nodes, which, part), p, q, test, cut);
        if found.is_some() {
            return found;
        }
    }
    None
}

/// Finds a pair of triangles of two leaves that satisfies `test`. Triangles are placed only if their boxes are not farther
/// apart than rounding errors and the minimum gap, because a placed triangle is large.
fn search_leaves(scene: &PairFrame, a: &Node, b: &Node, test: PairTest) -> Option<(u32, u32)> {
    let (moving, fixed) = (&scene.moving, &scene.fixed);
    let margin = 4.0 * scene.noise + moving.swell;
    let mut boxes = a.facets().map(|s| (s, moving.facet_bounds(s).expanded(margin)));
    let of_moving: [Option<(usize, Aabb)>; MAX_LEAF_FACETS] = std::array::from_fn(|_| boxes.next());
    for t in b.facets() {
        let bounds = fixed.facet_bounds(t);
        let near = of_moving.iter().flatten().filter(|(_, around)| around.intersects(&bounds));
        for &(s, _) in near {
            if (test.holds)(scene, &Triangle::new(moving, s), &Triangle::new(fixed, t)) {
                return Some((s as u32, t as u32));
            }
        }
    }
    None
}

/// Checks whether two triangles show that the solids overlap: cases 1 to 3.
fn show_overlap(scene: &PairFrame, f: &Triangle, g: &Triangle) -> bool {
    let noise = 4.0 * scene.noise;
    if (0..3).any(|axis| f.bounds.is_separated_along(&g.bounds, axis, noise)) {
        return false;
    }
    if let Some(found) = thin::show_overlap(scene, f, g) {
        return found;
    }
    let of_g = f.corner_sides(scene, g);
    if one_sided(of_g) {
        return false;
    }
    let of_f = g.corner_sides(scene, f);
    if one_sided(of_f) {
        return false;
    }
    let flat = |signs: [Ordering; 3]| signs.iter().all(|s| *s == Ordering::Equal);
    if flat(of_g) || flat(of_f) {
        if !f.is_open() && !g.is_open() {
            let (axis, facing) = f.open_axis(scene);
            let [a, b, c] = &g.corners;
            let other = scene.projected_orientation(axis, a, b, c);
            // As for whole nodes, facets that face each other show no overlap.
            if other == facing.reverse() {
                return false;
            }
            if other == facing && share_a_part(scene, (axis, facing), f, g) {
                return true;
            }
        }
    } else if has_both_signs(of_g) && has_both_signs(of_f) && facets_cross(scene, f, of_f, g, of_g)
    {
        return true;
    }
    (0..3).any(|k| edge_meets(scene, f, k, of_f, g, of_g))
        || (0..3).any(|k| edge_meets(scene, g, k, of_g, f, of_f))
}

/// Checks whether two triangles are certainly nearer than the minimum gap.
fn are_nearer(scene: &PairFrame, f: &Triangle, g: &Triangle) -> bool {
    FacetDifference::new(scene, &f.corners, &g.corners).are_within(scene.core_gap[0], false)
}

/// Checks whether the distance of two triangles is certainly at most the minimum gap.
fn are_as_near(scene: &PairFrame, f: &Triangle, g: &Triangle) -> bool {
    FacetDifference::new(scene, &f.corners, &g.corners).are_within(scene.core_gap[0], true)
}

/// Checks whether two triangles, as closed sets, have a common point. If they do, an edge of one meets the other.
fn share_a_point(scene: &PairFrame, f: &Triangle, g: &Triangle) -> bool {
    let pierces = |f: &Triangle, g: &Triangle| (0..3).any(|k| edge_reaches(scene, f, k, g));
    match [f, g].map(thin::segment_ends) {
        [Some(p), Some(q)] => thin::share_a_point(scene, p, q),
        [Some(_), None] => pierces(f, g),
        [None, Some(_)] => pierces(g, f),
        [None, None] => pierces(f, g) || pierces(g, f),
    }
}

/// Checks whether edge `k` of `f`, ends included, has a common point with `g`, edges included.
fn edge_reaches(scene: &PairFrame, f: &Triangle, k: usize, g: &Triangle) -> bool {
    let (p, q) = (&f.corners[k], &f.corners[(k + 1) % 3]);
    let [a, b, c] = &g.corners;
    let ends = (scene.side_of_plane(a, b, c, p), scene.side_of_plane(a, b, c, q));
    match ends {
        (Ordering::Equal, Ordering::Equal) => {
            let (axis, facing) = g.open_axis(scene);
            let turn = |u: &PlacedVertex, v: &PlacedVertex, w: &PlacedVertex| {
                scene.projected_orientation(axis, u, v, w)
            };
            let of_corners = g.corners.map(|c| turn(p, q, &c));
            let beside = one_sided(of_corners);
            let beyond = (0..3).any(|k| {
                let (a, b) = (&g.corners[k], &g.corners[(k + 1) % 3]);
                turn(a, b, p) == facing.reverse() && turn(a, b, q) == facing.reverse()
            });
            !beside && !beyond
        }
        (x, y) if x == y => false,
        _ => {
            // The line meets the triangle if its orientations relative to the sides do not have opposite signs.
            let turns = [(a, b), (b, c), (c, a)].map(|(u, v)| scene.side_of_plane(p, q, u, v));
            !(turns.contains(&Ordering::Greater) && turns.contains(&Ordering::Less))
        }
    }
}

fn one_sided(signs: [Ordering; 3]) -> bool {
    signs[0] != Ordering::Equal && signs[1] == signs[0] && signs[2] == signs[0]
}

fn has_both_signs(signs: [Ordering; 3]) -> bool {
    signs.contains(&Ordering::Greater) && signs.contains(&Ordering::Less)
}

/// Checks case 1 for triangles that each have corners on both sides of the other's plane.
///
/// The planes intersect in a line, which meets each triangle in a segment. If one corner of each triangle is alone on
/// the upper side of the other plane, the order of two pairs of sides along this line shows whether the segments
/// overlap.
fn facets_cross(
    scene: &PairFrame,
    f: &Triangle,
    of_f: [Ordering; 3],
    g: &Triangle,
    of_g: [Ordering; 3],
) -> bool {
    let (mut p, p_up) = alone_first(f, of_f);
    let (mut q, q_up) = alone_first(g, of_g);
    // Reversing one triangle exchanges the sides of its plane.
    if !p_up {
        q.swap(1, 2);
    }
    if !q_up {
        p.swap(1, 2);
    }
    scene.side_of_plane(p[1], q[0], p[0], q[1]) == Ordering::Less
        && scene.side_of_plane(p[0], q[0], p[2], q[2]) == Ordering::Less
}

/// Returns the corners in their order, beginning with the one that is alone on its side of the other plane, and whether
/// that is the upper side.
fn alone_first<'c>(triangle: &'c Triangle, signs: [Ordering; 3]) -> ([&'c PlacedVertex; 3], bool) {
    let alone = |k: usize| {
        signs[k] != Ordering::Equal
            && signs[(k + 1) % 3] != signs[k]
            && signs[(k + 2) % 3] != signs[k]
    };
    let first = (0..3).find(|&k| alone(k)).unwrap_or(0);
    let corners = [0, 1, 2].map(|k| &triangle.corners[(first + k) % 3]);
    (corners, signs[first] == Ordering::Greater)
}

/// Checks case 2 for triangles in one plane that both have the orientation `facing` about an axis.
fn share_a_part(
    scene: &PairFrame,
    (axis, facing): (usize, Ordering),
    f: &Triangle,
    g: &Triangle,
) -> bool {
    let separates = |f: &Triangle, g: &Triangle| {
        (0..3).any(|k| {
            let (a, b) = (&f.corners[k], &f.corners[(k + 1) % 3]);
            g.corners.iter().all(|c| scene.projected_orientation(axis, a, b, c) != facing)
        })
    };
    !separates(f, g) && !separates(g, f)
}

/// Checks case 3 for edge `k` of `f`.
fn edge_meets(
    scene: &PairFrame,
    f: &Triangle,
    k: usize,
    of_f: [Ordering; 3],
    g: &Triangle,
    of_g: [Ordering; 3],
) -> bool {
    let next = (k + 1) % 3;
    if of_f[k] != Ordering::Equal || of_f[next] != Ordering::Equal {
        return false;
    }
    let (p, q) = (&f.corners[k], &f.corners[next]);
    // A boundary edge has no neighbour.
    let beyond = f.corner_across_edge(k);
    let own = EdgeNeighbourhood::around_edge(
        f.is_open(),
        beyond.is_some(),
        [Ray::towards(0), Ray::towards(1)],
    );
    let Some(own) = own else { return false };
    let (apex, beyond) = (&f.corners[(k + 2) % 3], &beyond.unwrap_or(f.corners[(k + 2) % 3]));
    if runs_through(scene, [p, q], g) {
        let (axis, facing) = g.open_axis(scene);
        let away =
            |c: &&PlacedVertex| scene.projected_orientation(axis, p, q, *c) != Ordering::Equal;
        let Some(w) = g.corners.iter().find(away) else { return false };
        let outwards = scene.projected_orientation(axis, p, q, w) == facing;
        let back = Ray { point: 2, opposite: true };
        let (start, end) = if outwards { (back, Ray::towards(2)) } else { (Ray::towards(2), back) };
        let around = EdgeAxis { scene, p, q, points: [beyond, apex, w, w] };
        let other = EdgeNeighbourhood::around_edge(g.is_open(), true, [start, end]);
        return other.is_some_and(|other| own.overlaps_around(&other, &around));
    }
    (0..3).any(|j| {
        let on_plane = of_g[j] == Ordering::Equal && of_g[(j + 1) % 3] == Ordering::Equal;
        let (r, s) = (&g.corners[j], &g.corners[(j + 1) % 3]);
        let Some(along) = on_plane.then(|| runs_along(scene, [p, q], [r, s])).flatten() else {
            return false;
        };
        let across = g.corner_across_edge(j);
        let other = EdgeNeighbourhood::around_edge(
            g.is_open(),
            across.is_some(),
            [Ray::towards(2), Ray::towards(3)],
        );
        let other = other.map(|other| if along { other } else { other.reversed() });
        let apex_of_g = &g.corners[(j + 2) % 3];
        let points = [beyond, apex, &across.unwrap_or(*apex_of_g), apex_of_g];
        let around = EdgeAxis { scene, p, q, points };
        other.is_some_and(|other| own.overlaps_around(&other, &around))
    })
}

/// The part of a body around an edge.
pub(super) enum EdgeNeighbourhood {
    /// Of a closed shell: a wedge of material.
    Material(Wedge),
    /// Of an open shell: two half-planes.
    Bend([Ray; 2]),
    /// Of an open shell at its boundary: one half-plane.
    Rim(Ray),
}

impl EdgeNeighbourhood {
    /// Returns the part of a body around an edge. The second ray points along the facet whose edge it is, and the first
    /// ray along the neighbour across the edge. Without a neighbour the first ray is ignored. `None` for an edge of a
    /// closed shell without a neighbour.
    pub(super) fn around_edge(
        open: bool,
        has_across: bool,
        [across, own]: [Ray; 2],
    ) -> Option<Self> {
        match (open, has_across) {
            (false, true) => Some(Self::Material(Wedge { start: across, end: own })),
            (false, false) => None,
            (true, true) => Some(Self::Bend([across, own])),
            (true, false) => Some(Self::Rim(own)),
        }
    }

    /// Returns the same neighbourhood for the edge in the opposite direction.
    fn reversed(self) -> Self {
        match self {
            Self::Material(Wedge { start, end }) => {
                Self::Material(Wedge { start: end, end: start })
            }
            other => other,
        }
    }

    pub(super) fn overlaps_around(&self, other: &Self, axis: &impl AxisSigns) -> bool {
        match (self, other) {
            (Self::Material(a), Self::Material(b)) => a.intersects(b, axis),
            (Self::Material(a), rays) | (rays, Self::Material(a)) => {
                rays.half_planes().any(|ray| a.contains_strictly(ray, axis))
            }
            (&Self::Bend([a, b]), &Self::Bend([c, e])) => {
                let (one, rest) = (Wedge { start: a, end: b }, Wedge { start: b, end: a });
                let divides =
                    |c, e| one.contains_strictly(c, axis) && rest.contains_strictly(e, axis);
                divides(c, e) || divides(e, c)
            }
            _ => false,
        }
    }

    fn half_planes(&self) -> impl Iterator<Item = Ray> {
        let rays = match *self {
            Self::Material(_) => [None, None],
            Self::Bend([a, b]) => [Some(a), Some(b)],
            Self::Rim(a) => [Some(a), None],
        };
        rays.into_iter().flatten()
    }
}

/// Checks whether a segment in the plane of a triangle has points in its interior.
fn runs_through(scene: &PairFrame, [p, q]: [&PlacedVertex; 2], g: &Triangle) -> bool {
    let (axis, facing) = g.open_axis(scene);
    let of_corners = g.corners.map(|c| scene.projected_orientation(axis, p, q, &c));
    if !has_both_signs(of_corners) {
        return false;
    }
    !(0..3).any(|k| {
        let (a, b) = (&g.corners[k], &g.corners[(k + 1) % 3]);
        scene.projected_orientation(axis, a, b, p) != facing
            && scene.projected_orientation(axis, a, b, q) != facing
    })
}

/// Checks whether two segments on one line share more than a point. Returns whether they have the same direction;
/// `None` if they share at most a point or lie on different lines.
fn runs_along(
    scene: &PairFrame,
    [p, q]: [&PlacedVertex; 2],
    [r, s]: [&PlacedVertex; 2],
) -> Option<bool> {
    let on_line = |c: &PlacedVertex| {
        (0..3).all(|axis| scene.projected_orientation(axis, p, q, c) == Ordering::Equal)
    };
    if !on_line(r) || !on_line(s) {
        return None;
    }
    let axis = (0..3).find(|&axis| scene.axis_order(axis, p, q) != Ordering::Equal)?;
    let way = scene.axis_order(axis, p, q);
    let along = scene.axis_order(axis, r, s) == way;
    let (first, last) = if along { (r, s) } else { (s, r) };
    let shared = scene.axis_order(axis, first, q) == way && scene.axis_order(axis, p, last) == way;
    shared.then_some(along)
}

/// An edge and the points around it that define rays.
pub(super) struct EdgeAxis<'c, 's, 'a> {
    pub(super) scene: &'s PairFrame<'a>,
    pub(super) p: &'c PlacedVertex,
    pub(super) q: &'c PlacedVertex,
    pub(super) points: [&'c PlacedVertex; 4],
}

impl AxisSigns for EdgeAxis<'_, '_, '_> {
    fn determinant_sign(&self, x: usize, y: usize) -> Ordering {
        self.scene.side_of_plane(self.p, self.q, self.points[x], self.points[y])
    }

    fn same_half(&self, x: usize, y: usize) -> bool {
        let turn =
            |k: usize, axis| self.scene.projected_orientation(axis, self.p, self.q, self.points[k]);
        let axis = (0..3).find(|&axis| turn(x, axis) != Ordering::Equal).unwrap_or(0);
        turn(x, axis) == turn(y, axis)
    }
}
