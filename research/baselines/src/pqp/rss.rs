//! Rectangle swept spheres: all points within a radius of a rectangle.
//!
//! The rectangle of `A` has its centre at the origin, axes `x` and `y` and half sides `a_0, a_1`. In the same
//! frame, that of `B` has centre `t`, axes `r_0, r_1` and half sides `b_0, b_1`. The *gap* along a direction
//! `v`, `(min_B v . q - max_A v . p) / |v|`, is a lower bound of the distance for every `v`. It equals the
//! distance for the shortest vector from `A` to `B`.
//!
//! This vector joins two edges, or is normal to one rectangle, where the gap is the other's distance from the
//! plane (Larsen et al. 1999). Nearest points of two edges are nearest points of the rectangles exactly if
//! `v` points outwards from both edges. Therefore only edges beyond which the other rectangle extends are
//! examined. The result is always a gap, not the length of `v`: rounding may select a worse direction, but
//! the bound holds.

use glam::{DMat3, DVec3};

/// A rectangle in the soup's frame, and a radius around it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rss {
    /// Two sides of the rectangle, the longer one first, and its normal.
    pub(crate) axes: DMat3,
    pub(crate) center: DVec3,
    pub(crate) half: [f64; 2],
    pub(crate) radius: f64,
}

/// The rectangle of another volume in the frame of a soup.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rectangle {
    pub(crate) sides: [DVec3; 2],
    pub(crate) center: DVec3,
    pub(crate) half: [f64; 2],
}

impl Rss {
    /// Fits a volume to points, given by their coordinates along `axes`.
    ///
    /// The radius is half of the thickness along the normal. The sides of the rectangle are as short as the
    /// spheres at their ends permit, and longer where a corner would be left out.
    pub(crate) fn fit(axes: DMat3, points: &[DVec3]) -> Self {
        let low = points.iter().copied().reduce(DVec3::min).unwrap_or_default();
        let high = points.iter().copied().reduce(DVec3::max).unwrap_or_default();
        let middle_z = 0.5 * (low.z + high.z);
        let radius = 0.5 * (high.z - low.z);
        let mut sides = Sides::between_caps(points, middle_z, radius);
        sides.extend_corners(points, middle_z, radius);
        let [mut center, mut half] = [[0.0; 2]; 2];
        for i in 0..2 {
            center[i] = 0.5 * (sides.low[i] + sides.high[i]);
            half[i] = 0.5 * (sides.high[i] - sides.low[i]).max(0.0);
        }
        let middle = DVec3::new(center[0], center[1], middle_z);
        let beyond = |p: &DVec3| {
            let d = *p - middle;
            let [dx, dy] = [d.x.abs() - half[0], d.y.abs() - half[1]].map(|d| d.max(0.0));
            DVec3::new(dx, dy, d.z).length_squared()
        };
        let radius = points.iter().map(beyond).fold(0.0, f64::max).sqrt();
        Self { axes, center: axes * middle, half, radius }
    }

    /// Returns half of the extent, by which a query selects the volume to descend into, as in the authors'
    /// program. Using only the longer side, searches of slivers needed a third more tests.
    pub(crate) fn extent(&self) -> f64 {
        let [a, b] = self.half;
        (a * a + b * b).sqrt() + self.radius
    }

    /// Returns a lower bound of the distance of the points in both volumes, up to rounding; negative if the
    /// volumes overlap.
    #[inline]
    pub(crate) fn gap(&self, other: &Rectangle, other_radius: f64) -> f64 {
        let to_own = self.axes.transpose();
        let pair = Rectangles {
            a: self.half,
            b: other.half,
            t: (to_own * (other.center - self.center)).to_array(),
            r: other.sides.map(|side| (to_own * side).to_array()),
        };
        pair.distance() - self.radius - other_radius
    }
}

/// Limits of a rectangle along its two sides.
struct Sides {
    low: [f64; 2],
    high: [f64; 2],
}

impl Sides {
    /// Returns the shortest sides that half spheres at the ends permit.
    fn between_caps(points: &[DVec3], middle_z: f64, radius: f64) -> Self {
        let mut sides = Self { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] };
        for p in points {
            let z = p.z - middle_z;
            let cap = (radius * radius - z * z).max(0.0).sqrt();
            for (i, x) in [p.x, p.y].into_iter().enumerate() {
                sides.low[i] = sides.low[i].min(x + cap);
                sides.high[i] = sides.high[i].max(x - cap);
            }
        }
        for i in 0..2 {
            if sides.low[i] > sides.high[i] {
                let middle = 0.5 * (sides.low[i] + sides.high[i]);
                (sides.low[i], sides.high[i]) = (middle, middle);
            }
        }
        sides
    }

    /// Moves corners outwards along their diagonals until the spheres at them contain the points beyond.
    fn extend_corners(&mut self, points: &[DVec3], middle_z: f64, radius: f64) {
        for p in points {
            let over = |x: f64, i: usize| (x - self.high[i]).max(0.0) - (self.low[i] - x).max(0.0);
            let [x, y] = [over(p.x, 0), over(p.y, 1)];
            if x == 0.0 || y == 0.0 {
                continue;
            }
            let z = p.z - middle_z;
            // After a step `s`, the remainders are `|x| - s` and `|y| - s`; their squares and `z^2` sum to
            // `radius^2`.
            let (sum, difference) = (x.abs() + y.abs(), x.abs() - y.abs());
            let rest = 2.0 * (radius * radius - z * z) - difference * difference;
            let step = 0.5 * (sum - rest.max(0.0).sqrt());
            for (i, (over, step)) in
                [(x, step.min(x.abs())), (y, step.min(y.abs()))].iter().enumerate()
            {
                if *step > 0.0 && *over > 0.0 {
                    self.high[i] += step;
                } else if *step > 0.0 {
                    self.low[i] -= step;
                }
            }
        }
    }
}

