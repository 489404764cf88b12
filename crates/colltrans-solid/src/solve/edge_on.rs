//! Edge-on facets: facets of open shells that are parallel to the direction.
//!
//! Their shadows are segments without interior. Nevertheless a sheet cannot pass edge-on through a solid or another
//! sheet. Such a facet blocks if, moved by `t d` with `t > 0`,
//! 1. a *leading* side, which the rest of the facet is behind, enters the interior of a solid over an open part of its
//!    shadow;
//! 2. a leading side crosses a facet of an open shell that is not edge-on, or two of them that meet at an edge;
//! 3. its interior meets that of an edge-on facet of the other body in its own plane;
//! 4. it crosses an edge-on facet of another plane over the one common point of their shadows; or
//! 5. it is a point, or a segment parallel to the direction, whose *tip* enters or passes the other body.
//!
//! All signs are exact, and gaps are exact except for their last roundings. Details: `docs/theory/edge-on-facets.md`.

use std::cmp::Ordering;
use std::cmp::Ordering::{Equal, Greater, Less};

use super::fan::Fan;
use super::leaf::{Above, Facet, Gap, Meeting, NO_GAP, over_facet, over_side};
use super::line::{self, Line, LineDirection};
use super::scene::{PairFrame, PlacedBody, PlacedVertex};
use crate::body::edges::NO_NEIGHBOUR;
use colltrans_convex::body::Aabb;
use colltrans_kernel::integer::{Integer, LARGE_LIMBS, SMALL_LIMBS};

/// A facet of an open shell that is parallel to the direction.
pub(crate) struct EdgeOnFacet {
    triangle: u32,
    corners: [PlacedVertex; 3],
    moving: bool,
    /// For each side `k`, from corner `k` to the next one: `Greater` if the rest of the facet is behind it, `Less` if
    /// it is ahead, `Equal` if the side is vertical.
    leads: [Ordering; 3],
    /// The corners at the ends of the shadow.
    ends: [usize; 2],
    bounds: Aabb,
}

/// Checks whether two nodes may have edge-on facets to compare: one of them has facets of an open shell.
pub(crate) fn may_have_edge_on(scene: &PairFrame, nodes: [u32; 2]) -> bool {
    // With a minimum gap, edge-on facets are treated like all others.
    !scene.has_min_gap()
        && [true, false]
            .into_iter()
            .zip(nodes)
            .any(|(moving, node)| scene.side(moving).solid.nodes()[node as usize].is_open())
}

/// Returns the least gap that counts, and its error, of two triangles of which one is an edge-on facet, the moving
/// body's first; `None` if no gap counts.
pub(crate) fn least_gap_of(
    scene: &PairFrame,
    counts: &dyn Fn(&Gap) -> bool,
    pair: [u32; 2],
) -> Option<(f64, f64)> {
    let mut least: Option<(f64, f64)> = None;
    each_gap_of(scene, pair, &mut |_, gap| {
        if counts(&gap) && least.is_none_or(|(value, _)| gap.least < value) {
            least = Some((gap.least, gap.error));
        }
    });
    least
}

/// Calls `take` with the gaps of two triangles of which one is an edge-on facet.
pub(crate) fn each_gap_of(
    scene: &PairFrame,
    [s, t]: [u32; 2],
    take: &mut dyn FnMut([u32; 2], Gap),
) {
    if scene.has_min_gap() {
        return;
    }
    let upright = |moving, t: u32| {
        let open = scene.side(moving).solid.is_open(t as usize);
        open.then(|| EdgeOnFacet::new(scene, moving, t as usize)).flatten()
    };
    let (f, g) = (upright(true, s), upright(false, t));
    if f.is_none() && g.is_none() {
        return;
    }
    let front = Facet::facing(scene, true, s as usize, Greater);
    let back = Facet::facing(scene, false, t as usize, Less);
    each_gap(scene, (f.as_slice(), front.as_slice()), (g.as_slice(), back.as_slice()), take);
}

