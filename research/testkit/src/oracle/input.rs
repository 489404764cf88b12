//! Compares a body with the convex hull of its input points.
//!
//! Notation. `I` is the convex hull of the input points, `K` that of the body's vertices, and `h` its
//! [`hull_error`](ConvexPolyhedron::hull_error). [`judge`] checks in exact arithmetic:
//!
//! - (a) `K <= I`: every vertex equals an input point, bit by bit.
//! - (b) `I <= K + B(h)`: no point is farther from `K` than `h`. It suffices to check the points, because the
//!   distance from a convex set is convex.
//!
//! Let `M_K` and `M_I` be the differences `{q - p}` of both bodies, and `h` the sum of their errors. Then `M_K
//! <= M_I <= M_K + B(h)`, with the following consequences for the input:
//!
//! - *Upper bound.* A point of `M_K` on the line is a point of `M_I`, so the bound is exact for the input.
//! - *Lower bound.* A plane `n.m >= L n.d` below `M_K`, `|n| = 1`, is at most `h` above `M_I`. Answers state
//!   `L - h / n.d`, so their lower bounds are exact for the input.
//! - *Separation.* If the shadow of `M_K` has a distance `margin` from the line, that of `M_I` has at least
//!   `margin - h`. Answers state this value, and report `separated` if it is positive.
//! - *Grazing.* The lateral overlap of the input is that of `K`, or up to `h` more.
//!
//! Therefore (a), (b) and the exact check of `K` judge the input completely. For a sample, the consequences are
//! also compared with the linear programme over the input points
//! ([`Judge::compare_with_oracle`](crate::oracle::check::Judge::compare_with_oracle)).

use colltrans::ConvexPolyhedron;
use glam::DVec3;

use crate::oracle::check::Objection;
use crate::oracle::distance::{distance, point_to_triangle_or_edges};
use crate::oracle::exact::{Dyadic, Ratio, Vector};

/// Maximum hull error that rounding explains, in multiples of the largest coordinate: 16 tolerances of 64
/// roundings.
pub const ROUNDING: f64 = 512.0 * f64::EPSILON;

/// How far a body represents its input points.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Kept {
    /// Number of points that are not vertices.
    pub dropped: usize,
    /// The largest distance of a dropped point from the body, in the unit of the input.
    pub farthest: f64,
}

/// Compares a body with its input points.
///
/// # Errors
/// [`Objection`] if a vertex is not an input point, a point is farther from the body than its hull error, or
/// the hull error is larger than rounding explains.
pub fn judge(points: &[DVec3], body: &ConvexPolyhedron) -> Result<Kept, Objection> {
    let claimed = body.hull_error();
    let largest = points.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    if !(0.0..=ROUNDING * largest).contains(&claimed) {
        return Err(Objection(format!("hull error {claimed:e}, coordinates up to {largest:e}")));
    }
    let dropped = dropped_points(points, body)?;
    let allowed = Ratio::from_f64(claimed);
    let allowed = allowed.times(&allowed);
    let mut kept = Kept { dropped: dropped.len(), farthest: 0.0 };
    let triangles = face_triangles(body);
    for index in dropped {
        let point = points[index];
        if is_in_some_tetrahedron(point, body.vertices(), &triangles) {
            continue;
        }
        let mut square = square_from_nearest(point, body.vertices(), &triangles);
        if square > allowed {
            square = square_from(point, body.vertices());
        }
        let away = square.sqrt_to_f64();
        if square > allowed {
            let claim = format!("hull error {claimed:e}");
            return Err(Objection(format!("point {index} is {away:e} from the body, {claim}")));
        }
        kept.farthest = kept.farthest.max(away);
    }
    Ok(kept)
}

/// Returns the indices of the points that are not vertices.
fn dropped_points(points: &[DVec3], body: &ConvexPolyhedron) -> Result<Vec<usize>, Objection> {
    let bits = |v: &DVec3| v.to_array().map(f64::to_bits);
    let mut is_vertex = vec![false; points.len()];
    for (vertex, input) in body.vertices().iter().zip(body.input_indices()) {
        if points.get(input.index()).map(bits) != Some(bits(vertex)) {
            return Err(Objection(format!("vertex {vertex} is not the point {input}")));
        }
        is_vertex[input.index()] = true;
    }
    Ok((0..points.len()).filter(|&i| !is_vertex[i]).collect())
}

/// Returns the exact squared distance of a point from the hull of other points.
fn square_from(point: DVec3, others: &[DVec3]) -> Ratio {
    let others: Vec<Vector> = others.iter().map(|v| Vector::new(*v)).collect();
    distance(&[Vector::new(point)], &others).square
}

