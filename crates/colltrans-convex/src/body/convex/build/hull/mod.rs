//! Convex hull of a point set of any dimension, with coplanar faces as polygons.
//!
//! 1. [`quickhull`] builds a simplicial hull with exact decisions, from the points that are outside by more than
//!    the tolerance. A mesh that is already convex replaces this step ([`convex_mesh`]).
//! 2. [`merge`] joins coplanar triangles, and finds the vertices that are then redundant.
//! 3. Both steps are repeated without these vertices, until none is redundant. [`planar`] treats points in a plane.
//! 4. [`violation`] bounds the distances of dropped points from the *body*. A point that is too far away is kept
//!    permanently. If that does not help, all corners are kept, and nothing is merged ([`exact_hull`]).
//!
//! The tolerance is [`noise::COPLANAR`] times the largest coordinate; points within it of a face count as on the
//! face. Dropped points are within [`MAX_DISTANCE_FACTOR`] tolerances of the body. Details: `docs/theory/hulls.md`.

mod cone_sectors;
mod convex_mesh;
mod merge;
mod neighbours;
mod planar;
mod quickhull;
mod violation;

use glam::DVec3;

use crate::body::Aabb;
use crate::body::error::{BuildError, TopologyError};
use colltrans_kernel::noise;
use colltrans_kernel::range::is_in_exact_range;
use colltrans_kernel::topology::{Topology, group_by_key};
use quickhull::Simplicial;
use violation::Gauge;
pub(super) use violation::Locator;

/// A selection of input points as vertices, with the faces over them.
#[derive(Debug, Clone)]
pub(crate) struct IndexedHull {
    /// Affine dimension of the points, 0 to 3.
    pub(crate) dimension: u8,
    /// Indices of the vertices in the input.
    pub(crate) vertices: Vec<u32>,
    /// Faces, over positions in `vertices`. A flat polygon has a front and a back face.
    pub(crate) topology: Topology,
    /// Upper bound of the distance of an input point from the body, and of a vertex outside a face plane.
    pub(crate) violation: f64,
    /// Upper bound of the distance of an input point from the body.
    pub(crate) input_excess: f64,
}

/// Maximum number of rounds, each of which builds a hull of fewer points or of more forced points.
const MAX_ROUNDS: usize = 16;

/// Distance from the finished body, in tolerances, beyond which a point is made a vertex. A point within the
/// tolerance of two planes can be this far beyond a sharp edge between them. A body that is hardly thicker than the
/// tolerance has only such edges.
const MAX_DISTANCE_FACTOR: f64 = 16.0;

/// Maximum number of points. It keeps vertex and half-edge numbers within 31 bits.
const MAX_POINTS: usize = (u32::MAX / 16) as usize;

/// Checks that points are finite, in range, and not too many.
///
/// # Errors
/// [`BuildError::NoPoints`], [`BuildError::TooManyPoints`], [`BuildError::NotFinite`], [`BuildError::OutOfRange`].
pub(super) fn check_points(points: &[DVec3]) -> Result<(), BuildError> {
    if points.is_empty() {
        return Err(BuildError::NoPoints);
    }
    if points.len() > MAX_POINTS {
        return Err(BuildError::TooManyPoints { count: points.len(), limit: MAX_POINTS });
    }
    for (index, &point) in points.iter().enumerate() {
        if !point.is_finite() {
            return Err(BuildError::NotFinite { index, point });
        }
        if !is_in_exact_range(point) {
            return Err(BuildError::OutOfRange { index, point });
        }
    }
    Ok(())
}

/// Returns the distance from a face within which points of this size count as on it.
pub(super) fn coplanar_tolerance(points: &[DVec3]) -> f64 {
    let largest = points.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    noise::COPLANAR * largest
}

/// Computes the convex hull of points that [`check_points`] has accepted.
pub(super) fn convex_hull(points: &[DVec3]) -> IndexedHull {
    reduced_hull(points, None)
}

/// Computes the convex hull of a closed surface's vertices, all of which must be in use. It is faster if the
/// surface is this hull already.
pub(super) fn hull_of_mesh(points: &[DVec3], topology: &Topology) -> IndexedHull {
    reduced_hull(points, convex_mesh::simplicial_of_mesh(points, topology))
}