/// Calls `take` with each gap of an edge-on facet of one leaf and the contents of the other leaf. These are its edge-on
/// facets, and its facets that face along the direction for the moving body, or against it for the fixed one.
pub(crate) fn each_gap(
    scene: &PairFrame,
    (uprights, front): (&[EdgeOnFacet], &[Facet]),
    (others, back): (&[EdgeOnFacet], &[Facet]),
    take: &mut dyn FnMut([u32; 2], Gap),
) {
    for f in uprights {
        for g in back {
            f.with_facet(scene, g, &mut |gap| take([f.triangle, g.triangle], gap));
        }
        for g in others {
            if let Some(gap) = with_upright(scene, f, g) {
                take([f.triangle, g.triangle], gap);
            }
        }
    }
    for g in others {
        for f in front {
            g.with_facet(scene, f, &mut |gap| take([f.triangle, g.triangle], gap));
        }
    }
}

impl EdgeOnFacet {
    /// Returns the edge-on facets of a leaf.
    pub(crate) fn of_leaf(scene: &PairFrame, moving: bool, node: u32) -> Vec<Self> {
        let solid = scene.side(moving).solid;
        let open = solid.nodes()[node as usize].facets().filter(|&t| solid.is_open(t));
        open.filter_map(|t| Self::new(scene, moving, t)).collect()
    }

    /// Builds an edge-on facet; `None` if the triangle is not edge-on.
    pub(crate) fn new(scene: &PairFrame, moving: bool, triangle: usize) -> Option<Self> {
        let corners = scene.side(moving).corners(triangle);
        let [a, b, c] = &corners;
        if scene.turn(a, b, c) != Equal {
            return None;
        }
        let bounds = Aabb::from_triangle(corners.map(|c| c.at));
        let mut upright = Self {
            triangle: triangle as u32,
            corners,
            moving,
            leads: [Equal; 3],
            ends: [0, 1],
            bounds,
        };
        upright.leads = if scene.side(moving).solid.is_without_area(triangle) {
            upright.leads_of_segment(scene)
        } else {
            [0, 1, 2].map(|k| upright.side_lead(scene, k))
        };
        // The two corners that are farthest apart along the shadow.
        let axis = upright.ordering_axis(scene);
        let order =
            |i: usize, j: usize| scene.drift_sign(axis, &upright.corners[i], &upright.corners[j]);
        let extreme = |way| (0..3).find(|&i| (0..3).all(|j| order(i, j) != way)).unwrap_or(0);
        upright.ends = [extreme(Less), extreme(Greater)];
        Some(upright)
    }

    fn side_ends(&self, k: usize) -> [&PlacedVertex; 2] {
        [&self.corners[k], &self.corners[(k + 1) % 3]]
    }

    fn shadow_end(&self, k: usize) -> &PlacedVertex {
        &self.corners[self.ends[k]]
    }

    /// Returns an axis of the world such that [`PairFrame::drift_sign`] along it orders positions along the shadow.
    fn ordering_axis(&self, scene: &PairFrame) -> usize {
        let apart = |axis: usize| {
            (0..3).any(|k| {
                let [a, b] = self.side_ends(k);
                scene.drift_sign(axis, a, b) != Equal
            })
        };
        (0..3).find(|&axis| apart(axis)).unwrap_or(0)
    }

    fn side_lead(&self, scene: &PairFrame, k: usize) -> Ordering {
        let ([p, q], r) = (self.side_ends(k), &self.corners[(k + 2) % 3]);
        // An axis of the world along which the projection of the facet has an area. The projection shows on which side
        // of `p q` the corner `r` lies, and to which side the direction leads.
        let rest = |axis: &usize| scene.projected_orientation(*axis, p, q, r) != Equal;
        let Some(axis) = (0..3).find(rest) else { return Equal };
        let rest = scene.projected_orientation(axis, p, q, r);
        let ahead = scene.drift_sign(axis, p, q).reverse();
        match (ahead == Equal, (ahead == rest) == self.moving) {
            (true, _) => Equal,
            (_, true) => Less,
            (_, false) => Greater,
        }
    }

