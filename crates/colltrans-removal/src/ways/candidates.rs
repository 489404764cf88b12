//! Which directions are tried: normals of large facets, and what is across two of them, as along a channel.

use glam::DVec3;

use colltrans_convex::body::Placed;
use colltrans_solid::body::Solid;

/// Axes of the largest facets of each body.
const AXES: usize = 3;
/// Axes of walls around a place.
const MOST_WALLS: usize = 8;
/// Axes in all, each of which is two directions.
const MOST: usize = 13;
/// Axes whose cross product is shorter than this are one.
const ALIKE: f64 = 1e-6;

/// Directions of length 1, each with its opposite: those given, or of large facets.
pub(super) fn directions(bodies: &[Placed<'_, Solid>], given: &[DVec3]) -> Vec<DVec3> {
    let mut axes = Vec::new();
    for &d in given {
        put(&mut axes, d);
    }
    let axes = if given.is_empty() { of_large_facets(bodies) } else { axes };
    axes.iter().flat_map(|&axis| [axis, DVec3::ZERO - axis]).collect()
}

/// Axes of length 1: normals of the largest facets of each body, and what is across two of them; 13 at most.
pub fn of_large_facets(bodies: &[Placed<'_, Solid>]) -> Vec<DVec3> {
    let mut axes = Vec::new();
    for body in bodies {
        for axis in large(body, |_| true).into_iter().take(AXES) {
            put(&mut axes, axis);
        }
    }
    for k in 0..axes.len().min(MOST) {
        for l in 0..k {
            let across = axes[l].cross(axes[k]);
            put(&mut axes, across);
        }
    }
    axes.truncate(MOST);
    axes
}

/// Axes of the walls around a place: of facets of a body that face it, the largest first, and across the first two.
pub(super) fn of_walls(body: &Placed<'_, Solid>, place: DVec3) -> Vec<DVec3> {
    let within = body.pose.matrix().transpose() * (place - body.pose.translation());
    let mut axes = large(body, |[a, b, c]| (b - a).cross(c - a).dot(within - a) > 0.0);
    axes.truncate(MOST_WALLS);
    if let [first, second, ..] = axes[..] {
        axes.push(first.cross(second));
    }
    axes
}

/// The axes that most of the area of some facets of a body faces, in the world, the largest first.
fn large(body: &Placed<'_, Solid>, among: impl Fn([DVec3; 3]) -> bool) -> Vec<DVec3> {
    let mut found: Vec<(DVec3, f64)> = Vec::new();
    let vertices = body.body.vertices();
    for t in body.body.triangles() {
        let [a, b, c] = t.map(|v| vertices[v as usize]);
        if !among([a, b, c]) {
            continue;
        }
        let normal = (b - a).cross(c - a);
        let area = normal.length();
        let Some(unit) = normal.try_normalize() else { continue };
        let known = found.iter().position(|(axis, _)| axis.cross(unit).length() < ALIKE);
        match known {
            Some(k) => found[k].1 += area,
            // Of a finely tessellated body the first ones are as good as any.
            None if found.len() < 256 => found.push((unit, area)),
            None => (),
        }
    }
    found.sort_by(|x, y| y.1.total_cmp(&x.1));
    found.iter().map(|(axis, _)| body.pose.transform_vector(*axis)).collect()
}

fn put(axes: &mut Vec<DVec3>, d: DVec3) {
    let Some(unit) = (d.length() > ALIKE).then(|| d.try_normalize()).flatten() else { return };
    // Rounding of a product must not make 1e-17 of a component.
    let unit = unit.map(|x| if x.abs() < 1e-12 { 0.0 } else { x });
    if !axes.iter().any(|axis| axis.cross(unit).length() < ALIKE) {
        axes.push(unit);
    }
}