/// Computes the hull without redundant vertices. `known` is a simplicial hull of all points, if there is one.
fn reduced_hull(points: &[DVec3], mut known: Option<Simplicial>) -> IndexedHull {
    let tolerance = coplanar_tolerance(points);
    let mut kept: Vec<u32> = (0..points.len() as u32).collect();
    // Points near the surface, for which the violation is measured.
    let mut near: Vec<u32> = Vec::new();
    let mut forced: Vec<u32> = Vec::new();
    for _ in 0..MAX_ROUNDS {
        let simplicial = match known.take() {
            Some(simplicial) => simplicial,
            None => match quickhull::simplicial_hull(points, &kept, &forced, tolerance) {
                Ok(simplicial) => simplicial,
                // The remaining points may be flat although all points are not.
                Err(_) if kept.len() < points.len() => break,
                Err(flat) => return planar::flat_hull(points, &kept, flat, tolerance),
            },
        };
        near.extend(&simplicial.near);
        let regions = merge::coplanar_regions(points, &simplicial, tolerance);
        let redundant = merge::redundant_corners(points, &simplicial, &regions, tolerance, &forced);
        if redundant.is_empty() {
            let (hull, mut beyond) =
                hull_of_regions(points, &simplicial, &regions, &near, tolerance);
            if beyond.is_empty() {
                return hull;
            }
            beyond.retain(|v| forced.binary_search(v).is_err());
            if beyond.is_empty() {
                // Merging removes the forced points.
                break;
            }
            kept = simplicial.sorted_vertices();
            for list in [&mut kept, &mut forced] {
                list.extend(&beyond);
                list.sort_unstable();
                list.dedup();
            }
            continue;
        }
        let mut rest: Vec<u32> = simplicial.sorted_vertices();
        rest.retain(|v| redundant.binary_search(v).is_err());
        near.extend(&redundant);
        kept = rest;
        // A dropped point must lie on the hull of the others, otherwise it is kept permanently.
        let lost = merge::points_outside(points, &kept, &redundant, tolerance);
        forced.extend(&lost);
        forced.sort_unstable();
        kept.extend(lost);
        kept.sort_unstable();
    }
    exact_hull(points)
}

/// Computes the hull with every point that is a corner in exact arithmetic, unless all points are within the
/// tolerance of a plane. Its faces are triangles.
pub(super) fn exact_hull(points: &[DVec3]) -> IndexedHull {
    let tolerance = coplanar_tolerance(points);
    let all: Vec<u32> = (0..points.len() as u32).collect();
    match quickhull::simplicial_hull(points, &all, &all, tolerance) {
        Ok(simplicial) => {
            let regions = merge::Regions::single_triangles(&simplicial);
            hull_of_regions(points, &simplicial, &regions, &[], tolerance).0
        }
        Err(flat) => planar::flat_hull(points, &all, flat, tolerance),
    }
}

/// Checks whether all points are distinct.
#[cfg(feature = "json")]
pub(super) fn are_distinct(points: &[DVec3]) -> bool {
    let mut all: Vec<_> = points.iter().map(|p| (*p + 0.0).to_array().map(f64::to_bits)).collect();
    all.sort_unstable();
    all.windows(2).all(|pair| pair[0] != pair[1])
}

/// Computes polygons, vertex numbers and the measured violation. Returns also the points that are too far away, in
/// ascending order.
fn hull_of_regions(
    points: &[DVec3],
    simplicial: &Simplicial,
    regions: &merge::Regions,
    near: &[u32],
    tolerance: f64,
) -> (IndexedHull, Vec<u32>) {
    let (vertices, topology) =
        vertices_and_faces(points, simplicial, regions).unwrap_or_else(|_| {
            // Because of rounding, coplanar regions may not fit together; the triangles always do.
            vertices_and_faces(points, simplicial, &merge::Regions::single_triangles(simplicial))
                .expect("the triangles of a simplicial hull are a closed surface")
        });
    // A corner of triangles that have become one polygon may not be a corner of this polygon.
    let others = near.iter().copied().chain(simplicial.sorted_vertices());
    let hull = IndexedHull { dimension: 3, vertices, topology, violation: 0.0, input_excess: 0.0 };
    with_violation(points, hull, others, tolerance)
}