    /// Returns the `leads` of a point or a segment, whose sides run forth and back. All are `Equal` if its shadow is a
    /// point.
    fn leads_of_segment(&self, scene: &PairFrame) -> [Ordering; 3] {
        let [a, b, _] = &self.corners;
        let is_point = (0..3).all(|axis| scene.drift_sign(axis, a, b) == Equal);
        if is_point { [Equal; 3] } else { [Greater, Equal, Less] }
    }

    /// Returns the number of the leading corner of a point or segment whose shadow is a point; `None` for other facets.
    fn tip_corner(&self, scene: &PairFrame) -> Option<u8> {
        if self.leads != [Equal; 3] {
            return None;
        }
        let [a, b, _] = &self.corners;
        let direction = scene.setting.direction;
        let axis = direction.abs().max_position();
        let second_is_higher = match scene.axis_order(axis, a, b) {
            Equal => false,
            order => (order == Less) == (direction[axis] > 0.0),
        };
        Some(u8::from(second_is_higher == self.moving && scene.axis_order(axis, a, b) != Equal))
    }

    /// Computes the gap of a tip and a facet of the other body; `None` if the tip does not meet the facet or is not
    /// blocked by it.
    fn tip_and_facet(&self, scene: &PairFrame, tip: u8, facet: &Facet) -> Option<Gap> {
        let corner = &self.corners[usize::from(tip)];
        let turns = [0, 1, 2].map(|j| {
            let [a, b] = facet.side_ends(j);
            scene.turn(a, b, corner)
        });
        if turns.contains(&Less) {
            return None;
        }
        if !self.blocks_tip(scene, corner, facet, turns) {
            return None;
        }
        let mut gap = NO_GAP;
        let at = if self.moving { Meeting::Corner(tip) } else { Meeting::Under(tip) };
        gap.add_corner(scene, self.gap_from_height(over_facet(scene, facet, corner)), at);
        Some(gap)
    }

    /// Checks whether the facet blocks the tip, according to the sides of the facet that the tip meets.
    fn blocks_tip(
        &self,
        scene: &PairFrame,
        tip: &PlacedVertex,
        facet: &Facet,
        turns: [Ordering; 3],
    ) -> bool {
        let line = Line { from: tip, way: LineDirection::Query { forward: self.moving } };
        let side = scene.side(!self.moving);
        if !side.solid.is_open(facet.triangle as usize) {
            return line::enters_body(scene, &line, side, facet.triangle, true);
        }
        let on: Vec<usize> = (0..3).filter(|&j| turns[j] == Equal).collect();
        match on[..] {
            [] => true,
            [j] => enters_at_side(scene, self.moving, facet, j),
            [j, k, ..] => {
                let shared = if k == j + 1 { k } else { j };
                let fan = Fan::new(scene, side, facet.triangle, &facet.corners[shared]);
                fan.is_some_and(|fan| fan.is_passed(&line))
            }
        }
    }

