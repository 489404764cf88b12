//! The least translation that parts two bodies, over all directions: the point of the surface of `M` nearest
//! to the origin (van den Bergen's expanding polytope).
//!
//! A polytope of points of `M` grows where it is nearest to the origin: the lowest point beyond its nearest
//! face joins it, with a fan of triangles to the rim of all that it sees. It need not contain the origin to
//! begin with: faces that have the origin outside are the nearest of all, and either grow or part the bodies.
//!
//! Notation. The *height* of a triangle for a unit vector `n` is the least of `n . m` over its corners `m`:
//! no point of the triangle is nearer to the origin. `n` is the triangle's own normal, outwards, or that of a
//! neighbour, if it has hardly any area of its own.
//!
//! Invariant. The bounds are those of what was proposed, whatever rounding has made of the polytope:
//!
//! - *Lower.* The least height, less what rounding can make of it ([`height_lowered`](colltrans_kernel::noise::Noise::height_lowered)). `M` contains each triangle;
//!   a closed surface of triangles, each counter-clockwise as seen from the origin's other side or without
//!   area, meets each ray from the origin, so that `M`, being convex, contains a ball as large as the least
//!   height. That they are so is decided exactly, in the check as well.
//! - *Upper.* `max_M n.m`, with one noise for rounding and what bodies reach beyond support points.

use glam::DVec3;

use super::gjk::unit;
use super::winding::winds;
use super::{Difference, Found};
use crate::answer::Enclosure;
use crate::setting::VertexPair;
use colltrans_kernel::plane::triangle_normal;

/// More steps than were ever seen.
const MOST: usize = 2_000;

/// How far apart bounds may be, in noises, before another polytope is tried.
const OPEN: f64 = 8.0;

/// Points that there is room for at first: few enough for allocators to be quick.
const ROOM: usize = 12;

/// The best plane, and the polytope.
pub(crate) struct Deepest {
    /// Outward unit normal of `M`, along which the moving body has to go.
    pub(crate) outward: DVec3,
    /// How far, rounded up.
    pub(crate) upper: f64,
    /// What is proven of it from below.
    pub(crate) lower: f64,
    /// What proves that.
    pub(crate) enclosure: Enclosure,
    /// How far bodies may reach beyond support points along the normal.
    pub(crate) beyond: f64,
    /// How many lowest points were looked for, with those of the distance.
    pub(crate) supports: u32,
}

/// A triangle of the polytope, counter-clockwise as seen from outside.
#[derive(Clone, Copy)]
struct Triangle {
    corners: [u32; 3],
    normal: DVec3,
    height: f64,
    /// Whether nothing of `M` lies beyond it.
    done: bool,
    /// Whether the point that is about to join sees it.
    seen: bool,
}

/// A vertex of `M`.
#[derive(Clone, Copy)]
struct Point {
    at: DVec3,
    pair: VertexPair,
}

/// A polytope of points of `M`.
struct Polytope<'a> {
    difference: &'a Difference<'a>,
    points: Vec<DVec3>,
    pairs: Vec<VertexPair>,
    triangles: Vec<Triangle>,
    /// Kept for its memory.
    rim: Vec<[u32; 2]>,
}

/// How deep the bodies overlap, from what was found of their distance: at least, as soon as that is more than `enough`.
pub(crate) fn deepest(difference: &Difference, found: &Found, enough: f64) -> Deepest {
    let mut best = Deepest {
        outward: DVec3::X,
        upper: f64::INFINITY,
        lower: 0.0,
        enclosure: Enclosure::default(),
        beyond: 0.0,
        supports: found.supports,
    };
    if let Some(plane) = found.plane(difference) {
        best.note(-plane.gap.normal, -plane.gap.gap, plane.beyond);
    }
    let pairs: Vec<VertexPair> = found.simplex().collect();
    grow_from(difference, &pairs, &mut best, enough);
    if best.lower <= enough && best.upper - best.lower > OPEN * difference.noise.point() {
        // Slivers may leave no way to grow; from elsewhere there are others.
        let first = difference.lowest(-best.outward, None).pair;
        best.supports += 1;
        grow_from(difference, &[first], &mut best, enough);
    }
    best
}

/// Grows a polytope that begins with some pairs, and notes what it proves.
fn grow_from(difference: &Difference, pairs: &[VertexPair], best: &mut Deepest, enough: f64) {
    if let Some(mut polytope) = Polytope::begin(difference, pairs, best) {
        polytope.grow(best, enough);
        polytope.prove(best);
    }
}

impl Deepest {
    /// A supporting plane with an outward normal, and how far `M` reaches along it, rounded up.
    fn note(&mut self, outward: DVec3, reach: f64, beyond: f64) {
        if reach < self.upper {
            self.upper = reach.max(0.0);
            self.outward = outward;
            self.beyond = beyond;
        }
    }
}

