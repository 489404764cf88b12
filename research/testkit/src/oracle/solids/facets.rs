//! Evaluates the rule for clearances over all pairs of facets, in exact arithmetic.
//!
//! A facet of the moving body with `n.d > 0` and a facet of the fixed body with `n.d < 0` form a pair if the
//! interiors of their shadows overlap. Over the common shadow the gap `h_g - h_f` is linear. The pair counts if
//! the maximum gap is positive, or if the gap is zero everywhere. It contributes the minimum gap, or 0 if that
//! is negative. The common shadow is computed by clipping one triangle with the sides of the other, with
//! corners as quotients of exact numbers.

use std::cmp::Ordering;

use glam::{DMat3, DVec3};

use crate::oracle::exact::{Dyadic, Ratio, Vector, place};

/// A triangle in the world.
pub type Triangle = [Vector; 3];

/// A point of the shadow plane in homogeneous coordinates, the last one positive.
type Point = [Dyadic; 3];

/// The result of the rule.
#[derive(Debug, Clone, Default)]
pub struct Rule {
    /// The minimum contribution of a pair that counts.
    pub stop: Option<Ratio>,
    /// The maximum gap between a back facet of the moving and a front facet of the fixed body.
    pub exit: Option<Ratio>,
}

/// Returns the triangles of a body in the world.
pub fn triangles(
    vertices: &[DVec3],
    facets: &[[u32; 3]],
    (matrix, translation): (DMat3, DVec3),
) -> Vec<Triangle> {
    let placed = place(matrix, translation, vertices);
    facets.iter().map(|f| f.map(|v| placed[v as usize].clone())).collect()
}

/// Applies the rule to bodies that do not overlap.
pub fn rule(moving: &[Triangle], fixed: &[Triangle], direction: DVec3) -> Rule {
    let judge = FacetJudge::new(direction);
    let mut rule = Rule::default();
    for f in moving {
        for g in fixed {
            let (n, m) = (judge.facing(f), judge.facing(g));
            if n == m || n == Ordering::Equal || m == Ordering::Equal {
                continue;
            }
            let gaps = judge.gaps(f, g);
            if gaps.front {
                if let Some(from) = gaps.contribution()
                    && rule.stop.as_ref().is_none_or(|s| from < *s)
                {
                    rule.stop = Some(from);
                }
            } else if let Some([_, largest]) = gaps.range
                && rule.exit.as_ref().is_none_or(|e| *e < largest)
            {
                rule.exit = Some(largest);
            }
        }
    }
    rule
}

/// Evaluates pairs of facets along a direction.
pub struct FacetJudge {
    direction: Vector,
    plane: Plane,
}

/// The range of the gap of two facets.
#[derive(Debug, Clone)]
pub struct Gaps {
    /// Whether a front facet of the moving body faces a back facet of the fixed one.
    pub front: bool,
    /// The minimum and maximum gap; `None` unless the interiors of the shadows overlap.
    pub range: Option<[Ratio; 2]>,
}

impl Gaps {
    /// Returns the contribution of the pair; `None` if it does not count.
    pub fn contribution(&self) -> Option<Ratio> {
        let [least, largest] = self.range.clone().filter(|_| self.front)?;
        let zero = Ratio::from_f64(0.0);
        let counts = largest > zero || least == largest && largest == zero;
        counts.then(|| if least < zero { zero } else { least })
    }
}

impl FacetJudge {
    /// Builds the judge of a direction.
    pub fn new(direction: DVec3) -> Self {
        Self::along(Vector::new(direction))
    }

    /// Builds the judge of an exact direction.
    pub fn along(direction: Vector) -> Self {
        Self { plane: Plane::new(&direction), direction }
    }

    /// Returns whether a facet points along the direction (`Greater`) or against it.
    pub fn facing(&self, triangle: &Triangle) -> Ordering {
        let along = facet_normal(triangle).dot(&self.direction);
        if along.is_positive() {
            Ordering::Greater
        } else if along.is_negative() {
            Ordering::Less
        } else {
            Ordering::Equal
        }
    }

    /// Returns the gaps between a facet of the moving and one of the fixed body.
    pub fn gaps(&self, f: &Triangle, g: &Triangle) -> Gaps {
        let (n, m) = (self.facing(f), self.facing(g));
        let sides = n != Ordering::Equal && m != Ordering::Equal;
        let range = if sides { self.plane.gaps(f, g, &self.direction) } else { None };
        Gaps { front: n == Ordering::Greater && m == Ordering::Less, range }
    }
}

