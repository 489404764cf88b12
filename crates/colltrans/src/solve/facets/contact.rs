//! From a pair of facets to a contact: points, normal, features, and where the bodies as they are
//! would have met.

use glam::DVec3;

use super::leaf::Meeting;
use super::scene::{Scene, Side};
use super::search::Found;
use crate::body::Feature;

/// Where a solid is stopped.
///
/// Points are those of the bodies as they are, not shrunk: the same shares of the facets' corners as
/// where the shrunk bodies touch. Without a tolerance they come together at the distance; with one,
/// at [`Self::nominal`] along the normal, and sideways to within what shrinking has moved them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolidContact {
    /// Where the facets that stop the shrunk bodies meet in their true place, in multiples of the
    /// direction: what a person expects to read. May be negative where the bodies as they are overlap.
    pub nominal: f64,
    /// Unit contact normal in the world, from the moving body to the fixed one;
    /// `normal . direction > 0`. Where corners meet, or parallel edges, it is one of several.
    pub normal: DVec3,
    /// Contact point on the moving body as it is, in the world, at its start pose.
    pub point_on_moving: DVec3,
    /// Contact point on the fixed body as it is, in the world; one of many where edges or facets meet.
    pub point_on_fixed: DVec3,
    /// What of the moving body meets there, by the numbers of its input.
    pub moving_feature: Feature,
    /// What of the fixed body meets there, by the numbers of its input.
    pub fixed_feature: Feature,
    /// The triangles, as positions in [`Solid::triangles`](crate::Solid::triangles).
    pub triangles: [u32; 2],
}

/// A point of one facet, by the weights of its corners.
struct Foot {
    vertices: [u32; 3],
    weights: DVec3,
}

impl Foot {
    /// The point of the body as it is, in the setting frame.
    fn point(&self, side: &Side) -> DVec3 {
        let local = self.mean(|v| side.solid.vertices()[v as usize]);
        side.matrix * local + side.offset[0]
    }

    /// How far shrinking has moved it, in the setting frame.
    fn displacement(&self, side: &Side) -> DVec3 {
        let Some(shrinking) = side.shrinking else { return DVec3::ZERO };
        side.matrix * self.mean(|v| shrinking.field[v as usize] * side.amount)
    }

    fn mean(&self, value: impl Fn(u32) -> DVec3) -> DVec3 {
        let [a, b, c] = self.vertices.map(value);
        a * self.weights.x + b * self.weights.y + c * self.weights.z
    }
}

/// The contact, for a gap given in multiples of the direction.
pub(super) fn contact(scene: &Scene, found: &Found, distance: f64, origin: DVec3) -> SolidContact {
    let (moving, fixed) = (&scene.moving, &scene.fixed);
    let f = moving.solid.triangles()[found.moving as usize];
    let mut g = fixed.solid.triangles()[found.fixed as usize];
    // The leaf lists the corners of back facets backwards.
    g.swap(1, 2);
    let at = |side: &Side, v: u32| side.corner(v).at;
    let (p, q) = (f.map(|v| at(moving, v)), g.map(|v| at(fixed, v)));
    let (on_f, on_g, normal) = match found.at {
        Meeting::Corner(k) => {
            (corner(k), over(q, p[k as usize]), -(q[2] - q[0]).cross(q[1] - q[0]))
        }
        Meeting::Under(k) => (over(p, q[k as usize]), corner(k), (p[1] - p[0]).cross(p[2] - p[0])),
        Meeting::Sides(k, j) => {
            let (k, j) = (k as usize, j as usize);
            let (a, b) = ([p[k], p[(k + 1) % 3]], [q[j], q[(j + 1) % 3]]);
            let (s, t) = meeting(a, b);
            let normal = (a[1] - a[0]).cross(b[1] - b[0]);
            (along(k, s), along(j, t), normal * normal.z.signum())
        }
    };
    let (on_f, on_g) = (Foot { vertices: f, weights: on_f }, Foot { vertices: g, weights: on_g });
    let normal = (scene.frame.transpose() * normal).normalize_or_zero();
    let shift = on_f.displacement(moving) - on_g.displacement(fixed);
    let slope = normal.dot(scene.direction);
    let nominal = if slope > 0.0 { distance + normal.dot(shift) / slope } else { distance };
    SolidContact {
        nominal,
        normal,
        point_on_moving: on_f.point(moving) + origin,
        point_on_fixed: on_g.point(fixed) + origin,
        moving_feature: feature(moving, found.moving, &on_f),
        fixed_feature: feature(fixed, found.fixed, &on_g),
        triangles: [found.moving, found.fixed],
    }
}

fn corner(k: u8) -> DVec3 {
    DVec3::AXES[k as usize]
}

fn along(k: usize, s: f64) -> DVec3 {
    let mut weights = [0.0; 3];
    (weights[k], weights[(k + 1) % 3]) = (1.0 - s, s);
    DVec3::from_array(weights)
}

/// The weights of the point of a triangle over a shadow.
fn over([a, b, c]: [DVec3; 3], p: DVec3) -> DVec3 {
    let area = |u: DVec3, v: DVec3| u.truncate().perp_dot(v.truncate());
    let whole = area(b - a, c - a);
    let (v, w) = (area(p - a, c - a) / whole, area(b - a, p - a) / whole);
    // A point on the rim may have come out beyond it, by rounding.
    let (v, w) = (v.clamp(0.0, 1.0), w.clamp(0.0, 1.0));
    let excess = (v + w).max(1.0);
    DVec3::new(1.0 - (v + w) / excess, v / excess, w / excess)
}

/// Where the shadows of two segments cross, as shares of each.
fn meeting(a: [DVec3; 2], b: [DVec3; 2]) -> (f64, f64) {
    let flat = |v: DVec3| v.truncate();
    let (u, v, w) = (flat(a[1] - a[0]), flat(b[1] - b[0]), flat(b[0] - a[0]));
    let whole = u.perp_dot(v);
    let share = |x: f64| if whole == 0.0 { 0.5 } else { (x / whole).clamp(0.0, 1.0) };
    (share(w.perp_dot(v)), share(w.perp_dot(u)))
}

/// What the weights name: a vertex, an edge or the whole facet.
fn feature(side: &Side, triangle: u32, foot: &Foot) -> Feature {
    let index = |k: usize| side.solid.vertex_indices()[foot.vertices[k] as usize];
    let used: Vec3Used = foot.weights.to_array().map(|w| w != 0.0);
    match used {
        [true, false, false] => Feature::Vertex(index(0)),
        [false, true, false] => Feature::Vertex(index(1)),
        [false, false, true] => Feature::Vertex(index(2)),
        [true, true, false] => Feature::Edge([index(0), index(1)]),
        [false, true, true] => Feature::Edge([index(1), index(2)]),
        [true, false, true] => Feature::Edge([index(2), index(0)]),
        _ => Feature::Face(side.solid.facet_indices()[triangle as usize]),
    }
}

type Vec3Used = [bool; 3];
