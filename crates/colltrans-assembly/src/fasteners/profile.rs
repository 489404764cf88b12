//! Profile of a solid about an axis: sections at rows along it.
//!
//! Notation: `a` is the unit direction of the axis, `z` the coordinate along it, `r` the distance from it. A *row* is
//! the section with a plane `z = const`. An edge of a row faces *outward* if the normal of its facet points away from
//! the axis, otherwise *inward*. The outer ring has the outward edges, the hole the inward ones. There is no hole if
//! the axis is in the material.
//!
//! - The axis is parallel to the flat faces across it. Its place is the point that the normals of the lateral facets
//!   meet best (weighted least squares, [`ROUNDS`] times with weights that reduce outliers).
//! - [`Ring::symmetry`]: `|sum l exp(i k t)| / sum l` over the edges of length `l` with normals at angle `t`. It is 1
//!   for a regular polygon with `k` sides, and small for a circle.

use std::f64::consts::TAU;

use colltrans::Solid;
use glam::{DMat3, DVec2, DVec3};

/// Number of angular bins of a ring.
pub(super) const BINS: usize = 48;
/// Minimum cosine of the angle between a facet across the axis and the axis: 2 degrees.
const FLAT_COSINE: f64 = 0.999_4;
/// Number of rounds of the least squares.
const ROUNDS: usize = 3;
/// Distance of a normal from the axis that halves the weight of a facet, as a share of the radius.
const OUTLIER_SHARE: f64 = 0.05;

/// Maximum relative distance of the vertices of a circle from its radius about the axis.
const CIRCLE_SHARE: f64 = 0.01;
/// Minimum number of vertices of a circle.
const MIN_CIRCLE: usize = 6;

/// A solid in cylindrical coordinates about an axis.
pub(super) struct Profile {
    /// A point on the axis with `z = 0`, and the unit direction.
    pub(super) axis: [DVec3; 2],
    /// Range of `z`.
    pub(super) range: [f64; 2],
    /// Vertices as `x, y` across the axis and `z` along it.
    pub(super) vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// Number of visits of facets and vertices.
    pub(super) work: u64,
}

/// The edges of a row that face outward, or those that face inward.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Ring {
    /// Largest distance of a corner from the axis.
    pub(super) most: f64,
    /// Least distance of an edge from the axis.
    pub(super) least: f64,
    /// Median distance over the covered angles.
    pub(super) median: f64,
    /// Share of the angles at which there is an edge.
    pub(super) cover: f64,
    /// Symmetry of the normals of order 2, 4 and 6.
    pub(super) symmetry: [f64; 3],
    /// First Fourier coefficient of the distance over the angle, relative to the median distance.
    pub(super) first: DVec2,
}

/// A section across the axis.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Row {
    pub(super) z: f64,
    pub(super) outer: Ring,
    pub(super) hole: Ring,
}

impl Ring {
    /// Checks whether the ring is a circle or a polygon of at least eight sides around the axis.
    pub(super) fn is_round(&self) -> bool {
        self.cover > 0.97 && self.least > 0.92 * self.most && self.symmetry[2] < 0.9
    }

    /// Checks whether the ring is a regular hexagon around the axis.
    pub(super) fn is_hexagon(&self) -> bool {
        let ratio = self.least / self.most;
        self.cover > 0.97 && self.symmetry[2] > 0.9 && (0.83..0.95).contains(&ratio)
    }
}

/// An edge of a row.
struct Edge {
    ends: [DVec2; 2],
    normal: DVec2,
}

impl Edge {
    /// Returns the angle that the edge subtends at the axis.
    fn angle(&self) -> f64 {
        self.ends[0].angle_to(self.ends[1]).abs()
    }
}

