//! Merges coplanar triangles into polygons.
//!
//! - *region*: a connected set of triangles whose corners all lie within the tolerance of one plane, that of its
//!   largest triangle. Slivers among them are included without regard to their own normals, which are meaningless.
//! - *redundant* point: fewer than three planes of regions meet there, so it lies inside a face or inside an edge.

use glam::DVec3;

use super::quickhull::{Simplicial, Triangle, simplicial_hull};
use colltrans_kernel::visit_counter;

/// Marks a triangle without a region, and an unused entry.
const NONE: u32 = u32::MAX;

/// The partition of the triangles into regions; `region_of` has a number for each triangle.
#[derive(Debug)]
pub(super) struct Regions {
    region_of: Vec<u32>,
    count: u32,
    /// For each region the triangle that defines its plane.
    seed: Vec<u32>,
}

impl Regions {
    /// Returns the partition in which every triangle is a region.
    pub(super) fn single_triangles(simplicial: &Simplicial) -> Self {
        let count = simplicial.triangles.len() as u32;
        Self { region_of: (0..count).collect(), count, seed: (0..count).collect() }
    }
}

/// Computes the regions by growing them from the largest triangles. Regions that are not polygons are split into
/// triangles.
pub(super) fn coplanar_regions(
    points: &[DVec3],
    simplicial: &Simplicial,
    tolerance: f64,
) -> Regions {
    let triangles = &simplicial.triangles;
    let area = |t: u32| {
        let [a, b, c] = triangles[t as usize].corners.map(|i| points[i as usize]);
        (b - a).cross(c - a).length_squared()
    };
    if !(0..triangles.len() as u32).any(|t| has_coplanar_neighbour(points, triangles, t, tolerance))
    {
        return Regions::single_triangles(simplicial);
    }
    let mut seeds: Vec<(f64, u32)> = (0..triangles.len() as u32).map(|t| (area(t), t)).collect();
    seeds.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut regions =
        Regions { region_of: vec![NONE; triangles.len()], count: 0, seed: Vec::new() };
    let mut members = Vec::new();
    for (_, seed) in seeds {
        if regions.region_of[seed as usize] == NONE {
            members.clear();
            grow_region(points, simplicial, tolerance, seed, &mut regions, &mut members);
            if members.len() > 1 && !is_polygon(points, simplicial, &regions, &members, tolerance) {
                split_region(&mut regions, &members);
            }
        }
    }
    regions
}

/// Checks whether a triangle's plane contains a neighbour.
fn has_coplanar_neighbour(
    points: &[DVec3],
    triangles: &[Triangle],
    t: u32,
    tolerance: f64,
) -> bool {
    let plane = &triangles[t as usize];
    plane
        .neighbours
        .into_iter()
        .any(|n| lies_in_plane(points, &triangles[n as usize], plane, tolerance))
}

/// Checks whether all corners of a triangle lie within the tolerance of another triangle's plane.
fn lies_in_plane(points: &[DVec3], inner: &Triangle, plane: &Triangle, tolerance: f64) -> bool {
    let origin = points[plane.corners[0] as usize];
    let on_plane = |i: u32| plane.normal.dot(points[i as usize] - origin).abs() <= tolerance;
    inner.corners.into_iter().all(on_plane)
}

/// Grows a region from a seed triangle, and lists its triangles in `members`.
fn grow_region(
    points: &[DVec3],
    simplicial: &Simplicial,
    tolerance: f64,
    seed: u32,
    regions: &mut Regions,
    members: &mut Vec<u32>,
) {
    let triangles = &simplicial.triangles;
    let plane = &triangles[seed as usize];
    regions.region_of[seed as usize] = regions.count;
    regions.seed.push(seed);
    members.push(seed);
    let mut k = 0;
    while k < members.len() {
        visit_counter::count_visits(1);
        for n in triangles[members[k] as usize].neighbours {
            let free = regions.region_of[n as usize] == NONE;
            if free && lies_in_plane(points, &triangles[n as usize], plane, tolerance) {
                regions.region_of[n as usize] = regions.count;
                members.push(n);
            }
        }
        k += 1;
    }
    regions.count += 1;
}

/// Checks whether connected triangles form one disk that is a polygon: their rim is one loop of at least three
/// corners, and no corner points inwards by more than the tolerance. A climb would end at such a corner because the
/// edges that continue it are inside.
fn is_polygon(
    points: &[DVec3],
    simplicial: &Simplicial,
    regions: &Regions,
    members: &[u32],
    tolerance: f64,
) -> bool {
    let rim = rim_edges(simplicial, regions, members);
    let Some(corners) = rim.first().and_then(|&start| trace_rim(simplicial, regions, start)) else {
        return false;
    };
    let normal = simplicial.triangles[members[0] as usize].normal;
    let at = |k: usize| points[corners[k % corners.len()] as usize];
    let is_reflex = |k: usize| {
        let [from, corner, to] = [at(k), at(k + 1), at(k + 2)];
        let chord = to - from;
        normal.dot(chord.cross(corner - from)) > tolerance * chord.length()
    };
    corners.len() >= 3 && corners.len() == rim.len() && !(0..corners.len()).any(is_reflex)
}

/// Returns the edges `(triangle, side)` of a region that border on another region.
fn rim_edges(simplicial: &Simplicial, regions: &Regions, members: &[u32]) -> Vec<(u32, usize)> {
    let region = regions.region_of[members[0] as usize];
    members
        .iter()
        .flat_map(|&t| (0..3).map(move |side| (t, side)))
        .filter(|&(t, side)| {
            let other = simplicial.triangles[t as usize].neighbours[side];
            regions.region_of[other as usize] != region
        })
        .collect()
}

