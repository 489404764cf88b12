//! Centre and principal axes of inertia of the volume of a solid.
//!
//! The second moments about the centre `m`, `C = integral of (x - m)(x - m)^T`, are summed over the
//! tetrahedra from one point to each facet. Jacobi rotations compute their eigenvectors.

use colltrans::Aabb;
use colltrans::Solid;
use glam::{DMat3, DVec3};

/// Minimum difference of distinct eigenvalues, as a share of the largest one.
const DISTINCT: f64 = 1e-3;

/// Returns the unit principal axes whose eigenvalues are distinct: none for a cube, one for a cylinder, else
/// three.
pub fn principal_axes(solid: &Solid) -> Vec<DVec3> {
    let (values, vectors) = eigen_decomposition(second_moments(solid));
    let largest = values.abs().max_element();
    let are_distinct = |i: usize, j: usize| (values[i] - values[j]).abs() > DISTINCT * largest;
    let is_defined = |i: usize| are_distinct(i, (i + 1) % 3) && are_distinct(i, (i + 2) % 3);
    (0..3).filter(|&i| largest > 0.0 && is_defined(i)).map(|i| vectors.col(i).normalize()).collect()
}

/// Threshold for the handedness of a solid, far above the rounding of single precision: a share of the
/// deviation for third moments, a share of the largest one for differences of second moments.
const MIN_ASYMMETRY: f64 = 0.03;

/// Checks whether the principal axes of a solid are right-handed. The axes are in the order of their moments,
/// each directed to the side with the positive third moment. Mirror images have opposite handedness.
///
/// Returns `None` if the axes or their directions are not clear, for example for solids with a plane of
/// symmetry.
pub fn is_right_handed(solid: &Solid) -> Option<bool> {
    let (center, _) = volume_center(solid)?;
    let (values, vectors) = eigen_decomposition(second_moments(solid));
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| values[i].total_cmp(&values[j]));
    let [small, middle, large] = order.map(|i| values[i]);
    let are_distinct = small > 0.0
        && middle - small > MIN_ASYMMETRY * large
        && large - middle > MIN_ASYMMETRY * large;
    let axes = order.map(|i| vectors.col(i).normalize());
    let corner = |v: u32| solid.vertices()[v as usize] - center;
    let (mut volume, mut third) = (0.0, DVec3::ZERO);
    for t in solid.triangles() {
        let [a, b, c] = t.map(corner);
        let v = a.dot(b.cross(c)) / 6.0;
        volume += v;
        let [x, y, z] = [a, b, c].map(|p| DVec3::from_array(axes.map(|axis| p.dot(axis))));
        // Integral of the cube of a linear form over a tetrahedron with a vertex at which the form is zero.
        let cubes = x * x * (x + y + z) + y * y * (x + y + z) + z * z * (x + y + z) + x * y * z;
        third += cubes * (v / 20.0);
    }
    let cubed = |variance: f64| variance * variance.sqrt();
    let skew = third / volume / DVec3::new(cubed(small), cubed(middle), cubed(large));
    let is_clear = are_distinct && skew.abs().min_element() > MIN_ASYMMETRY;
    let [x, y, z] = axes;
    is_clear.then(|| skew.element_product() * x.cross(y).dot(z) > 0.0)
}

/// Returns the principal second moments of the volume about its centre, in increasing order, divided by the
/// volume.
pub fn principal_moments(solid: &Solid) -> DVec3 {
    let mut values = eigen_decomposition(second_moments(solid)).0.to_array();
    values.sort_by(f64::total_cmp);
    DVec3::from_array(values)
}

/// Returns the centre of the volume and a bound on its error; `None` if the volume is not positive beyond
/// rounding.
///
/// Error bound: each of `n` terms is a product of three lengths with ten roundings. Within the sum, its error
/// is at most `(n + 10) u` times the product of these lengths. The error of its moment has one of the lengths
/// as a further factor.
pub fn volume_center(solid: &Solid) -> Option<(DVec3, f64)> {
    const U: f64 = f64::EPSILON / 2.0;
    let Aabb { low, high } = solid.bounds();
    let origin = (low + high) * 0.5;
    let corner = |v: u32| solid.vertices()[v as usize] - origin;
    let (mut volume, mut first, mut terms, mut reach) = (0.0, DVec3::ZERO, 0.0, 0.0_f64);
    for t in solid.triangles() {
        let [a, b, c] = t.map(corner);
        let v = a.dot(b.cross(c)) / 6.0;
        volume += v;
        first += (a + b + c) * (v / 4.0);
        terms += a.length() * b.length() * c.length();
        reach = reach.max(a.length()).max(b.length()).max(c.length());
    }
    let volume_error = (solid.triangles().len() as f64 + 16.0) * U * terms;
    let least = volume - volume_error;
    let center = first / volume;
    let error = 4.0 * volume_error * reach / least + 8.0 * U * (reach + origin.length());
    (least > 0.0).then_some((origin + center, error))
}