    fn leading_sides(&self) -> impl Iterator<Item = usize> + '_ {
        (0..3).filter(|&k| self.leads[k] == Greater)
    }

    /// Checks whether boxes show that the shadows are disjoint.
    fn is_beside(&self, scene: &PairFrame, bounds: &Aabb) -> bool {
        (0..2).any(|axis| self.bounds.is_separated_along(bounds, axis, 4.0 * scene.noise))
    }

    /// Calls `take` with the gaps of the leading sides, or of the tip, and a facet of the other body.
    fn with_facet(&self, scene: &PairFrame, facet: &Facet, take: &mut dyn FnMut(Gap)) {
        if self.is_beside(scene, &facet.bounds) {
            return;
        }
        if let Some(tip) = self.tip_corner(scene) {
            self.tip_and_facet(scene, tip, facet).into_iter().for_each(&mut *take);
        }
        for k in self.leading_sides() {
            if let Some(gap) = self.side_and_facet(scene, k, facet) {
                take(gap);
            }
        }
    }

    fn side_and_facet(&self, scene: &PairFrame, k: usize, facet: &Facet) -> Option<Gap> {
        let [p, q] = self.side_ends(k);
        let of_side = facet.corners.each_ref().map(|c| scene.turn(p, q, c));
        let turns: [[Ordering; 2]; 3] = std::array::from_fn(|j| {
            let [a, b] = facet.side_ends(j);
            [scene.turn(a, b, p), scene.turn(a, b, q)]
        });
        let along = |j: usize| of_side[j] == Equal && of_side[(j + 1) % 3] == Equal;
        if let Some(j) = (0..3).find(|&j| along(j)) {
            let side = Named { corners: facet.side_ends(j), number: j };
            let own = Named { corners: [p, q], number: k };
            return enters_at_side(scene, self.moving, facet, j)
                .then(|| self.shared_side_gap(scene, own, side))
                .flatten();
        }
        let divided = of_side.contains(&Greater) && of_side.contains(&Less);
        if !divided || turns.iter().any(|t| !t.contains(&Greater)) {
            return None;
        }
        let mut gap = NO_GAP;
        for (end, corner) in [p, q].into_iter().enumerate() {
            if turns.iter().all(|t| t[end] != Less) {
                let at = ((k + end) % 3) as u8;
                let at = if self.moving { Meeting::Corner(at) } else { Meeting::Under(at) };
                gap.add_corner(scene, self.gap_from_height(over_facet(scene, facet, corner)), at);
            }
        }
        for j in 0..3 {
            let next = (j + 1) % 3;
            if are_opposite(turns[j]) && are_opposite([of_side[j], of_side[next]]) {
                let (at, other) = (k as u8, j as u8);
                let at = if self.moving { [at, other] } else { [other, at] };
                let above = over_side(scene, facet.side_ends(j), [p, q]);
                gap.add_corner(scene, self.gap_from_height(above), Meeting::Sides(at[0], at[1]));
            }
            if of_side[j] == Equal && is_between(scene, &facet.corners[j], [p, q]) {
                let above = over_line(scene, &facet.corners[j], [p, q]);
                gap.add_corner(scene, self.gap_from_height(above), self.at_corner(k, j));
            }
        }
        Some(gap)
    }

    /// Converts the height of this facet above the other body's to a gap between the moving and the fixed body.
    fn gap_from_height(&self, above: Above) -> Above {
        if self.moving { above.reversed() } else { above }
    }

    /// Returns the meeting of side `k` with a corner of the other body.
    fn at_corner(&self, k: usize, corner: usize) -> Meeting {
        if self.moving {
            Meeting::UnderSide(k as u8, corner as u8)
        } else {
            Meeting::OnSide(corner as u8, k as u8)
        }
    }

    /// Computes the gap over the common shadow of a side of this facet and a side of the other body.
    fn shared_side_gap(&self, scene: &PairFrame, own: Named, other: Named) -> Option<Gap> {
        let [moving, fixed] = if self.moving { [own, other] } else { [other, own] };
        collinear_gap(scene, moving, fixed)
    }

    /// Returns the two arms of the facet at a point of its shadow. In the interior of the shadow they are its ends. At
    /// an end with a vertical side they are the facet's other end, and the apex of the neighbour across that side.
    /// `None` if the facet merely ends there.
    fn arms_at(&self, scene: &PairFrame, end: Option<usize>) -> Option<[PlacedVertex; 2]> {
        let Some(end) = end else { return Some([*self.shadow_end(0), *self.shadow_end(1)]) };
        let upright = (0..3).find(|&k| self.leads[k] == Equal)?;
        let [a, b] = self.side_ends(upright);
        let is_at_end = |c: &PlacedVertex| c.local == self.shadow_end(end).local;
        if !is_at_end(a) && !is_at_end(b) {
            return None;
        }
        let apex = neighbour_corner(scene.side(self.moving), self.triangle as usize, upright)?;
        Some([*self.shadow_end(1 - end), apex])
    }

    /// Finds a leading side whose shadow reaches or crosses the line of another edge-on facet's shadow.
    fn leading_at(&self, scene: &PairFrame, other: &Self) -> Option<usize> {
        self.leading_sides().find(|&k| {
            let [p, q] =
                self.side_ends(k).map(|c| scene.turn(other.shadow_end(0), other.shadow_end(1), c));
            p != q
        })
    }
}