/// Adds the measured violation to a hull with faces. Returns also those of the `others` that are too far away, in
/// ascending order.
fn with_violation(
    points: &[DVec3],
    hull: IndexedHull,
    others: impl Iterator<Item = u32>,
    tolerance: f64,
) -> (IndexedHull, Vec<u32>) {
    let corners: Vec<DVec3> = hull.vertices.iter().map(|&i| points[i as usize]).collect();
    let mut gauge = Gauge::new(&corners, &hull.topology, points.len(), witness_rounding(tolerance));
    let mut beyond = Vec::new();
    let mut face = 0;
    let mut is_vertex = vec![false; points.len()];
    for &v in &hull.vertices {
        is_vertex[v as usize] = true;
    }
    for v in others.filter(|&v| !is_vertex[v as usize]) {
        if gauge.distance_bound(points[v as usize], MAX_DISTANCE_FACTOR * tolerance, &mut face)
            > MAX_DISTANCE_FACTOR * tolerance
        {
            beyond.push(v);
        }
    }
    beyond.sort_unstable();
    beyond.dedup();
    let Gauge { violation, input_excess, .. } = gauge;
    (IndexedHull { violation, input_excess, ..hull }, beyond)
}

/// Returns the rounding error of a witness, for points with this tolerance.
fn witness_rounding(tolerance: f64) -> f64 {
    noise::WITNESS / noise::COPLANAR * tolerance
}

/// Returns the vertices and the faces over them. Small hulls keep the order of the input, because a file usually
/// stores neighbours together.
fn vertices_and_faces(
    points: &[DVec3],
    simplicial: &Simplicial,
    regions: &merge::Regions,
) -> Result<(Vec<u32>, Topology), TopologyError> {
    let (face_start, corners) = merge::region_polygons(simplicial, regions);
    let mut vertices = distinct_sorted(corners.iter().copied());
    let large = vertices.len() > MAX_INPUT_ORDER;
    if large {
        sort_along_curve(points, &mut vertices);
    }
    let mut position = vec![0; points.len()];
    for (k, &v) in vertices.iter().enumerate() {
        position[v as usize] = k as u32;
    }
    let mut face_start = face_start;
    let mut face_vertices: Vec<u32> = corners.iter().map(|&v| position[v as usize]).collect();
    if large {
        (face_start, face_vertices) = sorted_by_vertex(&face_start, &face_vertices);
    }
    let topology = Topology::from_sphere_faces(vertices.len(), face_start, face_vertices)?;
    Ok((vertices, topology))
}

/// Returns the distinct numbers, in ascending order.
fn distinct_sorted(numbers: impl Iterator<Item = u32> + Clone) -> Vec<u32> {
    let mut occurs = vec![false; numbers.clone().max().map_or(0, |most| most as usize + 1)];
    numbers.for_each(|k| occurs[k as usize] = true);
    (0..occurs.len() as u32).filter(|&k| occurs[k as usize]).collect()
}

/// Maximum number of vertices in the order of the input. More vertices are sorted by place, so that vertices that a
/// query visits successively are near in memory. Smaller bodies fit into the fastest cache in any order.
pub(super) const MAX_INPUT_ORDER: usize = 500;

/// Sorts points along a space-filling curve (the Morton curve).
fn sort_along_curve(points: &[DVec3], vertices: &mut [u32]) {
    let at = |v: u32| points[v as usize];
    let bounds = Aabb::from_points(vertices.iter().map(|&v| at(v)));
    let scale = f64::from(1 << 20) / bounds.side_lengths();
    // Casts saturate: all coordinates along an axis without extent are 0.
    let key = |&v: &u32| {
        let cell = (at(v) - bounds.low) * scale;
        spread_bits(cell.x as u32)
            | spread_bits(cell.y as u32) << 1
            | spread_bits(cell.z as u32) << 2
    };
    vertices.sort_by_cached_key(key);
}

/// Spreads the lowest 21 bits so that two zero bits separate them.
fn spread_bits(bits: u32) -> u64 {
    let mut x = u64::from(bits) & 0x1f_ffff;
    x = (x | x << 32) & 0x1f_0000_0000_ffff;
    x = (x | x << 16) & 0x1f_0000_ff00_00ff;
    x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

/// Sorts the faces by their lowest vertices.
fn sorted_by_vertex(face_start: &[u32], face_vertices: &[u32]) -> (Vec<u32>, Vec<u32>) {
    let face = |f: u32| {
        &face_vertices[face_start[f as usize] as usize..face_start[f as usize + 1] as usize]
    };
    let lowest = (0..face_start.len() as u32 - 1).map(|f| face(f).iter().min().copied());
    let most = face_vertices.iter().max().map_or(0, |&v| v as usize);
    let (_, order) = group_by_key(most + 1, lowest.map(Option::unwrap_or_default));
    let mut start = Vec::with_capacity(face_start.len());
    start.push(0);
    let mut vertices = Vec::with_capacity(face_vertices.len());
    for f in order {
        vertices.extend_from_slice(face(f));
        start.push(vertices.len() as u32);
    }
    (start, vertices)
}
