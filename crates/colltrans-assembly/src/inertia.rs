//! Principal axes of inertia of a solid, of its volume.
//!
//! The second moments about the centre, `C = integral of (x - m)(x - m)^T`, are a sum over
//! tetrahedra from one point to each facet. Their eigenvectors by Jacobi's rotations.

use colltrans::Aabb;
use colltrans::Solid;
use glam::{DMat3, DVec3};

/// Eigenvalues closer than this share of the largest leave the axes open.
const DISTINCT: f64 = 1e-3;

/// The axes that are well defined: none for a cube, one for a cylinder, else three.
pub fn axes(solid: &Solid) -> Vec<DVec3> {
    let (values, vectors) = eigen(second_moments(solid));
    let largest = values.abs().max_element();
    let apart = |i: usize, j: usize| (values[i] - values[j]).abs() > DISTINCT * largest;
    let well = |i: usize| apart(i, (i + 1) % 3) && apart(i, (i + 2) % 3);
    (0..3).filter(|&i| largest > 0.0 && well(i)).map(|i| vectors.col(i).normalize()).collect()
}

/// Third moments are clear from this share of the deviation on, and second moments of a solid with a hand are apart by it:
/// single precision rounds far less.
const CLEAR: f64 = 0.03;

/// Whether the principal axes of a solid, in the order of their moments and each turned to where the solid is drawn out
/// farther, are right-handed: of mirror images one has right-handed axes and one left-handed ones. `None` where axes or
/// sides are not clear, as of all that has a plane of symmetry.
pub fn is_right_handed(solid: &Solid) -> Option<bool> {
    let (center, _) = center(solid)?;
    let (values, vectors) = eigen(second_moments(solid));
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| values[i].total_cmp(&values[j]));
    let [small, middle, large] = order.map(|i| values[i]);
    let apart = small > 0.0 && middle - small > CLEAR * large && large - middle > CLEAR * large;
    let axes = order.map(|i| vectors.col(i).normalize());
    let corner = |v: u32| solid.vertices()[v as usize] - center;
    let (mut volume, mut third) = (0.0, DVec3::ZERO);
    for t in solid.triangles() {
        let [a, b, c] = t.map(corner);
        let v = a.dot(b.cross(c)) / 6.0;
        volume += v;
        let [x, y, z] = [a, b, c].map(|p| DVec3::from_array(axes.map(|axis| p.dot(axis))));
        // The integral of the cube of a linear form over a tetrahedron with a corner where it is zero.
        let cubes = x * x * (x + y + z) + y * y * (x + y + z) + z * z * (x + y + z) + x * y * z;
        third += cubes * (v / 20.0);
    }
    let cubed = |variance: f64| variance * variance.sqrt();
    let skew = third / volume / DVec3::new(cubed(small), cubed(middle), cubed(large));
    let clear = apart && skew.abs().min_element() > CLEAR;
    let [x, y, z] = axes;
    clear.then(|| skew.element_product() * x.cross(y).dot(z) > 0.0)
}

/// The principal second moments of the volume about its centre, in increasing order.
pub fn moments(solid: &Solid) -> DVec3 {
    let mut values = eigen(second_moments(solid)).0.to_array();
    values.sort_by(f64::total_cmp);
    DVec3::from_array(values)
}

/// The centre of the volume, and how far it is off at most; `None` where rounding leaves nothing of the volume.
///
/// Each of `n` terms, a product of three lengths with ten roundings, is off by at most `(n + 10) u` of the product of these
/// lengths, once it is in the sum; so is its moment, with a factor of one of them.
pub fn center(solid: &Solid) -> Option<(DVec3, f64)> {
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
    let off = (solid.triangles().len() as f64 + 16.0) * U * terms;
    let least = volume - off;
    let center = first / volume;
    let error = 4.0 * off * reach / least + 8.0 * U * (reach + origin.length());
    (least > 0.0).then_some((origin + center, error))
}

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

/// Eigenvalues and eigenvectors (columns) of a symmetric matrix.
fn eigen(matrix: DMat3) -> (DVec3, DMat3) {
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
    use crate::sphere::angle;

    #[test]
    fn a_turned_block_has_the_axes_it_was_turned_to() {
        let mut random = Random::new(9);
        for _ in 0..50 {
            let rotation = random.rotation();
            let at = DVec3::new(3.0, -2.0, 7.0);
            let mesh = cuboid(DVec3::new(1.0, 2.0, 3.5)).mapped(|v| rotation * v + at);
            let axes = axes(&Solid::from_mesh(&mesh.vertices, &mesh.faces).unwrap());
            assert_eq!(axes.len(), 3);
            for axis in DVec3::AXES.map(|x| rotation * x) {
                let near = |a: &DVec3| angle(*a, axis).min(angle(*a, -axis)) < 1e-9;
                assert_eq!(axes.iter().filter(|a| near(a)).count(), 1);
            }
        }
        let cube = cuboid(DVec3::ONE);
        assert_eq!(is_right_handed(&Solid::from_mesh(&cube.vertices, &cube.faces).unwrap()), None);
        assert!(axes(&Solid::from_mesh(&cube.vertices, &cube.faces).unwrap()).is_empty());
    }
}
