//! Flat faces: connected facets in one plane, and the sweep that intersects two of them.
//!
//! Two faces of many thin facets have about as many crossing pairs of facets as the product of their numbers.
//! Therefore the intersection is found by a sweep over their *rims*, the boundary edges: those that facets of the face
//! use more often in one direction than in the other. Along an axis of the plane, each face is divided into convex
//! strips between two rims. A strip ends where a rim begins or ends. Strips of both faces that overlap along this axis
//! are then intersected.
//!
//! Notation: `n` is the unit normal of a face, that of its largest facet. `x, y` are coordinates in its plane; the
//! sweep is along `x`. Facets are counter-clockwise, so the interior is above a rim that runs along `x` and below one
//! that runs against it. Where a face folds over itself, points covered at least once are inside.

use colltrans::{Aabb, Solid};
use glam::{DVec2, DVec3};

use super::Triangle;

/// Maximum distance of corners from the plane of a face, as a fraction of the reach of contacts.
const MAX_OFFSET: f64 = 1.0 / 1024.0;
/// Minimum cosine between the normals of a facet and its face.
const MIN_COSINE: f64 = 0.5;
/// Marks a side without a unique neighbour.
const NONE: usize = usize::MAX;

/// A face: connected facets of one plane.
pub(super) struct Face {
    /// The facets, the largest first.
    pub(super) facets: Vec<Triangle>,
    pub(super) bounds: Aabb,
    pub(super) normal: DVec3,
    /// The boundary edges, with the orientation of their facets.
    rims: Vec<[DVec3; 2]>,
}

impl Face {
    fn new(solid: &Solid, facets: &[[u32; 3]], normal: DVec3) -> Self {
        let corner = |v: u32| solid.vertices()[v as usize];
        let mut edges: Vec<([u32; 2], bool)> =
            facets.iter().flat_map(|&facet| facet_sides(facet)).collect();
        edges.sort_unstable();
        let alone = edges.chunk_by(|a, b| a.0 == b.0).filter_map(|same| {
            let turned = same.iter().filter(|(_, turned)| *turned).count();
            // Edges with both orientations are interior. In a fold more facets may have one orientation.
            let more = same.len().abs_diff(2 * turned);
            let ([a, b], turned) = (same[0].0.map(corner), 2 * turned > same.len());
            (more > 0).then(|| std::iter::repeat_n(if turned { [b, a] } else { [a, b] }, more))
        });
        let rims: Vec<_> = alone.flatten().collect();
        let facets: Vec<Triangle> = facets.iter().map(|t| t.map(corner)).collect();
        let bounds = Aabb::from_points(facets.iter().flatten().copied());
        Self { facets, bounds, normal, rims }
    }

    /// Returns the faces of the facets that meet a region, those of the largest facets first.
    pub(super) fn all_in(solid: &Solid, region: &Aabb, reach: f64) -> Vec<Self> {
        let corner = |v: u32| solid.vertices()[v as usize];
        let within = |t: &[u32; 3]| Aabb::from_points(t.map(corner)).intersects(region);
        let facets: Vec<[u32; 3]> = solid.triangles().iter().copied().filter(within).collect();
        let areas: Vec<DVec3> = facets.iter().map(|t| twice_area(&t.map(corner))).collect();
        let mut order: Vec<usize> = (0..facets.len()).collect();
        order.sort_by(|&a, &b| areas[b].length_squared().total_cmp(&areas[a].length_squared()));
        let neighbours = facet_neighbours(&facets);
        let mut taken = vec![false; facets.len()];
        let mut faces = Vec::new();
        for seed in order {
            let Some(normal) = areas[seed].try_normalize().filter(|_| !taken[seed]) else {
                continue;
            };
            let foot = normal.dot(corner(facets[seed][0]));
            taken[seed] = true;
            let mut own = vec![seed];
            let mut next = 0;
            while let Some(&at) = own.get(next) {
                next += 1;
                for other in neighbours[at].into_iter().filter(|&other| other != NONE) {
                    let flat = |v: u32| (normal.dot(corner(v)) - foot).abs() <= reach * MAX_OFFSET;
                    let along = areas[other].dot(normal) >= MIN_COSINE * areas[other].length();
                    if !taken[other] && along && facets[other].into_iter().all(flat) {
                        taken[other] = true;
                        own.push(other);
                    }
                }
            }
            let own: Vec<[u32; 3]> = own.into_iter().map(|k| facets[k]).collect();
            faces.push(Self::new(solid, &own, normal));
        }
        faces
    }

    /// Returns points whose convex hull contains the face: starts of its rims, or corners of its facets if these are
    /// fewer.
    pub(super) fn corners(&self) -> impl Iterator<Item = DVec3> {
        let few = 3 * self.facets.len() < self.rims.len();
        let facets = self.facets.iter().flatten().filter(move |_| few);
        let rims = self.rims.iter().map(|rim| &rim[0]).filter(move |_| !few);
        facets.chain(rims).copied()
    }

    /// Returns the total length of its rims.
    pub(super) fn perimeter(&self) -> f64 {
        self.rims.iter().map(|[a, b]| a.distance(*b)).sum()
    }
}

/// Returns the sides of a facet, the smaller vertex first, and whether the facet has the reversed orientation.
fn facet_sides([a, b, c]: [u32; 3]) -> [([u32; 2], bool); 3] {
    [[a, b], [b, c], [c, a]].map(|[a, b]| ([a.min(b), a.max(b)], a > b))
}

