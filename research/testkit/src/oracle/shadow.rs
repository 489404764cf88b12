//! Computes the exact lateral overlap of two bodies, the signed distance of the line from the boundary of the
//! shadow of `M`.

use std::cmp::Ordering;

use dashu_int::IBig;

use crate::oracle::exact::{Dyadic, Ratio, Vector};
use crate::oracle::scene::{Scene, in_common_unit};

/// A signed distance, `sign sqrt(square)`.
#[derive(Debug, Clone)]
pub struct SignedDistance {
    /// `Greater` inside, `Equal` on the boundary, `Less` outside.
    pub sign: Ordering,
    /// The squared distance.
    pub square: Ratio,
}

impl SignedDistance {
    /// Returns the nearest `f64`, up to a few rounding errors.
    pub fn to_f64(&self) -> f64 {
        let distance = self.square.to_f64().sqrt();
        if self.sign == Ordering::Less { -distance } else { distance }
    }

    /// Checks whether the distance is greater than `bound`, exactly.
    pub fn exceeds(&self, bound: f64) -> bool {
        let square = Ratio::new(&Dyadic::new(bound) * &Dyadic::new(bound), Dyadic::new(1.0));
        match (self.sign, bound < 0.0) {
            (Ordering::Less, true) => self.square < square,
            (Ordering::Less, false) => false,
            (_, true) => true,
            (_, false) => self.square > square,
        }
    }
}

/// Returns the distance of the line from the boundary of the shadow of `M`, in world units. It is positive if
/// the shadows of the two bodies overlap by this distance, and negative if they are disjoint by it.
///
/// # Panics
/// If a body has no points, which is impossible for polyhedra.
pub fn sideways_overlap(scene: &Scene) -> SignedDistance {
    let points = scene.differences();
    let coordinates: Vec<Dyadic> = points.iter().flat_map(|m| scene.shadow(m)).collect();
    let (coordinates, _) = in_common_unit(&coordinates);
    let shadows: Vec<[&IBig; 2]> = coordinates.chunks(2).map(|s| [&s[0], &s[1]]).collect();
    let hull = convex_hull(&shadows);

    // The orthogonal projection along d, times d.d.
    let d = &scene.direction;
    let square = d.dot(d);
    let project = |m: &Vector| m.times(&square).minus(&d.times(&m.dot(d)));
    let corners: Vec<Vector> = hull.iter().map(|&i| project(&points[i])).collect();

    let sides = (0..hull.len()).map(|i| (i, (i + 1) % hull.len()));
    let distance = sides
        .clone()
        .map(|(i, j)| squared_distance_to_segment(&corners[i], &corners[j]))
        .min()
        .expect("a body has a point");
    let origin = [&IBig::ZERO, &IBig::ZERO];
    let inside = hull.len() > 2 && { sides }.all(|(i, j)| {
        side_of_line(shadows[hull[i]], shadows[hull[j]], origin) == Ordering::Greater
    });
    let unit = Ratio::new(Dyadic::new(1.0), &square * &square);
    let sign = match (inside, distance.is_zero()) {
        (_, true) => Ordering::Equal,
        (true, _) => Ordering::Greater,
        (false, _) => Ordering::Less,
    };
    SignedDistance { sign, square: distance.times(&unit) }
}

/// Returns the squared distance of the origin from a segment.
fn squared_distance_to_segment(a: &Vector, b: &Vector) -> Ratio {
    let edge = b.minus(a);
    let (length, along) = (edge.dot(&edge), -a.dot(&edge));
    let one = Dyadic::new(1.0);
    if !along.is_positive() {
        Ratio::new(a.dot(a), one)
    } else if along >= length {
        Ratio::new(b.dot(b), one)
    } else {
        let area = a.cross(&edge);
        Ratio::new(area.dot(&area), length)
    }
}

/// Returns the side of `a -> b` on which `c` is: `Greater` is left.
fn side_of_line(a: [&IBig; 2], b: [&IBig; 2], c: [&IBig; 2]) -> Ordering {
    ((b[0] - a[0]) * (c[1] - a[1])).cmp(&((b[1] - a[1]) * (c[0] - a[0])))
}

/// Returns the indices of the strict corners of the convex hull, in counter-clockwise order (Andrew's monotone
/// chain).
fn convex_hull(points: &[[&IBig; 2]]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&i, &j| points[i].cmp(&points[j]));
    order.dedup_by(|i, j| points[*i] == points[*j]);
    if order.len() < 3 {
        return order;
    }
    let chain = |order: &mut dyn Iterator<Item = usize>| {
        let mut chain: Vec<usize> = Vec::new();
        for i in order {
            while let [.., a, b] = chain[..]
                && side_of_line(points[a], points[b], points[i]) != Ordering::Greater
            {
                chain.pop();
            }
            chain.push(i);
        }
        chain.pop();
        chain
    };
    let mut hull = chain(&mut order.iter().copied());
    hull.extend(chain(&mut order.iter().rev().copied()));
    hull
}

#[cfg(test)]
mod tests {
    use super::*;
    use colltrans::Pose;
    use glam::DVec3;

    fn overlap(x: f64, y: f64) -> SignedDistance {
        let square = [(0., 0.), (1., 0.), (1., 1.), (0., 1.), (0.5, 0.5), (0.5, 0.0)];
        let square = square.map(|(x, y)| DVec3::new(x, y, 7.0 + x));
        let pose = Pose::from_translation(DVec3::new(x, y, 3.0)).unwrap();
        let direction = DVec3::Z * -3.0;
        sideways_overlap(&Scene::new(
            (&[DVec3::ZERO], &pose),
            (&square, &Pose::IDENTITY),
            direction,
        ))
    }

    #[test]
    fn distance_from_a_square() {
        assert_eq!(overlap(0.25, 0.5).to_f64(), 0.25);
        assert_eq!(overlap(0.5, 1.5).to_f64(), -0.5);
        assert_eq!(overlap(4.0, 5.0).to_f64(), -5.0);
        assert_eq!(overlap(1.0, 0.5).sign, Ordering::Equal);
        assert_eq!(overlap(0.0, 0.0).sign, Ordering::Equal);
        let tiny = overlap(1e-50, 0.5);
        assert!(tiny.exceeds(0.0) && tiny.exceeds(-1.0) && !tiny.exceeds(1e-49));
        let outside = overlap(-1e-12, 0.5);
        assert!(!outside.exceeds(0.0) && outside.exceeds(-2e-12) && !outside.exceeds(-5e-13));
    }

    #[test]
    fn lower_dimensions() {
        let a = Pose::IDENTITY;
        let line = [DVec3::X, DVec3::NEG_X];
        let scene = |q: DVec3| Scene::new((&line, &a), (&[q], &a), DVec3::Z);
        assert_eq!(sideways_overlap(&scene(DVec3::new(0.5, 0.0, 1.0))).sign, Ordering::Equal);
        assert_eq!(sideways_overlap(&scene(DVec3::new(0.5, 2.0, 1.0))).to_f64(), -2.0);
        assert_eq!(sideways_overlap(&scene(DVec3::new(4.0, 0.0, 1.0))).to_f64(), -3.0);
    }
}