/// Two rectangles in the frame of the first one.
struct Rectangles {
    a: [f64; 2],
    b: [f64; 2],
    t: [f64; 3],
    r: [[f64; 3]; 2],
}

impl Rectangles {
    /// Returns the largest gap; 0 if the rectangles intersect.
    #[inline]
    fn distance(&self) -> f64 {
        let Self { t, r, .. } = self;
        let rt = r.map(|r| r[0] * t[0] + r[1] * t[1] + r[2] * t[2]);
        let normal_gap = self.normal_gap().max(0.0);
        let shortest = self
            .edge_pairs::<0, 0>(rt)
            .or_else(|| self.edge_pairs::<0, 1>(rt))
            .or_else(|| self.edge_pairs::<1, 0>(rt))
            .or_else(|| self.edge_pairs::<1, 1>(rt));
        // Near contact, `v` is short and its direction inaccurate. The gap along a normal is exact for
        // parallel rectangles.
        shortest.map_or(normal_gap, |v| self.gap(v).max(normal_gap))
    }

    /// Returns the shortest vector between an edge of A that bounds coordinate `I` and one of B that bounds
    /// `K`, if it points outwards from both. `rt` holds the coordinates of `t` along B's sides.
    #[inline]
    fn edge_pairs<const I: usize, const K: usize>(&self, rt: [f64; 2]) -> Option<[f64; 3]> {
        let Self { a, b, t, r } = self;
        let reach_b = b[0] * r[0][I].abs() + b[1] * r[1][I].abs();
        let reach_a = a[0] * r[K][0].abs() + a[1] * r[K][1].abs();
        // In B's frame, A's centre is at `-rt`.
        let (at_a, at_b) = (-rt[K], t[I]);
        for side_a in [1.0, -1.0] {
            if side_a * at_b + reach_b <= a[I] {
                continue;
            }
            for side_b in [1.0, -1.0] {
                if side_b * at_a + reach_a <= b[K] {
                    continue;
                }
                let shortest = self.shortest::<I, K>(rt, side_a, side_b);
                if shortest.is_some() {
                    return shortest;
                }
            }
        }
        None
    }

    /// Returns the shortest vector between one pair of edges, if it points outwards from both. `side_a` and
    /// `side_b` select the edges.
    #[inline]
    fn shortest<const I: usize, const K: usize>(
        &self,
        rt: [f64; 2],
        side_a: f64,
        side_b: f64,
    ) -> Option<[f64; 3]> {
        let Self { a, b, t, r } = self;
        let (j, l) = (1 - I, 1 - K);
        let (along, across) = (r[l], r[K]);
        let (at_a, at_b) = (side_a * a[I], side_b * b[K]);
        // Checks whether each edge extends beyond the other one.
        let beyond_a = t[I] + at_b * across[I] - at_a;
        let beyond_b = rt[K] + at_b - at_a * across[I];
        if side_a * beyond_a + b[l] * along[I].abs() < 0.0
            || a[j] * across[j].abs() - side_b * beyond_b < 0.0
        {
            return None;
        }
        // The vector between the midpoints, along both edges.
        let w_a = t[j] + at_b * across[j];
        let w_b = rt[l] - at_a * along[I];
        let cosine = along[j];
        let sine_square = 1.0 - cosine * cosine;
        let mut p = 0.0;
        if sine_square > 0.0 {
            p = ((w_a - cosine * w_b) / sine_square).clamp(-a[j], a[j]);
        }
        let q = (p * cosine - w_b).clamp(-b[l], b[l]);
        p = (w_a + q * cosine).clamp(-a[j], a[j]);
        let v_i = beyond_a + q * along[I];
        let v_across = beyond_b - p * across[j];
        if side_a * v_i < 0.0 || side_b * v_across > 0.0 {
            return None;
        }
        let mut v = [0.0; 3];
        v[I] = v_i;
        v[j] = w_a + q * along[j] - p;
        v[2] = t[2] + at_b * across[2] + q * along[2];
        Some(v)
    }

    /// Returns the gap along a direction, at least 0; 0 for a zero vector.
    #[inline]
    fn gap(&self, v: [f64; 3]) -> f64 {
        let Self { a, b, t, r } = self;
        let dot = |u: &[f64; 3]| u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
        let length = dot(&v).sqrt();
        if length == 0.0 {
            return 0.0;
        }
        let reach_a = a[0] * v[0].abs() + a[1] * v[1].abs();
        let reach_b = b[0] * dot(&r[0]).abs() + b[1] * dot(&r[1]).abs();
        ((dot(t) - reach_a - reach_b) / length).max(0.0)
    }

    /// Returns the larger gap along the two normals.
    #[inline]
    fn normal_gap(&self) -> f64 {
        let Self { a, b, t, r } = self;
        let along_z = t[2].abs() - b[0] * r[0][2].abs() - b[1] * r[1][2].abs();
        let n = DVec3::from_array(r[0]).cross(DVec3::from_array(r[1]));
        let along_n = n.dot(DVec3::from_array(*t)).abs() - a[0] * n.x.abs() - a[1] * n.y.abs();
        along_z.max(along_n)
    }
}