/// Returns for each side the other facet that has it, if there is exactly one, otherwise [`NONE`].
fn facet_neighbours(facets: &[[u32; 3]]) -> Vec<[usize; 3]> {
    let mut edges: Vec<([u32; 2], usize, usize)> = Vec::with_capacity(3 * facets.len());
    for (k, facet) in facets.iter().enumerate() {
        edges.extend(
            facet_sides(*facet).into_iter().enumerate().map(|(side, (ends, _))| (ends, k, side)),
        );
    }
    edges.sort_unstable();
    let mut across = vec![[NONE; 3]; facets.len()];
    for same in edges.chunk_by(|a, b| a.0 == b.0) {
        if let &[(_, a, i), (_, b, j)] = same {
            across[a][i] = b;
            across[b][j] = a;
        }
    }
    across
}

/// Returns the normal of a triangle, with twice its area as length.
pub(super) fn twice_area(t: &Triangle) -> DVec3 {
    (t[1] - t[0]).cross(t[2] - t[0])
}

/// The part of a face between two rims and two positions along `x`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Strip {
    x: [f64; 2],
    low: [f64; 2],
    high: [f64; 2],
}

impl Strip {
    /// Returns its corners, counter-clockwise.
    pub(super) fn corners(&self) -> [DVec2; 4] {
        let ([l, r], low, high) = (self.x, self.low, self.high);
        [(l, low[0]), (r, low[1]), (r, high[1]), (l, high[0])].map(|(x, y)| DVec2::new(x, y))
    }

    fn overlaps_across(&self, other: &Self) -> bool {
        let ends = |s: &Self| [s.low[0].min(s.low[1]), s.high[0].max(s.high[1])];
        let ([low, high], [least, most]) = (ends(self), ends(other));
        low < most && least < high
    }
}

/// The strips of a face in the order of `x`; those of one position from below.
pub(super) struct Swept(Vec<Strip>);

impl Swept {
    /// Divides a face into strips within a range of `x`. `flat` returns plane coordinates of a point. `way` is 1, or
    /// -1 if facets are clockwise in these.
    pub(super) fn new(
        face: &Face,
        flat: impl Fn(DVec3) -> DVec2,
        way: f64,
        [from, to]: [f64; 2],
    ) -> Self {
        let mut rims: Vec<[DVec2; 2]> = face.rims.iter().map(|rim| rim.map(&flat)).collect();
        if way < 0.0 {
            for rim in &mut rims {
                rim.swap(0, 1);
            }
        }
        // Sort from left to right. Rims parallel to `y` bound nothing.
        let mut lines: Vec<([DVec2; 2], i32)> = rims
            .into_iter()
            .filter(|[a, b]| a.x != b.x)
            .map(|[a, b]| if a.x < b.x { ([a, b], 1) } else { ([b, a], -1) })
            .collect();
        lines.sort_by(|a, b| a.0[0].x.total_cmp(&b.0[0].x));
        let mut places: Vec<f64> = lines.iter().flat_map(|(line, _)| line.map(|p| p.x)).collect();
        places.extend([from, to]);
        places.retain(|x| (from..=to).contains(x));
        places.sort_unstable_by(f64::total_cmp);
        places.dedup();
        let mut strips = Vec::new();
        let (mut active, mut next) = (Vec::new(), lines.into_iter().peekable());
        for x in places.windows(2).map(|x| [x[0], x[1]]) {
            active.retain(|(line, _): &([DVec2; 2], i32)| line[1].x > x[0]);
            while let Some(line) = next.next_if(|(line, _)| line[0].x <= x[0]) {
                if line.0[1].x > x[0] {
                    active.push(line);
                }
            }
            strips_between(&active, x, &mut strips);
        }
        Self(strips)
    }

    /// Calls a function with all pairs of strips that may intersect.
    pub(super) fn each_pair(&self, other: &Self, mut call: impl FnMut(&Strip, &Strip)) {
        let (mut first, all) = (0, &other.0);
        for own in &self.0 {
            while all.get(first).is_some_and(|strip| strip.x[1] <= own.x[0]) {
                first += 1;
            }
            for strip in all[first..].iter().take_while(|strip| strip.x[0] < own.x[1]) {
                if own.overlaps_across(strip) {
                    call(own, strip);
                }
            }
        }
    }
}

/// Adds the strips between lines that have no end between two positions.
fn strips_between(active: &[([DVec2; 2], i32)], x: [f64; 2], strips: &mut Vec<Strip>) {
    let at = |[a, b]: [DVec2; 2], x: f64| {
        let share = ((x - a.x) / (b.x - a.x)).clamp(0.0, 1.0);
        if share < 1.0 { a.y + (b.y - a.y) * share } else { b.y }
    };
    let mut lines: Vec<([f64; 2], i32)> =
        active.iter().map(|&(line, way)| (x.map(|x| at(line, x)), way)).collect();
    lines.sort_by(|a, b| (a.0[0] + a.0[1]).total_cmp(&(b.0[0] + b.0[1])));
    let (mut inside, mut low) = (0, [0.0; 2]);
    for (y, way) in lines {
        if inside <= 0 && inside + way > 0 {
            low = y;
        } else if inside > 0 && inside + way <= 0 {
            strips.push(Strip { x, low, high: y });
        }
        inside += way;
    }
}