impl<'a> Polytope<'a> {
    /// A tetrahedron of points of `M`; `None` if that is flat to rounding, as is noted then.
    fn begin(difference: &'a Difference, pairs: &[VertexPair], best: &mut Deepest) -> Option<Self> {
        let mut new = Self {
            difference,
            points: Vec::with_capacity(ROOM),
            pairs: Vec::with_capacity(ROOM),
            triangles: Vec::with_capacity(ROOM),
            rim: Vec::with_capacity(ROOM),
        };
        for pair in pairs {
            new.add(Point { at: difference.point(*pair), pair: *pair });
        }
        if new.points.len() < 4 || new.thickness() <= 8.0 * difference.noise.point() {
            new.points.truncate(1);
            new.pairs.truncate(1);
            new.widen(best)?;
        }
        let volume = (new.points[1] - new.points[0])
            .cross(new.points[2] - new.points[0])
            .dot(new.points[3] - new.points[0]);
        if volume > 0.0 {
            new.points.swap(0, 1);
            new.pairs.swap(0, 1);
        }
        for corners in [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]] {
            new.push(corners);
        }
        Some(new)
    }

    fn add(&mut self, corner: Point) {
        self.points.push(corner.at);
        self.pairs.push(corner.pair);
    }

    /// The height of the fourth point over the others.
    fn thickness(&self) -> f64 {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| self.points[k]);
        let normal = triangle_normal([a, b, c]).normalize_or_zero();
        normal.dot(d - a).abs()
    }

    /// Adds points that are far from each other, a line and a plane, until there are four.
    fn widen(&mut self, best: &mut Deepest) -> Option<()> {
        for count in 1..4 {
            let first = self.points[0];
            let across = |k: usize| self.points[k] - first;
            let axes = match count {
                1 => vec![DVec3::X, DVec3::Y, DVec3::Z],
                2 => {
                    let line = unit(across(1))?;
                    let aside = line.any_orthonormal_vector();
                    vec![aside, line.cross(aside)]
                }
                _ => vec![unit(triangle_normal([first, self.points[1], self.points[2]]))?],
            };
            let (mut farthest, mut most) = (None, 8.0 * self.difference.noise.point());
            for outward in axes.into_iter().flat_map(|axis| [axis, -axis]) {
                let point = self.support(outward, self.pairs[0], best);
                let away = outward.dot(point.at - first);
                if away > most {
                    (farthest, most) = (Some(point), away);
                }
            }
            self.add(farthest?);
        }
        Some(())
    }

    /// The point farthest along a unit vector, from a pair that may be near; how far that is, is noted. A climb
    /// may have stuck before it, where that makes no difference yet.
    fn support(&self, outward: DVec3, near: VertexPair, best: &mut Deepest) -> Point {
        let noise = self.difference.noise;
        let bodies = self.difference.bodies;
        let normals = [bodies.moving_normal(-outward), bodies.fixed_normal(-outward)];
        let found = self.difference.climbed(&normals, Some(near));
        best.supports += 1;
        let at = self.difference.point(found);
        if outward.dot(at) >= best.upper {
            return Point { at, pair: found };
        }
        let (pair, beyond) = bodies.support_with_excess(&normals, found);
        let at = if pair == found { at } else { self.difference.point(pair) };
        let raised = (outward.dot(at) + noise.lowered() + beyond).next_up();
        best.note(outward, raised, beyond);
        Point { at, pair }
    }

    fn push(&mut self, corners: [u32; 3]) {
        let at = corners.map(|k| self.points[k as usize]);
        let normal = unit(triangle_normal(at)).unwrap_or(DVec3::ZERO);
        let height = self.height(corners, normal);
        self.triangles.push(Triangle { corners, normal, height, done: false, seen: false });
    }

    fn height(&self, corners: [u32; 3], normal: DVec3) -> f64 {
        corners.map(|k| normal.dot(self.points[k as usize])).into_iter().fold(f64::MAX, f64::min)
    }

    /// Grows where the polytope is nearest to the origin, until its faces there are those of `M`, or far enough.
    fn grow(&mut self, best: &mut Deepest, enough: f64) {
        let noise = self.difference.noise.point();
        let enough = enough + 2.0 * self.difference.noise.height_lowered();
        for _ in 0..MOST {
            let nearest = self.nearest();
            let Triangle { corners, normal, height, done, .. } = self.triangles[nearest];
            if best.upper - height <= 2.5 * noise || best.upper == 0.0 || height > enough {
                return;
            }
            if done {
                if !self.borrow_normal(nearest) {
                    return;
                }
                continue;
            }
            let point = self.support(normal, self.pairs[corners[0] as usize], best);
            let beyond = normal.dot(point.at) - height;
            if beyond <= noise || self.pairs.contains(&point.pair) || !self.insert(nearest, point) {
                self.triangles[nearest].done = true;
            }
        }
    }

    /// The triangle of the least height, the first of several.
    fn nearest(&self) -> usize {
        let (mut nearest, mut least) = (0, f64::INFINITY);
        for (which, triangle) in self.triangles.iter().enumerate() {
            if triangle.height < least {
                (nearest, least) = (which, triangle.height);
            }
        }
        nearest
    }

    /// Takes for a triangle, whose own normal is of no use, that of a neighbour if it is higher for that.
    fn borrow_normal(&mut self, which: usize) -> bool {
        let Triangle { corners, height, .. } = self.triangles[which];
        let shares = |other: &Triangle| {
            other.corners.iter().filter(|corner| corners.contains(corner)).count() >= 2
        };
        let normals = self.triangles.iter().filter(|other| shares(other)).map(|other| other.normal);
        let higher = normals
            .map(|normal| (self.height(corners, normal), normal))
            .max_by(|a, b| a.0.total_cmp(&b.0));
        match higher {
            Some((other, normal)) if other > height => {
                let triangle = &mut self.triangles[which];
                (triangle.height, triangle.normal) = (other, normal);
                true
            }
            _ => false,
        }
    }

    /// Replaces what a new point sees, the triangle it was found for in any case, by a fan. `false`, and
    /// nothing changes, if that would not be a surface any more.
    fn insert(&mut self, nearest: usize, point: Point) -> bool {
        let noise = self.difference.noise.point();
        for triangle in &mut self.triangles {
            triangle.seen = triangle.normal.dot(point.at) - triangle.height > noise;
        }
        self.triangles[nearest].seen = true;
        let mut rim = std::mem::take(&mut self.rim);
        let is_surface = self.widen_rim(point.at, &mut rim);
        if is_surface {
            self.triangles.retain(|triangle| !triangle.seen);
            let new = self.points.len() as u32;
            self.add(point);
            for &[x, y] in &rim {
                self.push([x, y, new]);
            }
        }
        self.rim = rim;
        is_surface
    }

    /// The rim of the triangles seen, and more of them where the fan would be without area: the triangle
    /// beyond goes as well. `false` if the rim is not one polygon.
    fn widen_rim(&mut self, at: DVec3, rim: &mut Vec<[u32; 2]>) -> bool {
        loop {
            self.find_rim(rim);
            let flat = rim.iter().find(|[x, y]| self.is_flat(*x, *y, at));
            let Some(&[x, y]) = flat else { break };
            let beyond =
                |t: &Triangle| (0..3).any(|k| [t.corners[k], t.corners[(k + 1) % 3]] == [y, x]);
            match self.triangles.iter_mut().find(|t| beyond(t)) {
                Some(other) if !other.seen => other.seen = true,
                _ => return false,
            }
        }
        let starts_before = |k: usize| rim[..k].iter().any(|edge| edge[0] == rim[k][0]);
        rim.len() >= 3 && !(0..rim.len()).any(starts_before)
    }

    /// Directed edges of the triangles seen whose opposite is of none of them.
    fn find_rim(&self, rim: &mut Vec<[u32; 2]>) {
        rim.clear();
        for triangle in self.triangles.iter().filter(|triangle| triangle.seen) {
            let [a, b, c] = triangle.corners;
            for [x, y] in [[a, b], [b, c], [c, a]] {
                match rim.iter().position(|edge| *edge == [y, x]) {
                    Some(opposite) => drop(rim.swap_remove(opposite)),
                    None => rim.push([x, y]),
                }
            }
        }
    }

    /// Whether a point is on the line through two, to rounding.
    fn is_flat(&self, x: u32, y: u32, at: DVec3) -> bool {
        let [x, y] = [x, y].map(|k| self.points[k as usize]);
        let edge = y - x;
        let noise = self.difference.noise.point();
        edge.cross(at - x).length_squared() <= noise * noise * edge.length_squared()
    }

    /// The least height as a bound, if the surface is around the origin, exactly.
    fn prove(self, best: &mut Deepest) {
        let noise = self.difference.noise;
        let least = self.triangles.iter().map(|t| t.height).fold(f64::MAX, f64::min);
        let lower = (least - noise.height_lowered()).next_down();
        if lower <= best.lower {
            return;
        }
        let enclosure = Enclosure {
            pairs: self.pairs,
            triangles: self.triangles.iter().map(|t| t.corners).collect(),
            normals: self.triangles.iter().map(|t| t.normal).collect(),
        };
        // Closed it is: a fan takes the place of what has the same rim.
        if winds(self.difference.bodies, &self.points, &enclosure) {
            best.lower = lower;
            best.enclosure = enclosure;
        }
    }
}