/// A side of a facet and its number.
#[derive(Clone, Copy)]
struct Named<'c> {
    corners: [&'c PlacedVertex; 2],
    number: usize,
}

/// Returns the corner across side `k` of a triangle, in its original order; `None` at a boundary.
fn neighbour_corner(side: &PlacedBody, triangle: usize, k: usize) -> Option<PlacedVertex> {
    let n = side.solid.neighbours()[triangle][k];
    let own = side.solid.triangles()[triangle];
    let ends = [own[k], own[(k + 1) % 3]];
    let apex = |n: u32| side.solid.triangles()[n as usize].into_iter().find(|v| !ends.contains(v));
    (n != NO_NEIGHBOUR).then(|| apex(n)).flatten().map(|v| side.corner(v))
}

/// Checks whether an edge-on facet of the body given by `moving` enters the other body at side `j` of a facet, along
/// which it runs. For an open facet, checks whether a facet or a point passes this side.
fn enters_at_side(scene: &PairFrame, moving: bool, facet: &Facet, j: usize) -> bool {
    let side = scene.side(!moving);
    let t = facet.triangle as usize;
    let (solid, listed) = (side.solid, facet.side_ends(j).map(|c| c.local));
    let own = side.corners(t);
    let is_side = |k: &usize| {
        let ends = [own[*k].local, own[(k + 1) % 3].local];
        ends == listed || [ends[1], ends[0]] == listed
    };
    let Some(k) = (0..3).find(is_side) else { return false };
    let Some(apex) = neighbour_corner(side, t, k) else { return false };
    let [a, b] = facet.side_ends(j);
    if solid.is_open(t) {
        return scene.turn(a, b, &apex) == Less;
    }
    let [x, y, z] = side.corners(solid.neighbours()[t][k] as usize);
    let entered = if side.moving { Greater } else { Less };
    scene.turn(&x, &y, &z) == entered
        || scene.side_of_plane(&own[0], &own[1], &own[2], &apex) == Greater
}

/// Computes the gap of a moving and a fixed edge-on facet; `None` if they do not meet.
fn with_upright(scene: &PairFrame, f: &EdgeOnFacet, g: &EdgeOnFacet) -> Option<Gap> {
    if f.is_beside(scene, &g.bounds) {
        return None;
    }
    let of_f = [0, 1].map(|k| scene.turn(f.shadow_end(0), f.shadow_end(1), g.shadow_end(k)));
    if of_f == [Equal; 2] { in_one_plane(scene, f, g) } else { crossing_gap(scene, f, g, of_f) }
}

