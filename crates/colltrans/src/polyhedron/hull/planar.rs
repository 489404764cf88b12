//! Hulls without volume: a point, a segment, a flat polygon.

use glam::{DVec2, DVec3};

use super::Hull;
use super::quickhull::Flat;
use crate::topology::Topology;

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

/// A polygon as a front and a back face.
fn polygon(points: &[DVec3], kept: &[u32], normal: DVec3, tolerance: f64) -> Hull {
    let corners = corners(points, kept, normal, tolerance);
    let mut vertices = corners.clone();
    vertices.sort_unstable();
    let position = |v: &u32| vertices.binary_search(v).unwrap_or(0) as u32;
    let mut face_vertices: Vec<u32> = corners.iter().map(position).collect();
    let back: Vec<u32> = face_vertices.iter().rev().copied().collect();
    face_vertices.extend(back);
    let count = corners.len() as u32;
    let origin = points[corners[0] as usize];
    let height = |i: &u32| normal.dot(points[*i as usize] - origin).abs();
    let flat = kept.iter().map(height).fold(0.0, f64::max);
    let sideways = kept.iter().map(|&i| outside(points, &corners, normal, points[i as usize]));
    let violation = sideways.fold(flat, f64::max);
    let topology = Topology::from_faces(vertices.len(), vec![0, count, 2 * count], &face_vertices)
        .expect("the front and the back of a polygon are a closed surface");
    Hull { dimension: 2, vertices, topology, violation }
}

/// How far a point lies outside the edges of a polygon, in its plane.
fn outside(points: &[DVec3], corners: &[u32], normal: DVec3, p: DVec3) -> f64 {
    let at = |k: usize| points[corners[k % corners.len()] as usize];
    (0..corners.len())
        .map(|k| (at(k + 1) - at(k)).cross(normal).normalize_or_zero().dot(p - at(k)))
        .fold(f64::NEG_INFINITY, f64::max)
}

/// The corners, counter-clockwise around `normal`: a monotone chain on the coordinates orthogonal to the normal's largest
/// component, on exact orientations; then corners within the tolerance of the line between their neighbours go.
fn corners(points: &[DVec3], kept: &[u32], normal: DVec3, tolerance: f64) -> Vec<u32> {
    let main = normal.abs().max_position();
    let flip = normal[main] < 0.0;
    let project = |i: u32| {
        let p = points[i as usize];
        let (x, y) = (p[(main + 1) % 3], p[(main + 2) % 3]);
        if flip { DVec2::new(y, x) } else { DVec2::new(x, y) }
    };
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
    drop_collinear(points, chain, tolerance)
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

fn drop_collinear(points: &[DVec3], mut corners: Vec<u32>, tolerance: f64) -> Vec<u32> {
    let at = |i: u32| points[i as usize];
    let mut k = 0;
    let mut unchanged = 0;
    while corners.len() > 3 && unchanged < corners.len() {
        let count = corners.len();
        k %= count;
        let (a, b, c) =
            (at(corners[(k + count - 1) % count]), at(corners[k]), at(corners[(k + 1) % count]));
        let along = (c - a).normalize_or_zero();
        if (b - a).cross(along).length() <= tolerance {
            corners.remove(k);
            unchanged = 0;
            k = (k + count - 2) % (count - 1);
        } else {
            unchanged += 1;
            k += 1;
        }
    }
    corners
}