impl Profile {
    /// Builds the profile about a line near the axis: `direction` is nearly parallel to it.
    pub(super) fn new(solid: &Solid, direction: DVec3) -> Option<Self> {
        let mut work = 0;
        let corners = |t: &[u32; 3]| t.map(|v| solid.vertices()[v as usize]);
        let mut axis = direction;
        for _ in 0..2 {
            let mut sum = DVec3::ZERO;
            for t in solid.triangles() {
                let [a, b, c] = corners(t);
                let normal = (b - a).cross(c - a);
                let along = normal.dot(axis);
                if along.abs() > FLAT_COSINE * normal.length() {
                    sum += normal * along.signum();
                }
            }
            work += solid.triangles().len() as u64;
            axis = (sum.try_normalize().unwrap_or(axis)).normalize();
        }
        let (u, v) = axis.any_orthonormal_pair();
        let local = |p: &DVec3| DVec3::new(p.dot(u), p.dot(v), p.dot(axis));
        let vertices: Vec<DVec3> = solid.vertices().iter().map(local).collect();
        let mut profile = Self {
            axis: [DVec3::ZERO, axis],
            range: [0.0; 2],
            vertices,
            triangles: solid.triangles().to_vec(),
            work,
        };
        let center = profile.fitted_center()?;
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for p in &mut profile.vertices {
            *p -= center.extend(0.0);
            (low, high) = (low.min(p.z), high.max(p.z));
        }
        profile.axis[0] = u * center.x + v * center.y;
        profile.range = [low, high];
        (high > low).then_some(profile)
    }

    /// Returns the profile with the opposite direction of the axis.
    pub(super) fn reversed(mut self) -> Self {
        for p in &mut self.vertices {
            // A rotation by half a turn about the first lateral direction keeps the orientation.
            *p = DVec3::new(p.x, -p.y, -p.z);
        }
        let [low, high] = self.range;
        self.range = [-high, -low];
        self.axis[1] = -self.axis[1];
        self
    }

    /// Returns the length along the axis.
    pub(super) fn length(&self) -> f64 {
        self.range[1] - self.range[0]
    }

    /// Returns the largest distance of a vertex from the axis.
    pub(super) fn radius(&self) -> f64 {
        self.vertices.iter().map(|p| p.truncate().length()).fold(0.0, f64::max)
    }

    /// Iterates over the facets: corners and twice the area vector.
    pub(super) fn facets(&self) -> impl Iterator<Item = ([DVec3; 3], DVec3)> {
        self.triangles.iter().map(|t| {
            let [a, b, c] = t.map(|v| self.vertices[v as usize]);
            ([a, b, c], (b - a).cross(c - a))
        })
    }

    /// Returns the point that the normals of the lateral facets meet best.
    fn fitted_center(&mut self) -> Option<DVec2> {
        let count = self.vertices.len() as f64;
        let mut center = self.vertices.iter().map(|p| p.truncate()).sum::<DVec2>() / count;
        let size = self.vertices.iter().map(|p| p.truncate().distance(center)).fold(0.0, f64::max);
        for round in 0..ROUNDS {
            let (mut xx, mut xy, mut yy, mut sum) = (0.0, 0.0, 0.0, DVec2::ZERO);
            for ([a, b, c], normal) in self.facets() {
                let lateral = normal.truncate();
                let area = lateral.length();
                if area <= 0.1 * normal.length() {
                    continue;
                }
                let across = lateral.perp() / area;
                let middle = ((a + b + c) / 3.0).truncate();
                let off = across.dot(middle - center) / (OUTLIER_SHARE * size);
                let weight = if round == 0 { area } else { area / (1.0 + off * off) };
                let t = across * weight;
                (xx, xy, yy) = (xx + t.x * across.x, xy + t.x * across.y, yy + t.y * across.y);
                sum += t * across.dot(middle);
            }
            self.work += self.triangles.len() as u64;
            let determinant = xx * yy - xy * xy;
            if determinant <= 1e-9 * (xx + yy) * (xx + yy) {
                return None;
            }
            center = DVec2::new(yy * sum.x - xy * sum.y, xx * sum.y - xy * sum.x) / determinant;
        }
        center.is_finite().then_some(center)
    }