/// Computes the gap of case 3: the least gap of the leading sides, and the sign of the largest gap of the trailing
/// ones.
fn in_one_plane(scene: &PairFrame, f: &EdgeOnFacet, g: &EdgeOnFacet) -> Option<Gap> {
    let sides =
        |upright: &EdgeOnFacet, k: usize| -> [PlacedVertex; 2] { upright.side_ends(k).map(|c| *c) };
    let mut gap: Option<Gap> = None;
    let (mut least, mut largest) = (Greater, Less);
    for wanted in [Greater, Less] {
        for (k, j) in (0..9).map(|n| (n / 3, n % 3)) {
            if f.leads[k] != wanted || g.leads[j] != wanted {
                continue;
            }
            let ([a, b], [c, e]) = (sides(f, k), sides(g, j));
            let own = Named { corners: [&a, &b], number: k };
            let Some(found) = collinear_gap(scene, own, Named { corners: [&c, &e], number: j })
            else {
                continue;
            };
            if wanted == Less {
                largest = largest.max(found.signs[1]);
            } else {
                least = least.min(found.signs[0]);
                if gap.is_none_or(|gap| found.least < gap.least) {
                    gap = Some(found);
                }
            }
        }
    }
    gap.map(|gap| Gap { signs: [least, largest], ..gap })
}

/// Computes the gap of case 4.
fn crossing_gap(
    scene: &PairFrame,
    f: &EdgeOnFacet,
    g: &EdgeOnFacet,
    of_f: [Ordering; 2],
) -> Option<Gap> {
    let of_g = [0, 1].map(|k| scene.turn(g.shadow_end(0), g.shadow_end(1), f.shadow_end(k)));
    let apart = |t: [Ordering; 2]| t[0] == t[1];
    if apart(of_f) || apart(of_g) {
        return None;
    }
    let [end_of_g, end_of_f] = [of_f, of_g].map(|t| (0..2).find(|&k| t[k] == Equal));
    let (arms_of_f, arms_of_g) = (f.arms_at(scene, end_of_f)?, g.arms_at(scene, end_of_g)?);
    let crosses = match (end_of_f, end_of_g) {
        (None, None) => true,
        (_, None) => {
            are_opposite(arms_of_f.map(|c| scene.turn(g.shadow_end(0), g.shadow_end(1), &c)))
        }
        (None, _) => {
            are_opposite(arms_of_g.map(|c| scene.turn(f.shadow_end(0), f.shadow_end(1), &c)))
        }
        (Some(k), Some(_)) => arms_cross(scene, f.shadow_end(k), &arms_of_f, &arms_of_g),
    };
    if !crosses {
        return None;
    }
    let (k, j) = (f.leading_at(scene, g)?, g.leading_at(scene, f)?);
    let mut gap = NO_GAP;
    let above = over_side(scene, g.side_ends(j), f.side_ends(k)).reversed();
    gap.add_corner(scene, above, Meeting::Sides(k as u8, j as u8));
    Some(gap)
}

/// Checks whether the shadows of two pairs of arms cross at the shadow of a corner.
fn arms_cross(
    scene: &PairFrame,
    at: &PlacedVertex,
    f: &[PlacedVertex; 2],
    g: &[PlacedVertex; 2],
) -> bool {
    // Sector of a corner, counter-clockwise from the first arm of `f`: 0 along it, 1 below a half turn, 2 opposite to
    // it, 3 above a half turn.
    let same = |a: &PlacedVertex, b: &PlacedVertex| {
        let axis = (0..3).find(|&axis| scene.drift_sign(axis, at, a) != Equal).unwrap_or(0);
        scene.drift_sign(axis, at, a) == scene.drift_sign(axis, at, b)
    };
    let sector = |c: &PlacedVertex| match scene.turn(at, &f[0], c) {
        Greater => 1,
        Less => 3,
        Equal if same(&f[0], c) => 0,
        Equal => 2,
    };
    let second = sector(&f[1]);
    // Position relative to the second arm of `f`: `Less` before it, `Greater` behind it, `Equal` along either arm.
    let place = |c: &PlacedVertex| match (sector(c), second) {
        (0, _) | (_, 0) => Equal,
        (a, b) if a != b => a.cmp(&b),
        (2, _) => Equal,
        _ => scene.turn(at, &f[1], c),
    };
    are_opposite([place(&g[0]), place(&g[1])])
}