/// Returns the faces as triangles. They serve only to guess vertices near a point. The resulting proofs are
/// valid even if the triangles do not form a surface.
fn face_triangles(body: &ConvexPolyhedron) -> Vec<[DVec3; 3]> {
    let fan = |face: u32| {
        let corners: Vec<DVec3> =
            body.face_vertices(face).map(|v| body.vertices()[v as usize]).collect();
        let first = corners[0];
        corners[1..].windows(2).map(|pair| [first, pair[0], pair[1]]).collect::<Vec<_>>()
    };
    (0..body.face_count() as u32).flat_map(fan).collect()
}

/// Returns the exact squared distance from the triangle that is nearest up to rounding. It is at least the
/// squared distance from the body.
fn square_from_nearest(point: DVec3, vertices: &[DVec3], triangles: &[[DVec3; 3]]) -> Ratio {
    let away = |triangle: &&[DVec3; 3]| point_to_triangle_or_edges(point, **triangle);
    let nearest = triangles.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
    // A point or a segment has no triangles.
    square_from(point, nearest.map_or(vertices, |t| t))
}

/// Checks exactly whether a point is in the tetrahedron of the farthest vertex and of the triangle that is
/// opposite up to rounding. If so, it is in the body.
fn is_in_some_tetrahedron(point: DVec3, vertices: &[DVec3], triangles: &[[DVec3; 3]]) -> bool {
    let farther = |a: &&DVec3, b: &&DVec3| a.distance(point).total_cmp(&b.distance(point));
    let Some(&apex) = vertices.iter().max_by(farther) else { return false };
    let least = |&&[b, c, d]: &&[DVec3; 3]| {
        let volume = |[a, b, c, d]: [DVec3; 4]| (b - a).cross(c - a).dot(d - a);
        let whole = volume([apex, b, c, d]);
        let shares = faces_with(point, [apex, b, c, d]).map(|corners| volume(corners) / whole);
        shares.into_iter().fold(f64::INFINITY, |x, y| if y < x || y.is_nan() { y } else { x })
    };
    let deeper = |a: &&[DVec3; 3], b: &&[DVec3; 3]| least(a).total_cmp(&least(b));
    let found = triangles.iter().filter(|t| least(t) >= 0.0).max_by(deeper);
    found.is_some_and(|&[b, c, d]| is_in_tetrahedron(point, [apex, b, c, d]))
}

/// Returns the tetrahedron with each of its corners in turn replaced by a point.
fn faces_with(point: DVec3, corners: [DVec3; 4]) -> [[DVec3; 4]; 4] {
    std::array::from_fn(|k| std::array::from_fn(|i| if i == k { point } else { corners[i] }))
}

/// Checks exactly whether a point is in a tetrahedron. A tetrahedron without volume contains no points.
fn is_in_tetrahedron(point: DVec3, corners: [DVec3; 4]) -> bool {
    let volume = |corners: [DVec3; 4]| {
        let [a, b, c, d] = corners.map(Vector::new);
        b.minus(&a).cross(&c.minus(&a)).dot(&d.minus(&a))
    };
    let is_reversed = match volume(corners) {
        v if v.is_zero() => return false,
        v => v.is_negative(),
    };
    let is_other_side = |v: Dyadic| if is_reversed { v.is_positive() } else { v.is_negative() };
    !faces_with(point, corners).into_iter().any(|corners| is_other_side(volume(corners)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::cuboid;

    #[test]
    fn missing_point_is_detected() {
        let points = cuboid(DVec3::ONE).vertices;
        let body = ConvexPolyhedron::from_points(&points).expect("a cube");
        assert_eq!(judge(&points, &body), Ok(Kept::default()));
        let with = |extra: DVec3| {
            let points: Vec<DVec3> = points.iter().copied().chain([extra]).collect();
            judge(&points, &body)
        };
        assert_eq!(with(DVec3::new(0.5, 1.0, -1.0)), Ok(Kept { dropped: 1, farthest: 0.0 }));
        assert_eq!(with(DVec3::new(0.3, 0.1, -0.2)), Ok(Kept { dropped: 1, farthest: 0.0 }));
        assert_eq!(with(DVec3::splat(0.25)), Ok(Kept { dropped: 1, farthest: 0.0 }));
        for outside in [DVec3::X * 1.0_f64.next_up(), DVec3::splat(1.0_f64.next_up())] {
            assert!(with(outside).is_err(), "{outside}");
        }
    }

    #[test]
    fn vertex_that_is_not_a_point_is_detected() {
        let mut points = cuboid(DVec3::ONE).vertices;
        let body = ConvexPolyhedron::from_points(&points).expect("a cube");
        points[3].x = points[3].x.next_down();
        assert!(judge(&points, &body).is_err());
    }
}