    /// Returns the largest distance of the vertices near a radius about the axis, within a range along it, from the
    /// centre of a circle through them (linear least squares); `None` if they are too few. An error of the axis does
    /// not affect it.
    pub(super) fn circle_radius(&self, radius: f64, [low, high]: [f64; 2]) -> Option<f64> {
        let within = self.vertices.iter().filter(|p| p.z >= low && p.z <= high);
        let all = within.map(|p| p.truncate());
        let points = all.filter(|p| (p.length() - radius).abs() <= CIRCLE_SHARE * radius);
        let points: Vec<DVec2> = points.collect();
        let (mut matrix, mut sum) = (DMat3::ZERO, DVec3::ZERO);
        for p in &points {
            let row = DVec3::new(2.0 * p.x, 2.0 * p.y, 1.0);
            matrix += DMat3::from_cols(row * row.x, row * row.y, row * row.z);
            sum += row * p.length_squared();
        }
        if points.len() < MIN_CIRCLE || matrix.determinant().abs() <= f64::MIN_POSITIVE {
            return None;
        }
        let center = (matrix.inverse() * sum).truncate();
        Some(points.iter().map(|p| p.distance(center)).fold(0.0, f64::max))
    }

    /// Returns the share of the lateral area whose normals deviate at most 31 degrees from the radial plane: all of a
    /// surface of revolution, and of a hexagon.
    pub(super) fn revolved_share(&mut self) -> f64 {
        let (mut all, mut round) = (0.0, 0.0);
        for ([a, b, c], normal) in self.facets() {
            let lateral = normal.truncate();
            let area = lateral.length();
            if area > 0.1 * normal.length() {
                let out = ((a + b + c) / 3.0).truncate().normalize_or_zero();
                all += area;
                if out.perp_dot(lateral).abs() <= 0.515 * area {
                    round += area;
                }
            }
        }
        self.work += self.triangles.len() as u64;
        if all > 0.0 { round / all } else { 0.0 }
    }

    /// Returns `count` evenly spaced rows between two coordinates.
    pub(super) fn rows(&mut self, range: [f64; 2], count: usize) -> Vec<Row> {
        let (rows, visits) = cut_rows(self.facets(), range, count);
        self.work += visits;
        rows
    }
}

/// Returns `count` evenly spaced rows of the facets of a solid that come within `reach` of an axis, with `z` measured
/// from the point of the axis.
pub(super) fn rows_about(
    solid: &Solid,
    [point, axis]: [DVec3; 2],
    range: [f64; 2],
    (count, reach): (usize, f64),
) -> Vec<Row> {
    let (u, v) = axis.any_orthonormal_pair();
    let local = |k: &u32| {
        let p = solid.vertices()[*k as usize] - point;
        DVec3::new(p.dot(u), p.dot(v), p.dot(axis))
    };
    let facets = solid.triangles().iter().filter_map(|t| {
        let corners = [local(&t[0]), local(&t[1]), local(&t[2])];
        let [a, b, c] = corners;
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let is_near = low.x <= reach && low.y <= reach && high.x >= -reach && high.y >= -reach;
        let is_along = low.z <= range[1] && high.z >= range[0];
        (is_near && is_along).then(|| (corners, (b - a).cross(c - a)))
    });
    cut_rows(facets.filter(|(corners, _)| axis_distance(corners) <= reach), range, count).0
}

/// Returns the distance of the projection of a facet across the axis from the axis; 0 if the axis passes through.
fn axis_distance(corners: &[DVec3; 3]) -> f64 {
    crate::threads::triangle_distance(DVec2::ZERO, corners.map(DVec3::truncate))
}

/// Returns `count` evenly spaced rows of some facets between two coordinates, and the number of visits.
fn cut_rows(
    facets: impl Iterator<Item = ([DVec3; 3], DVec3)>,
    [low, high]: [f64; 2],
    count: usize,
) -> (Vec<Row>, u64) {
    let step = (high - low) / count as f64;
    let mut edges: Vec<Vec<Edge>> = (0..count).map(|_| Vec::new()).collect();
    let height = |k: usize| low + (k as f64 + 0.5) * step;
    let mut visits = 0;
    for (corners, normal) in facets {
        let [least, most] = [f64::min, f64::max]
            .map(|pick| corners.iter().map(|p| p.z).reduce(pick).unwrap_or(low));
        let first = ((least - low) / step - 0.5).ceil().max(0.0);
        let last = ((most - low) / step - 0.5).floor().min(count as f64 - 1.0);
        visits += 1;
        let mut k = first;
        while k <= last {
            visits += 1;
            edges[k as usize].extend(cut_facet(corners, normal, height(k as usize)));
            k += 1.0;
        }
    }
    let row = |(k, edges): (usize, Vec<Edge>)| {
        let is_outward = |e: &&Edge| e.normal.dot(e.ends[0] + e.ends[1]) > 0.0;
        let (outward, inward): (Vec<&Edge>, Vec<&Edge>) = edges.iter().partition(is_outward);
        // Pieces may overlap: the axis is in the material if it is inside more boundaries than holes.
        let turns = |edges: &[&Edge]| edges.iter().map(|e| e.angle()).sum::<f64>() / TAU;
        let is_full = turns(&outward) - turns(&inward) > 0.5;
        Row {
            z: height(k),
            outer: Ring::from_edges(&outward, f64::max),
            hole: if is_full { Ring::default() } else { Ring::from_edges(&inward, f64::min) },
        }
    };
    (edges.into_iter().enumerate().map(row).collect(), visits)
}