/// Returns the corners along a region's rim, starting at one of its edges. Returns `None` if the rim passes a
/// corner twice.
fn trace_rim(simplicial: &Simplicial, regions: &Regions, start: (u32, usize)) -> Option<Vec<u32>> {
    let triangles = &simplicial.triangles;
    let region = regions.region_of[start.0 as usize];
    let (mut t, mut side) = start;
    let mut corners = Vec::new();
    loop {
        corners.push(triangles[t as usize].corners[side]);
        visit_counter::count_visits(1);
        // Rotate around the end of the edge, triangle by triangle, to the next edge of the rim.
        side = (side + 1) % 3;
        loop {
            let other = triangles[t as usize].neighbours[side];
            if regions.region_of[other as usize] != region {
                break;
            }
            visit_counter::count_visits(1);
            let pivot = triangles[t as usize].corners[side];
            let at = triangles[other as usize].corners.iter().position(|&c| c == pivot)?;
            (t, side) = (other, at);
        }
        if (t, side) == start {
            break;
        }
        if corners.len() > 3 * triangles.len() {
            return None;
        }
    }
    let mut sorted = corners.clone();
    sorted.sort_unstable();
    sorted.windows(2).all(|w| w[0] != w[1]).then_some(corners)
}

/// Makes every triangle of a region a region of its own.
fn split_region(regions: &mut Regions, members: &[u32]) {
    for &t in &members[1..] {
        regions.region_of[t as usize] = regions.count;
        regions.seed.push(t);
        regions.count += 1;
    }
}

/// Returns the corners around which fewer than three planes meet, in ascending order, without those in `forced`.
///
/// Two regions in one plane count once, because slivers along an edge can separate the parts of a face.
pub(super) fn redundant_corners(
    points: &[DVec3],
    simplicial: &Simplicial,
    regions: &Regions,
    tolerance: f64,
    forced: &[u32],
) -> Vec<u32> {
    let size = simplicial.triangles.iter().flat_map(|t| t.corners).max().unwrap_or(0) as usize + 1;
    // At most three regions in different planes found at each corner.
    let mut planes = vec![[NONE; 3]; size];
    for (triangle, &region) in simplicial.triangles.iter().zip(&regions.region_of) {
        for v in triangle.corners {
            let found = &mut planes[v as usize];
            let is_same = |&r: &u32| {
                r == region
                    || are_coplanar(
                        points,
                        simplicial,
                        [r, region].map(|r| regions.seed[r as usize]),
                        tolerance,
                    )
            };
            let count = found.iter().take_while(|&&r| r != NONE).count();
            if count < 3 && !found[..count].iter().any(is_same) {
                found[count] = region;
            }
        }
    }
    (0..size as u32)
        .filter(|&v| planes[v as usize][0] != NONE && planes[v as usize][2] == NONE)
        .filter(|v| forced.binary_search(v).is_err())
        .collect()
}

/// Checks whether each of two triangles lies in the other's plane, with normals on the same side.
fn are_coplanar(
    points: &[DVec3],
    simplicial: &Simplicial,
    [a, b]: [u32; 2],
    tolerance: f64,
) -> bool {
    let [a, b] = [a, b].map(|t| &simplicial.triangles[t as usize]);
    a.normal.dot(b.normal) > 0.0
        && lies_in_plane(points, a, b, tolerance)
        && lies_in_plane(points, b, a, tolerance)
}

/// Returns the `dropped` points that lie outside the hull of the `kept` points by more than twice the tolerance.
/// Returns all of them if the `kept` points span no volume.
pub(super) fn points_outside(
    points: &[DVec3],
    kept: &[u32],
    dropped: &[u32],
    tolerance: f64,
) -> Vec<u32> {
    if kept.len() < 4 {
        return dropped.to_vec();
    }
    let Ok(hull) = simplicial_hull(points, kept, &[], tolerance) else { return dropped.to_vec() };
    let locator = super::violation::Locator::new(points, &hull);
    let mut near = 0;
    dropped
        .iter()
        .copied()
        .filter(|&v| locator.distance_outside(points[v as usize], &mut near) > 2.0 * tolerance)
        .collect()
}

/// Returns the rims of the regions: the position of the first corner of each, and the corners as point numbers.
pub(super) fn region_polygons(simplicial: &Simplicial, regions: &Regions) -> (Vec<u32>, Vec<u32>) {
    let mut start = vec![0];
    let mut corners = Vec::new();
    let mut done = vec![false; regions.count as usize];
    for (t, triangle) in simplicial.triangles.iter().enumerate() {
        let region = regions.region_of[t];
        if done[region as usize] {
            continue;
        }
        let rim = (0..3).find(|&k| regions.region_of[triangle.neighbours[k] as usize] != region);
        let Some(side) = rim else { continue };
        done[region as usize] = true;
        if triangle.neighbours.iter().all(|&n| regions.region_of[n as usize] != region) {
            corners.extend(triangle.corners);
            start.push(corners.len() as u32);
            continue;
        }
        if let Some(loop_) = trace_rim(simplicial, regions, (t as u32, side)) {
            corners.extend(loop_);
            start.push(corners.len() as u32);
        }
    }
    (start, corners)
}