/// Returns the matrix of second moments about the centre, divided by the volume; zero without volume.
fn second_moments(solid: &Solid) -> DMat3 {
    let Aabb { low, high } = solid.bounds();
    let origin = (low + high) * 0.5;
    let corner = |v: u32| solid.vertices()[v as usize] - origin;
    let (mut volume, mut first, mut second) = (0.0, DVec3::ZERO, DMat3::ZERO);
    for t in solid.triangles() {
        let [a, b, c] = t.map(corner);
        let v = a.dot(b.cross(c)) / 6.0;
        let sum = a + b + c;
        volume += v;
        first += sum * (v / 4.0);
        let outer = |x: DVec3| DMat3::from_cols(x * x.x, x * x.y, x * x.z);
        second += (outer(a) + outer(b) + outer(c) + outer(sum)) * (v / 20.0);
    }
    if volume == 0.0 {
        return DMat3::ZERO;
    }
    let mean = first / volume;
    second * (1.0 / volume) - DMat3::from_cols(mean * mean.x, mean * mean.y, mean * mean.z)
}

/// Returns the eigenvalues and eigenvectors (columns) of a symmetric matrix, by Jacobi rotations.
fn eigen_decomposition(matrix: DMat3) -> (DVec3, DMat3) {
    let (mut a, mut vectors) = (matrix, DMat3::IDENTITY);
    for _ in 0..24 {
        let off = [(0, 1), (0, 2), (1, 2)];
        let largest = |x: &&(usize, usize), y: &&(usize, usize)| {
            a.col(x.0)[x.1].abs().total_cmp(&a.col(y.0)[y.1].abs())
        };
        let Some(&(p, q)) = off.iter().max_by(largest) else { break };
        let entry = a.col(p)[q];
        if entry == 0.0 {
            break;
        }
        let theta = (a.col(q)[q] - a.col(p)[p]) / (2.0 * entry);
        let t = 1.0_f64.copysign(theta) / (theta.abs() + theta.hypot(1.0));
        let cosine = 1.0 / t.hypot(1.0);
        let sine = t * cosine;
        let mut turn = DMat3::IDENTITY;
        turn.col_mut(p)[p] = cosine;
        turn.col_mut(q)[q] = cosine;
        turn.col_mut(q)[p] = sine;
        turn.col_mut(p)[q] = -sine;
        a = turn.transpose() * a * turn;
        vectors *= turn;
    }
    (DVec3::new(a.x_axis.x, a.y_axis.y, a.z_axis.z), vectors)
}

#[cfg(test)]
mod tests {
    use colltrans_testkit::random::Random;
    use colltrans_testkit::shapes::cuboid;

    use super::*;
    use crate::sphere::angle_between;

    #[test]
    fn principal_axes_follow_rotation_and_cube_has_none() {
        let mut random = Random::new(9);
        for _ in 0..50 {
            let rotation = random.rotation();
            let at = DVec3::new(3.0, -2.0, 7.0);
            let mesh = cuboid(DVec3::new(1.0, 2.0, 3.5)).mapped(|v| rotation * v + at);
            let axes = principal_axes(&Solid::from_mesh(&mesh.vertices, &mesh.faces).unwrap());
            assert_eq!(axes.len(), 3);
            for axis in DVec3::AXES.map(|x| rotation * x) {
                let near = |a: &DVec3| angle_between(*a, axis).min(angle_between(*a, -axis)) < 1e-9;
                assert_eq!(axes.iter().filter(|a| near(a)).count(), 1);
            }
        }
        let cube = cuboid(DVec3::ONE);
        assert_eq!(is_right_handed(&Solid::from_mesh(&cube.vertices, &cube.faces).unwrap()), None);
        assert!(principal_axes(&Solid::from_mesh(&cube.vertices, &cube.faces).unwrap()).is_empty());
    }
}
