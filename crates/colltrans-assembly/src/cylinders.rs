//! Axes of cylinders, found from facets.
//!
//! The edges along a tessellated cylinder are parallel to its axis, and the facets on either side meet
//! there at a small angle. Such edges are gathered by direction; a direction along which the surface
//! turns by a right angle or more in all, over at least four edges, is an axis. Of cones and spheres
//! the edges point everywhere.

use std::collections::HashMap;
use std::f64::consts::FRAC_PI_2;

use colltrans::Solid;
use glam::DVec3;

use crate::sphere::angle;

/// Facets that meet at a larger angle than this (60 degrees) do not stand for a round surface.
const SMOOTH: f64 = 1.05;
/// At a smaller angle than this they are one plane.
const FLAT: f64 = 1e-3;
/// Edges within this angle are parallel, in radians.
const PARALLEL: f64 = 2e-3;
/// How many edges an axis needs.
const FEWEST: usize = 4;
/// What share of the length of all such edges an axis needs.
const LEAST_SHARE: f64 = 0.02;
/// Of each solid, at most so many axes.
const MOST: usize = 4;

struct Bundle {
    axis: DVec3,
    length: f64,
    turn: f64,
    edges: usize,
}

/// The axes of the cylinders of a solid, those with the most length of edges first, each with that
/// length.
pub fn axes(solid: &Solid) -> Vec<(f64, DVec3)> {
    let mut edges = smooth_edges(solid);
    edges.sort_by(|x, y| y.0.length_squared().total_cmp(&x.0.length_squared()));
    let whole: f64 = edges.iter().map(|e| e.0.length()).sum();
    let mut bundles: Vec<Bundle> = Vec::new();
    for (edge, turn) in edges {
        let length = edge.length();
        let axis = edge / length;
        let near = |b: &&mut Bundle| angle(b.axis, axis).min(angle(b.axis, -axis)) < PARALLEL;
        let count = bundles.len();
        match bundles.iter_mut().find(near) {
            Some(bundle) => {
                bundle.length += length;
                bundle.turn += turn;
                bundle.edges += 1;
            }
            // Spheres would make one for each edge; the longest edges come first.
            None if count < 64 => bundles.push(Bundle { axis, length, turn, edges: 1 }),
            None => (),
        }
    }
    let least = LEAST_SHARE * whole;
    bundles.retain(|b| b.edges >= FEWEST && b.turn >= FRAC_PI_2 && b.length >= least);
    bundles.sort_by(|x, y| y.length.total_cmp(&x.length));
    bundles.truncate(MOST);
    bundles.into_iter().map(|b| (b.length, b.axis)).collect()
}

/// Edges at which two facets meet at a small angle, each with the angle.
fn smooth_edges(solid: &Solid) -> Vec<(DVec3, f64)> {
    let corner = |v: u32| solid.vertices()[v as usize];
    let normal = |t: &[u32; 3]| {
        let [a, b, c] = t.map(corner);
        (b - a).cross(c - a).normalize_or_zero()
    };
    let mut seen: HashMap<[u32; 2], (DVec3, usize)> = HashMap::new();
    let mut edges = Vec::new();
    for (k, t) in solid.triangles().iter().enumerate() {
        let n = normal(t);
        for i in 0..3 {
            let (a, b) = (t[i], t[(i + 1) % 3]);
            if let Some((m, _)) = seen.remove(&[a.min(b), a.max(b)]) {
                let turn = angle(n, m);
                if turn > FLAT && turn < SMOOTH {
                    edges.push((corner(b) - corner(a), turn));
                }
            } else {
                seen.insert([a.min(b), a.max(b)], (n, k));
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
    fn a_turned_cylinder_has_one_axis_and_a_cube_none() {
        let mut random = Random::new(5);
        for sides in [8, 12, 33] {
            let rotation = random.rotation();
            let mesh = prism(sides, 2.0).mapped(|v| rotation * v);
            let solid = Solid::from_mesh(&mesh.vertices, &mesh.faces).unwrap();
            let axes = axes(&solid);
            assert_eq!(axes.len(), 1, "{sides}");
            let axis = rotation * DVec3::Z;
            assert!(angle(axes[0].1, axis).min(angle(axes[0].1, -axis)) < 1e-9);
        }
        let cube = prism(4, 1.0);
        let solid = Solid::from_mesh(&cube.vertices, &cube.faces).unwrap();
        assert!(axes(&solid).is_empty());
    }
}