fn facet_normal([a, b, c]: &Triangle) -> Vector {
    b.minus(a).cross(&c.minus(a))
}

/// Coordinates of the shadow: affine, exact, constant along the direction.
struct Plane {
    axis: usize,
    direction: Vector,
}

impl Plane {
    fn new(direction: &Vector) -> Self {
        let axis = (0..3).find(|&k| !direction.0[k].is_zero()).expect("a direction");
        Self { axis, direction: direction.clone() }
    }

    fn shadow(&self, p: &Vector) -> Point {
        let (k, d) = (self.axis, &self.direction.0);
        let [x, y] = [(k + 1) % 3, (k + 2) % 3].map(|i| &(&p.0[i] * &d[k]) - &(&p.0[k] * &d[i]));
        [x, y, Dyadic::new(1.0)]
    }

    /// Returns the range of the gap over the common shadow; `None` if that has no interior.
    fn gaps(&self, f: &Triangle, g: &Triangle, direction: &Vector) -> Option<[Ratio; 2]> {
        let counter_clockwise = |t: &Triangle| {
            let mut corners: Vec<Point> = t.iter().map(|p| self.shadow(p)).collect();
            if orientation(&corners[0], &corners[1], &corners[2]).is_negative() {
                corners.reverse();
            }
            corners
        };
        let clip = counter_clockwise(g);
        let mut common = counter_clockwise(f);
        for k in 0..3 {
            common = cut_polygon(&common, &clip[k], &clip[(k + 1) % 3]);
        }
        let n = common.len();
        let has_area =
            (2..n).any(|k| orientation(&common[0], &common[k - 1], &common[k]).is_positive());
        if !has_area {
            return None;
        }
        let heights = common.iter().map(|p| {
            let (a, b) = (self.height(f, p, direction), self.height(g, p, direction));
            b.minus(&a)
        });
        let mut range: Option<[Ratio; 2]> = None;
        for gap in heights {
            range = Some(match range {
                None => [gap.clone(), gap],
                Some([low, high]) => {
                    [if gap < low { gap.clone() } else { low }, if gap > high { gap } else { high }]
                }
            });
        }
        range
    }

    /// Returns the `t` at which the point of the facet's plane over a shadow is `t d` beyond the coordinate
    /// plane of shadows.
    fn height(&self, triangle: &Triangle, shadow: &Point, direction: &Vector) -> Ratio {
        // In the coordinate plane of `axis`, the point with this shadow is `x / (w d_k)`.
        let k = self.axis;
        let mut base = [Dyadic::ZERO, Dyadic::ZERO, Dyadic::ZERO];
        base[(k + 1) % 3] = shadow[0].clone();
        base[(k + 2) % 3] = shadow[1].clone();
        let n = facet_normal(triangle);
        let scale = &shadow[2] * &self.direction.0[k];
        // Solves n . (base / scale + t d - a) = 0.
        let above = &(&n.dot(&triangle[0]) * &scale) - &n.dot(&Vector(base));
        Ratio::new(above, &n.dot(direction) * &scale)
    }
}

/// Returns `det[b - a, c - a]` times the (positive) last coordinates.
fn orientation(a: &Point, b: &Point, c: &Point) -> Dyadic {
    let minor = |p: &Point, q: &Point, i: usize, j: usize| &(&p[i] * &q[j]) - &(&p[j] * &q[i]);
    let x = &a[0] * &minor(b, c, 1, 2);
    let y = &a[1] * &minor(b, c, 2, 0);
    let z = &a[2] * &minor(b, c, 0, 1);
    &(&x + &y) + &z
}

/// Returns the part of a convex polygon to the left of a line (Sutherland and Hodgman).
fn cut_polygon(polygon: &[Point], a: &Point, b: &Point) -> Vec<Point> {
    let mut kept = Vec::new();
    for (k, p) in polygon.iter().enumerate() {
        let q = &polygon[(k + 1) % polygon.len()];
        let (s, t) = (orientation(a, b, p), orientation(a, b, q));
        if !s.is_negative() {
            kept.push(p.clone());
        }
        if s.is_positive() && t.is_negative() || s.is_negative() && t.is_positive() {
            // `s` and `t` contain the last coordinates of `p` and `q`, so the point is `p t - q s`.
            let (s, t) = if s.is_negative() { (-s, t) } else { (s, -t) };
            kept.push([0, 1, 2].map(|i| &(&p[i] * &t) + &(&q[i] * &s)));
        }
    }
    kept
}
