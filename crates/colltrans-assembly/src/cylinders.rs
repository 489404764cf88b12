//! Detects the axes of cylinders from facets.
//!
//! Edges along a tessellated cylinder are parallel to its axis, and their facets meet at small angles. The
//! search groups such edges by direction. A direction is an axis if it has at least four edges, and the
//! surface turns by at least a right angle over them. They must have at least 2 % of the length of all such edges.
//! Edges of cones and spheres have many directions, so they yield no axis.

use std::collections::HashMap;
use std::f64::consts::FRAC_PI_2;

use colltrans::Solid;
use glam::DVec3;

use crate::sphere::angle_between;

/// Maximum angle in radians (60 degrees) between facets of a round surface.
const MAX_SMOOTH_ANGLE: f64 = 1.05;
/// Minimum angle in radians between facets that are not coplanar.
const MIN_ANGLE: f64 = 1e-3;
/// Maximum angle in radians between parallel edges.
const PARALLEL_ANGLE: f64 = 2e-3;
/// Minimum number of edges of an axis.
const MIN_EDGES: usize = 4;
/// Minimum share of the length of all smooth edges that are along an axis.
const MIN_LENGTH_SHARE: f64 = 0.02;
/// Maximum number of axes of a solid.
const MAX_AXES: usize = 4;

/// Parallel smooth edges.
struct Bundle {
    axis: DVec3,
    length: f64,
    turn: f64,
    edges: usize,
}

/// Returns the unit axes of the cylinders of a solid, each with the total length of its edges, longest first.
/// Takes time proportional to the number of facets, apart from sorting the smooth edges.
pub fn cylinder_axes(solid: &Solid) -> Vec<(f64, DVec3)> {
    let mut edges = smooth_edges(solid);
    edges.sort_by(|x, y| y.0.length_squared().total_cmp(&x.0.length_squared()));
    let total_length: f64 = edges.iter().map(|e| e.0.length()).sum();
    let mut bundles: Vec<Bundle> = Vec::new();
    let parallel = PARALLEL_ANGLE.cos();
    for (edge, turn) in edges {
        let length = edge.length();
        let axis = edge / length;
        let near = |b: &&mut Bundle| b.axis.dot(axis).abs() > parallel;
        let count = bundles.len();
        match bundles.iter_mut().find(near) {
            Some(bundle) => {
                bundle.length += length;
                bundle.turn += turn;
                bundle.edges += 1;
            }
            // Without this limit, spheres would add a bundle for each edge. The longest edges come first.
            None if count < 64 => bundles.push(Bundle { axis, length, turn, edges: 1 }),
            None => (),
        }
    }
    let least = MIN_LENGTH_SHARE * total_length;
    bundles.retain(|b| b.edges >= MIN_EDGES && b.turn >= FRAC_PI_2 && b.length >= least);
    bundles.sort_by(|x, y| y.length.total_cmp(&x.length));
    bundles.truncate(MAX_AXES);
    bundles.into_iter().map(|b| (b.length, b.axis)).collect()
}

/// Returns the edges at which two facets meet at a small angle, each with the angle in radians.
fn smooth_edges(solid: &Solid) -> Vec<(DVec3, f64)> {
    let corner = |v: u32| solid.vertices()[v as usize];
    let normal = |t: &[u32; 3]| {
        let [a, b, c] = t.map(corner);
        (b - a).cross(c - a).normalize_or_zero()
    };
    let mut open_edges: HashMap<[u32; 2], (DVec3, usize)> = HashMap::new();
    let mut edges = Vec::new();
    for (k, t) in solid.triangles().iter().enumerate() {
        let n = normal(t);
        for i in 0..3 {
            let (a, b) = (t[i], t[(i + 1) % 3]);
            if let Some((m, _)) = open_edges.remove(&[a.min(b), a.max(b)]) {
                let turn = angle_between(n, m);
                if turn > MIN_ANGLE && turn < MAX_SMOOTH_ANGLE {
                    edges.push((corner(b) - corner(a), turn));
                }
            } else {
                open_edges.insert([a.min(b), a.max(b)], (n, k));
            }
        }
    }
    edges
}

#[cfg(test)]
mod tests {
    use colltrans_testkit::random::Random;
    use colltrans_testkit::shapes::prism;

    use super::*;

    #[test]
    fn rotated_cylinder_has_one_axis_and_cube_none() {
        let mut random = Random::new(5);
        for sides in [8, 12, 33] {
            let rotation = random.rotation();
            let mesh = prism(sides, 2.0).mapped(|v| rotation * v);
            let solid = Solid::from_mesh(&mesh.vertices, &mesh.faces).unwrap();
            let axes = cylinder_axes(&solid);
            assert_eq!(axes.len(), 1, "{sides}");
            let axis = rotation * DVec3::Z;
            assert!(angle_between(axes[0].1, axis).min(angle_between(axes[0].1, -axis)) < 1e-9);
        }
        let cube = prism(4, 1.0);
        let solid = Solid::from_mesh(&cube.vertices, &cube.faces).unwrap();
        assert!(cylinder_axes(&solid).is_empty());
    }
}