/// Computes the gap of two sides whose shadows lie on one line, over their common part; `None` if this part is a point
/// at most.
fn collinear_gap(scene: &PairFrame, f: Named, g: Named) -> Option<Gap> {
    let [p, q] = f.corners;
    let axis = (0..3).find(|&axis| scene.drift_sign(axis, p, q) != Equal)?;
    let way = scene.drift_sign(axis, p, q);
    let ordered = |[a, b]: [&PlacedVertex; 2]| {
        if scene.drift_sign(axis, a, b) == way { [0, 1] } else { [1, 0] }
    };
    let ([first, last], [start, end]) = (ordered(f.corners), ordered(g.corners));
    let before = |a: &PlacedVertex, b: &PlacedVertex| scene.drift_sign(axis, a, b) == way;
    let (f_at, g_at) = (|k: usize| f.corners[k], |k: usize| g.corners[k]);
    if !before(f_at(first), g_at(end)) || !before(g_at(start), f_at(last)) {
        return None;
    }
    let mut gap = NO_GAP;
    let number = |named: Named, end: usize| ((named.number + end) % 3) as u8;
    for ([k, j], inner) in [
        ([first, start], before(f_at(first), g_at(start))),
        ([last, end], before(g_at(end), f_at(last))),
    ] {
        if inner {
            let above = over_line(scene, g_at(j), f.corners).reversed();
            gap.add_corner(scene, above, Meeting::UnderSide(f.number as u8, number(g, j)));
        } else {
            let above = over_line(scene, f_at(k), g.corners);
            gap.add_corner(scene, above, Meeting::OnSide(number(f, k), g.number as u8));
        }
    }
    Some(gap)
}

fn are_opposite([a, b]: [Ordering; 2]) -> bool {
    a != Equal && a == b.reverse()
}

/// Checks whether the shadow of a corner, on the line of a side's shadow, lies strictly within that shadow.
fn is_between(scene: &PairFrame, corner: &PlacedVertex, [p, q]: [&PlacedVertex; 2]) -> bool {
    let apart = |axis: &usize| scene.drift_sign(*axis, p, q) != Equal;
    let Some(axis) = (0..3).find(apart) else { return false };
    let way = scene.drift_sign(axis, p, q);
    scene.drift_sign(axis, p, corner) == way && scene.drift_sign(axis, corner, q) == way
}

/// Computes the height of side `a b` above a corner whose shadow lies on the line of the side's shadow.
fn over_line(scene: &PairFrame, corner: &PlacedVertex, [a, b]: [&PlacedVertex; 2]) -> Above {
    fn height_over_line<const N: usize>(
        scene: &PairFrame,
        [a, b, c]: [&PlacedVertex; 3],
        [axis, height]: [usize; 2],
    ) -> Option<Above> {
        let direction = scene.setting.direction.to_array().map(Integer::<N>::exact_number);
        // Coordinate along the shadow: the component of `v x d` along the axis.
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let place = |v: &[Integer<N>; 3]| {
            v[i].multiply(&direction[j]).subtract(&v[j].multiply(&direction[i]))
        };
        let [side, _, from] = scene.spans_wide::<N>(a, [b, b, c]);
        let (whole, part) = (place(&side), place(&from));
        // a + part / whole (b - a) - c, along the direction.
        let rise = side[height].multiply(&part).subtract(&from[height].multiply(&whole));
        Above::new(&rise, &whole.multiply(&direction[height]))
    }
    let apart = |axis: &usize| scene.drift_sign(*axis, a, b) != Equal;
    let axis = (0..3).find(apart).unwrap_or(0);
    let (height, all) = (scene.setting.direction.abs().max_position(), [a, b, corner]);
    let small = height_over_line::<SMALL_LIMBS>(scene, all, [axis, height]);
    small
        .or_else(|| height_over_line::<LARGE_LIMBS>(scene, all, [axis, height]))
        .unwrap_or(Above::LEVEL)
}
