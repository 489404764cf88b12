//! Directions of moves: normals of large facets, and cross products of two of them, for example along a
//! channel.

use glam::DVec3;

use colltrans_convex::body::Placed;
use colltrans_solid::body::Solid;

/// Maximum number of axes of each body's largest facets.
const MAX_AXES_PER_BODY: usize = 3;
/// Maximum number of axes of walls around a place.
const MAX_WALL_AXES: usize = 8;
/// Maximum number of axes. Each stands for two directions.
const MAX_AXES: usize = 13;
/// Length of the cross product of two axes below which they are identified.
const SAME_AXIS: f64 = 1e-6;

/// Returns directions of length 1, each followed by its opposite: the given ones, or those of large facets.
pub(super) fn candidate_directions(bodies: &[Placed<'_, Solid>], given: &[DVec3]) -> Vec<DVec3> {
    let mut axes = Vec::new();
    for &d in given {
        add_axis(&mut axes, d);
    }
    let axes = if given.is_empty() { large_facet_axes(bodies) } else { axes };
    axes.iter().flat_map(|&axis| [axis, DVec3::ZERO - axis]).collect()
}

/// Returns at most 13 axes of length 1: normals of the largest facets of each body, and cross products of two
/// of them.
pub fn large_facet_axes(bodies: &[Placed<'_, Solid>]) -> Vec<DVec3> {
    let mut axes = Vec::new();
    for body in bodies {
        for axis in facet_axes(body, |_| true).into_iter().take(MAX_AXES_PER_BODY) {
            add_axis(&mut axes, axis);
        }
    }
    for k in 0..axes.len().min(MAX_AXES) {
        for l in 0..k {
            let across = axes[l].cross(axes[k]);
            add_axis(&mut axes, across);
        }
    }
    axes.truncate(MAX_AXES);
    axes
}

/// Returns the axes of the walls around a place: normals of facets that face it, those with the largest area
/// first, and the cross product of the first two.
pub(super) fn wall_axes(body: &Placed<'_, Solid>, place: DVec3) -> Vec<DVec3> {
    let within = body.pose.matrix().transpose() * (place - body.pose.translation());
    let mut axes = facet_axes(body, |[a, b, c]| (b - a).cross(c - a).dot(within - a) > 0.0);
    axes.truncate(MAX_WALL_AXES);
    if let [first, second, ..] = axes[..] {
        axes.push(first.cross(second));
    }
    axes
}

/// Returns the normals of the facets that `among` accepts, in the world frame, sorted by decreasing total
/// area. Opposite normals are one axis.
fn facet_axes(body: &Placed<'_, Solid>, among: impl Fn([DVec3; 3]) -> bool) -> Vec<DVec3> {
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
        let known = found.iter().position(|(axis, _)| axis.cross(unit).length() < SAME_AXIS);
        match known {
            Some(k) => found[k].1 += area,
            // For a finely tessellated body the first 256 axes suffice.
            None if found.len() < 256 => found.push((unit, area)),
            None => (),
        }
    }
    found.sort_by(|x, y| y.1.total_cmp(&x.1));
    found.iter().map(|(axis, _)| body.pose.transform_vector(*axis)).collect()
}

fn add_axis(axes: &mut Vec<DVec3>, d: DVec3) {
    let Some(unit) = (d.length() > SAME_AXIS).then(|| d.try_normalize()).flatten() else { return };
    // Rounding of a cross product must not leave components such as 1e-17.
    let unit = unit.map(|x| if x.abs() < 1e-12 { 0.0 } else { x });
    if !axes.iter().any(|axis| axis.cross(unit).length() < SAME_AXIS) {
        axes.push(unit);
    }
}
