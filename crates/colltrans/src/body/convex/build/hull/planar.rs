//! Hulls without volume: a point, a segment, a flat polygon.

use glam::{DVec2, DVec3};

use super::Hull;
use super::quickhull::Flat;
use crate::body::topology::Topology;

pub(super) fn hull(points: &[DVec3], kept: &[u32], flat: Flat, tolerance: f64) -> Hull {
    match flat {
        Flat::Point(a) => without_faces(points, kept, &[a]),
        Flat::Segment(ends) => without_faces(points, kept, &ends),
        Flat::Plane(normal) => polygon(points, kept, normal, tolerance),
    }
}

fn without_faces(points: &[DVec3], kept: &[u32], vertices: &[u32]) -> Hull {
    let mut vertices = vertices.to_vec();
    vertices.sort_unstable();
    let origin = points[vertices[0] as usize];
    let axis = vertices.get(1).map_or(DVec3::ZERO, |&b| (points[b as usize] - origin).normalize());
    let off = |i: &u32| {
        let p = points[*i as usize] - origin;
        (p - axis * p.dot(axis)).length()
    };
    let violation = kept.iter().map(off).fold(0.0, f64::max);
    Hull {
        dimension: vertices.len() as u8 - 1,
        topology: Topology::without_faces(vertices.len()),
        vertices,
        violation,
    }
}

/// A polygon as a front and a back face; a segment if all points turn out to lie on one line.
fn polygon(points: &[DVec3], kept: &[u32], normal: DVec3, tolerance: f64) -> Hull {
    let plane = Projection { points, main: normal.abs().max_position(), normal };
    let corners = plane.corners(kept, tolerance);
    let &[first, .., last] = &corners[..] else { return without_faces(points, kept, &corners) };
    if corners.len() == 2 {
        return without_faces(points, kept, &[first, last]);
    }
    let mut vertices = corners.clone();
    vertices.sort_unstable();
    let position = |v: &u32| vertices.binary_search(v).unwrap_or(0) as u32;
    let mut face_vertices: Vec<u32> = corners.iter().map(position).collect();
    let back: Vec<u32> = face_vertices.iter().rev().copied().collect();
    face_vertices.extend(back);
    let count = corners.len() as u32;
    let violation = plane.violation(kept, &corners);
    let topology = Topology::sphere(vertices.len(), vec![0, count, 2 * count], &face_vertices)
        .expect("the front and the back of a polygon are a closed surface");
    Hull { dimension: 2, vertices, topology, violation }
}

/// Points in a plane, on the two coordinates orthogonal to its normal's largest component.
struct Projection<'a> {
    points: &'a [DVec3],
    /// The coordinate left out.
    main: usize,
    normal: DVec3,
}

impl Projection<'_> {
    fn at(&self, i: u32) -> DVec3 {
        self.points[i as usize]
    }

    fn project(&self, i: u32) -> DVec2 {
        let p = self.at(i);
        let (x, y) = (p[(self.main + 1) % 3], p[(self.main + 2) % 3]);
        if self.normal[self.main] < 0.0 { DVec2::new(y, x) } else { DVec2::new(x, y) }
    }

    /// The corners, counter-clockwise around the normal from the one with least `x`: a monotone
    /// chain on exact orientations; then corners within the tolerance of the line between their
    /// neighbours go.
    fn corners(&self, kept: &[u32], tolerance: f64) -> Vec<u32> {
        let project = |i: u32| self.project(i);
        let mut order = kept.to_vec();
        order.sort_unstable_by(|&a, &b| {
            let (p, q) = (project(a), project(b));
            p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)).then(a.cmp(&b))
        });
        order.dedup_by_key(|i| project(*i).to_array());
        let mut chain = half_chain(order.iter().copied(), &project);
        let upper = half_chain(order.iter().rev().copied(), &project);
        chain.pop();
        chain.extend(&upper[..upper.len() - 1]);
        self.drop_collinear(&chain, tolerance)
    }

    fn drop_collinear(&self, chain: &[u32], tolerance: f64) -> Vec<u32> {
        let is_on_line = |a: u32, b: u32, c: u32| {
            let [a, b, c] = [a, b, c].map(|i| self.at(i));
            (b - a).cross((c - a).normalize_or_zero()).length() <= tolerance
        };
        let mut corners: Vec<u32> = Vec::with_capacity(chain.len());
        for &c in chain {
            while let [.., a, b] = corners[..] {
                if !is_on_line(a, b, c) {
                    break;
                }
                corners.pop();
            }
            corners.push(c);
        }
        // The chain starts at a corner for its least `x`, which only its tolerance can dispute.
        while let [first, .., a, b] = corners[..] {
            if corners.len() <= 3 || !is_on_line(a, b, first) {
                break;
            }
            corners.pop();
        }
        if let [first, second, _, .., last] = corners[..]
            && is_on_line(last, first, second)
        {
            corners.remove(0);
        }
        corners
    }

    /// The largest distance of a point from the plane, or outside the polygon's edges in it.
    fn violation(&self, kept: &[u32], corners: &[u32]) -> f64 {
        let origin = self.at(corners[0]);
        let count = corners.len();
        // From least to greatest `x` along the lower chain, then back along the upper one.
        let x = |k: usize| self.project(corners[k % count]).x;
        let start = (0..count).min_by(|&a, &b| x(a).total_cmp(&x(b))).unwrap_or(0);
        let turn = (0..count).max_by(|&a, &b| x(start + a).total_cmp(&x(start + b))).unwrap_or(0);
        let outside = |k: usize, p: DVec3| {
            let (a, b) = (self.at(corners[k % count]), self.at(corners[(k + 1) % count]));
            (b - a).cross(self.normal).normalize_or_zero().dot(p - a)
        };
        let of_point = |&i: &u32| {
            let (p, px) = (self.at(i), self.project(i).x);
            let lower = first_from(0, turn, |k| x(start + k) >= px);
            let upper = first_from(turn, count, |k| x(start + k) <= px);
            let near =
                [lower, upper].into_iter().flat_map(|k| (0..3).map(move |j| k + count + j - 2));
            near.map(|k| outside(start + k, p)).fold(self.normal.dot(p - origin).abs(), f64::max)
        };
        kept.iter().map(of_point).fold(0.0, f64::max)
    }
}

/// The first number from `low` on, at most `high`, for which a condition holds that holds for all
/// greater ones.
fn first_from(mut low: usize, mut high: usize, holds: impl Fn(usize) -> bool) -> usize {
    while low < high {
        let middle = low.midpoint(high);
        if holds(middle) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    low
}

fn half_chain(order: impl Iterator<Item = u32>, project: &dyn Fn(u32) -> DVec2) -> Vec<u32> {
    let coord = |i: u32| {
        let p = project(i);
        robust::Coord { x: p.x, y: p.y }
    };
    let mut chain: Vec<u32> = Vec::new();
    for i in order {
        while let [.., a, b] = chain[..] {
            if robust::orient2d(coord(a), coord(b), coord(i)) > 0.0 {
                break;
            }
            chain.pop();
        }
        chain.push(i);
    }
    chain
}