/// Returns the median of some numbers; 0 without any.
pub(super) fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut all: Vec<f64> = values.collect();
    all.sort_by(f64::total_cmp);
    all.get(all.len() / 2).copied().unwrap_or(0.0)
}

/// Returns the edge in which a facet meets a plane across the axis.
fn cut_facet(corners: [DVec3; 3], normal: DVec3, z: f64) -> Option<Edge> {
    let mut ends = [DVec2::ZERO; 2];
    let mut count = 0;
    for k in 0..3 {
        let (a, b) = (corners[k], corners[(k + 1) % 3]);
        if (a.z < z) != (b.z < z) && count < 2 {
            ends[count] = (a + (b - a) * ((z - a.z) / (b.z - a.z))).truncate();
            count += 1;
        }
    }
    let normal = normal.truncate().try_normalize().filter(|_| count == 2)?;
    Some(Edge { ends, normal })
}

impl Ring {
    /// Measures some edges. Of several at one angle, `pick` selects the outermost or the innermost.
    fn from_edges(edges: &[&Edge], pick: impl Fn(f64, f64) -> f64) -> Self {
        let mut bins: [Option<f64>; BINS] = [None; BINS];
        let (mut most, mut least, mut length) = (0.0_f64, f64::INFINITY, 0.0);
        let mut sums = [DVec2::ZERO; 3];
        for Edge { ends: [p, q], normal } in edges {
            let along = *q - *p;
            let own = along.length();
            if own == 0.0 {
                continue;
            }
            most = most.max(p.length()).max(q.length());
            let share = (-p.dot(along) / (own * own)).clamp(0.0, 1.0);
            least = least.min((*p + along * share).length());
            length += own;
            for (sum, order) in sums.iter_mut().zip([2.0, 4.0, 6.0]) {
                *sum += DVec2::from_angle(order * normal.to_angle()) * own;
            }
            // The bins whose middles the edge passes.
            let turn = |p: DVec2| p.to_angle() / TAU * BINS as f64 - 0.5;
            let (mut from, mut to) = (turn(*p), turn(*q));
            if from > to {
                (from, to) = (to, from);
            }
            if to - from > BINS as f64 / 2.0 {
                (from, to) = (to, from + BINS as f64);
            }
            let mut k = from.ceil();
            while k <= to {
                let out = DVec2::from_angle((k + 0.5) / BINS as f64 * TAU);
                let r = normal.dot(*p) / normal.dot(out);
                let bin = &mut bins[(k.rem_euclid(BINS as f64)) as usize % BINS];
                *bin = Some(bin.map_or(r, |known| pick(known, r)));
                k += 1.0;
            }
        }
        let median = median(bins.iter().flatten().copied());
        let mut first = DVec2::ZERO;
        for (k, r) in bins.iter().enumerate() {
            let angle = (k as f64 + 0.5) / BINS as f64 * TAU;
            first += DVec2::from_angle(angle) * r.unwrap_or(0.0);
        }
        let share = |x: f64, of: f64| if of > 0.0 { x / of } else { 0.0 };
        Self {
            most,
            least: if least.is_finite() { least } else { 0.0 },
            median,
            cover: bins.iter().flatten().count() as f64 / BINS as f64,
            symmetry: sums.map(|sum| share(sum.length(), length)),
            first: first * share(2.0 / BINS as f64, median),
        }
    }
}
