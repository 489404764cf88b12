//! Exact convex cells, cut by planes, and the parts of facets in them.
//!
//! - Coordinates are integers: multiples of a power of two, relative to a base point. A vertex of a cell is a solution of
//!   three plane equations, in homogeneous coordinates. Its size does not grow with the number of cuts.
//! - Each vertex and each plane has a rounded value as well. A sign is computed from rounded values if it exceeds their
//!   error, otherwise exactly.
//! - A polygon lies in a plane. The edge after each corner lies in another plane, so that a cut at this edge is a
//!   solution of three equations.
//! - The faces of a cell point outwards. A cut replaces the faces beyond its plane by one face in it.

use std::cmp::Ordering;
use std::collections::HashMap;
use std::rc::Rc;

use glam::DVec3;

use colltrans_kernel::big::Big;

/// Relative error of a rounded plane equation, of at most four products.
const EQUATION_ERROR: f64 = 1.0 / (1_u64 << 48) as f64;
/// Relative error of a rounded coordinate.
const COORDINATE_ERROR: f64 = 1.0 / (1_u64 << 51) as f64;
/// Error of numbers below the range.
const TINY: f64 = f64::from_bits((1023 - 700) << 52);
/// Largest relative error of a volume that is computed from rounded coordinates.
const VOLUME_ERROR: f64 = 1.0 / (1_u64 << 42) as f64;
/// Bits of a limb for [`work_of_bits`].
const FREE_BITS: u32 = 256;

/// Three coordinates and their common denominator, which is positive.
pub(super) type Homogeneous = [Big; 4];

/// Returns `m 2^e`; 0 below the range.
pub(super) fn scaled(mantissa: f64, exponent: i64) -> f64 {
    if mantissa == 0.0 || exponent < -1000 {
        return 0.0;
    }
    let power = |e: i64| f64::from_bits(((1023 + e.clamp(-1022, 1023)) as u64) << 52);
    mantissa * power(exponent / 2) * power(exponent - exponent / 2)
}

/// Returns the factor by which numbers of this size make arithmetic slower.
pub(super) fn work_of_bits(bits: u32) -> u64 {
    let size = u64::from(1 + bits / FREE_BITS);
    size * size
}

/// A point, exact and rounded.
#[derive(Debug)]
pub(super) struct Vertex {
    exact: Homogeneous,
    /// Rounded position relative to the base point, in world units.
    pub(super) near: DVec3,
    /// Bound of the error of its coordinates.
    error: f64,
}

impl Vertex {
    /// Builds a vertex of homogeneous coordinates, whose unit is `2^unit`.
    pub(super) fn new(exact: Homogeneous, unit: i32) -> Self {
        let (denominator, below) = exact[3].rounded();
        let near = DVec3::from_array([0, 1, 2].map(|k| {
            let (numerator, above) = exact[k].rounded();
            scaled(numerator / denominator, above - below + i64::from(unit))
        }));
        // Also that of adding the error.
        let error = near.abs().max_element() * 2.0 * COORDINATE_ERROR + TINY;
        Self { exact, near, error }
    }

    /// Returns the rounded position less its error.
    pub(super) fn lowest(&self) -> DVec3 {
        self.near - DVec3::splat(self.error)
    }

    /// Returns the rounded position plus its error.
    pub(super) fn highest(&self) -> DVec3 {
        self.near + DVec3::splat(self.error)
    }

    /// Returns the point in which three planes meet; `None` if there is none.
    pub(super) fn from_planes([f, g, h]: [&Plane; 3], unit: i32) -> Option<Self> {
        let minors = cross(&g.normal, &h.normal);
        let mut weight = dot(&f.normal, &minors);
        let is_negative = match weight.sign() {
            Ordering::Equal => return None,
            sign => sign == Ordering::Less,
        };
        let [others, last] = [cross(&h.normal, &f.normal), cross(&f.normal, &g.normal)];
        let coordinate = |k: usize| {
            let sum = &(&minors[k] * &f.offset) + &(&others[k] * &g.offset);
            let sum = &sum + &(&last[k] * &h.offset);
            if is_negative { sum } else { -&sum }
        };
        let [x, y, z] = [coordinate(0), coordinate(1), coordinate(2)];
        if is_negative {
            weight = -&weight;
        }
        Some(Self::new([x, y, z, weight], unit))
    }

    /// Returns the mean of four points.
    pub(super) fn mean(points: [&Self; 4], unit: i32) -> Self {
        let others = |k: usize| {
            let weights = (0..4).filter(|i| *i != k).map(|i| &points[i].exact[3]);
            weights.fold(Big::power_of_two(0), |product, w| &product * w)
        };
        let factors = [0, 1, 2, 3].map(others);
        let sum = |axis: usize| {
            let terms = (0..4).map(|k| &points[k].exact[axis] * &factors[k]);
            terms.fold(Big::default(), |sum, term| &sum + &term)
        };
        let weight = (&factors[0] * &points[0].exact[3]).shifted(2);
        Self::new([sum(0), sum(1), sum(2), weight], unit)
    }
}

/// The points `p` with `normal . p + offset = 0`.
#[derive(Debug)]
pub(super) struct Plane {
    normal: [Big; 3],
    offset: Big,
    /// Rounded equation, scaled so that the largest component of the normal is from 1/2 to 1.
    near: DVec3,
    near_offset: f64,
}

impl Plane {
    /// Builds a plane of its equation in units of `2^unit`; `None` if the normal is 0.
    fn new(normal: [Big; 3], offset: Big, unit: i32) -> Option<Self> {
        let parts = normal.each_ref().map(Big::rounded);
        let top = parts.iter().filter(|part| part.0 != 0.0).map(|part| part.1).max()?;
        let near = DVec3::from_array(parts.map(|(m, e)| scaled(m, e - top)));
        let (mantissa, exponent) = offset.rounded();
        let near_offset = scaled(mantissa, exponent - top + i64::from(unit));
        Some(Self { normal, offset, near, near_offset })
    }

    /// Builds the plane through a point with integer coordinates.
    fn through(normal: [Big; 3], point: &Homogeneous, unit: i32) -> Option<Self> {
        let offset = -&dot(&normal, &[point[0].clone(), point[1].clone(), point[2].clone()]);
        Self::new(normal, offset, unit)
    }

    /// Builds the plane of a triangle whose corners have integer coordinates; `None` if it has no area.
    pub(super) fn of_triangle([a, b, c]: [&Vertex; 3], unit: i32) -> Option<Self> {
        let [u, v] = [between(a, b), between(a, c)];
        let mut normal = cross(&u, &v);
        let is_zero = normal.each_ref().map(|part| part.sign() == Ordering::Equal);
        if let Some(axis) = (0..3).find(|k| (0..3).all(|i| i == *k || is_zero[i])) {
            // Small numbers for the plane of an axis.
            if !is_zero[axis] {
                let one = Big::power_of_two(0);
                let is_negative = normal[axis].sign() == Ordering::Less;
                normal[axis] = if is_negative { -&one } else { one };
            }
        }
        Self::through(normal, &a.exact, unit)
    }

    /// Builds the plane through an edge and an axis; `None` if the edge is parallel to the axis.
    pub(super) fn of_edge([a, b]: [&Vertex; 2], axis: usize, unit: i32) -> Option<Self> {
        let along = between(a, b);
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut normal = [Big::default(), Big::default(), Big::default()];
        // The vector product of the axis and the edge.
        normal[i] = -&along[j];
        normal[j] = along[i].clone();
        Self::through(normal, &a.exact, unit)
    }

    /// Builds the plane of the points whose coordinate on an axis is that of a point, with its normal along the axis.
    pub(super) fn of_coordinate(point: &Vertex, axis: usize, unit: i32) -> Option<Self> {
        let mut normal = [Big::default(), Big::default(), Big::default()];
        normal[axis] = point.exact[3].clone();
        Self::new(normal, -&point.exact[axis], unit)
    }

    /// Returns the sign of the normal's component along an axis.
    pub(super) fn facing(&self, axis: usize) -> Ordering {
        self.normal[axis].sign()
    }

    /// Returns the axis of the largest component of the normal, which is not 0.
    pub(super) fn main_axis(&self) -> usize {
        self.near.abs().max_position()
    }

    /// Returns the rounded normal.
    pub(super) fn near_normal(&self) -> DVec3 {
        self.near
    }

    /// Returns the side of the plane on which a point lies.
    pub(super) fn side(&self, point: &Vertex) -> Ordering {
        let terms = self.near * point.near;
        let value = terms.element_sum() + self.near_offset;
        let size = terms.abs().element_sum() + self.near_offset.abs();
        let error = size * EQUATION_ERROR + 4.0 * point.error + TINY;
        if value > error {
            return Ordering::Greater;
        }
        if value < -error {
            return Ordering::Less;
        }
        let [x, y, z, w] = &point.exact;
        let [a, b, c] = &self.normal;
        let sum = &(&(a * x) + &(b * y)) + &(&(c * z) + &(&self.offset * w));
        sum.sign()
    }
}

fn cross(a: &[Big; 3], b: &[Big; 3]) -> [Big; 3] {
    let minor = |i: usize, j: usize| &(&a[i] * &b[j]) - &(&a[j] * &b[i]);
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}

fn dot(a: &[Big; 3], b: &[Big; 3]) -> Big {
    &(&(&a[0] * &b[0]) + &(&a[1] * &b[1])) + &(&a[2] * &b[2])
}

/// Returns the vector between two points with integer coordinates.
fn between(from: &Vertex, to: &Vertex) -> [Big; 3] {
    [0, 1, 2].map(|k| &to.exact[k] - &from.exact[k])
}

/// A corner of a polygon, and the plane through the edge to the next corner.
#[derive(Debug, Clone)]
pub(super) struct Corner {
    pub(super) at: Rc<Vertex>,
    pub(super) edge: Rc<Plane>,
}

/// A convex polygon in a plane.
#[derive(Debug, Clone)]
pub(super) struct Polygon {
    pub(super) plane: Rc<Plane>,
    pub(super) ring: Vec<Corner>,
}

/// Sides of vertices, and new vertices on edges, of one cut.
struct Cut<'p> {
    plane: &'p Rc<Plane>,
    unit: i32,
    sides: HashMap<*const Vertex, Ordering>,
    vertices: HashMap<[*const Vertex; 2], Rc<Vertex>>,
}

impl<'p> Cut<'p> {
    fn new(plane: &'p Rc<Plane>, unit: i32) -> Self {
        Self { plane, unit, sides: HashMap::new(), vertices: HashMap::new() }
    }

    fn side(&mut self, at: &Rc<Vertex>) -> Ordering {
        *self.sides.entry(Rc::as_ptr(at)).or_insert_with(|| self.plane.side(at))
    }

    /// Returns the vertex at which the plane meets the edge between two corners; `None` if the planes are degenerate,
    /// which exact signs exclude.
    fn vertex(&mut self, plane: &Plane, from: &Corner, to: &Corner) -> Option<Rc<Vertex>> {
        let mut ends = [Rc::as_ptr(&from.at), Rc::as_ptr(&to.at)];
        ends.sort_unstable();
        if let Some(known) = self.vertices.get(&ends) {
            return Some(Rc::clone(known));
        }
        let made = Rc::new(Vertex::from_planes([plane, &from.edge, self.plane], self.unit)?);
        self.vertices.insert(ends, Rc::clone(&made));
        Some(made)
    }

    /// Returns the part of a polygon on a side of the plane; `None` if no corner is strictly on this side.
    fn part(&mut self, of: &Polygon, side: Ordering) -> Option<Polygon> {
        let signs: Vec<Ordering> = of.ring.iter().map(|corner| self.side(&corner.at)).collect();
        if !signs.contains(&side) {
            return None;
        }
        if !signs.contains(&side.reverse()) && !has_edge_in_plane(&signs) {
            return Some(of.clone());
        }
        let mut ring = Vec::with_capacity(of.ring.len() + 1);
        for (k, corner) in of.ring.iter().enumerate() {
            let after = (k + 1) % of.ring.len();
            let (here, there) = (signs[k], signs[after]);
            if here != side.reverse() {
                let leaves = here == Ordering::Equal && there != side;
                let edge = if leaves { self.plane } else { &corner.edge };
                ring.push(Corner { at: Rc::clone(&corner.at), edge: Rc::clone(edge) });
            }
            if here != Ordering::Equal && there == here.reverse() {
                let at = self.vertex(&of.plane, corner, &of.ring[after])?;
                let edge = if here == side { self.plane } else { &corner.edge };
                ring.push(Corner { at, edge: Rc::clone(edge) });
            }
        }
        Some(Polygon { plane: Rc::clone(&of.plane), ring })
    }

    /// Returns the face in the plane that closes the other faces of a part; `None` if they do not close up, which exact
    /// signs exclude.
    fn cap(&self, faces: &[Polygon]) -> Option<Polygon> {
        let mut before: HashMap<*const Vertex, (&Rc<Vertex>, &Rc<Plane>)> = HashMap::new();
        let mut first = None;
        for face in faces {
            for (k, corner) in face.ring.iter().enumerate() {
                if Rc::ptr_eq(&corner.edge, self.plane) {
                    let to = &face.ring[(k + 1) % face.ring.len()].at;
                    before.insert(Rc::as_ptr(to), (&corner.at, &face.plane));
                    first = Some(to);
                }
            }
        }
        let (first, mut ring) = (first?, Vec::with_capacity(before.len()));
        let mut at = first;
        for _ in 0..before.len() {
            let (next, plane) = before.get(&Rc::as_ptr(at))?;
            ring.push(Corner { at: Rc::clone(at), edge: Rc::clone(plane) });
            at = next;
        }
        (Rc::ptr_eq(at, first) && ring.len() > 2)
            .then(|| Polygon { plane: Rc::clone(self.plane), ring })
    }
}

/// Checks whether two neighbouring corners lie in the plane.
fn has_edge_in_plane(signs: &[Ordering]) -> bool {
    let is_in = |k: usize| signs[k % signs.len()] == Ordering::Equal;
    (0..signs.len()).any(|k| is_in(k) && is_in(k + 1))
}

/// The part of a facet in a cell.
#[derive(Debug, Clone)]
pub(super) struct Fragment {
    /// The facet, a position in the triangles of its solid.
    pub(super) triangle: u32,
    pub(super) polygon: Polygon,
}

impl Fragment {
    /// Returns the part on a side of the plane of a cut; `None` if no corner is strictly on this side.
    fn part(&self, cut: &mut Cut, side: Ordering) -> Option<Self> {
        let polygon = cut.part(&self.polygon, side)?;
        Some(Self { triangle: self.triangle, polygon })
    }
}

/// A convex polytope with an interior, and the parts of the facets of both bodies that meet its interior.
#[derive(Debug, Clone)]
pub(super) struct Cell {
    pub(super) faces: Vec<Polygon>,
    pub(super) fragments: [Vec<Fragment>; 2],
    /// Whether the cell is inside each body, as far as it is known.
    pub(super) inside: [Option<bool>; 2],
}

impl Cell {
    /// Builds a box from the planes of its sides, the lower one before the higher one on each axis; `None` if it has no
    /// interior.
    pub(super) fn from_box(sides: &[[Rc<Plane>; 2]; 3], unit: i32) -> Option<Self> {
        let corner = |bits: usize| {
            let [x, y, z] = [0, 1, 2].map(|k| &*sides[k][bits >> k & 1]);
            Vertex::from_planes([x, y, z], unit).map(Rc::new)
        };
        let corners: Vec<Rc<Vertex>> = (0..8).map(corner).collect::<Option<_>>()?;
        if (0..3).any(|k| sides[k][0].side(&corners[7]) != Ordering::Greater) {
            return None;
        }
        let face = |axis: usize, high: usize| {
            let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
            let mut turn = [(0, 0), (1, 0), (1, 1), (0, 1)];
            if high == 0 {
                turn.reverse();
            }
            let name = |(p, q): (usize, usize)| high << axis | p << i | q << j;
            let ring = (0..4).map(|k| {
                let (from, to) = (turn[k], turn[(k + 1) % 4]);
                // The edge lies in the side whose bit both corners share.
                let edge = if from.0 == to.0 { &sides[i][from.0] } else { &sides[j][from.1] };
                Corner { at: Rc::clone(&corners[name(from)]), edge: Rc::clone(edge) }
            });
            Polygon { plane: Rc::clone(&sides[axis][high]), ring: ring.collect() }
        };
        let faces = (0..6).map(|k| face(k / 2, k % 2)).collect();
        Some(Self { faces, fragments: [Vec::new(), Vec::new()], inside: [None; 2] })
    }

    /// Returns the number of corners of the faces and of the parts of facets.
    pub(super) fn size(&self) -> u64 {
        let parts = self.fragments.iter().flatten().map(|fragment| &fragment.polygon);
        self.faces.iter().chain(parts).map(|polygon| polygon.ring.len() as u64).sum()
    }

    /// Returns the parts of the cell behind a plane and in front of it; `None` if one of them has no interior.
    pub(super) fn split(&self, plane: &Rc<Plane>, unit: i32) -> Option<[Self; 2]> {
        let mut cut = Cut::new(plane, unit);
        let mut part = |side: Ordering| {
            let mut faces: Vec<Polygon> =
                self.faces.iter().filter_map(|face| cut.part(face, side)).collect();
            if faces.is_empty() {
                return None;
            }
            faces.push(cut.cap(&faces)?);
            Some(faces)
        };
        let [behind, before] = [part(Ordering::Less)?, part(Ordering::Greater)?];
        let mut fragments = |side: Ordering| {
            self.fragments
                .each_ref()
                .map(|all| all.iter().filter_map(|of| of.part(&mut cut, side)).collect())
        };
        let parts = [fragments(Ordering::Less), fragments(Ordering::Greater)];
        let inside = self.inside;
        let [low, high] = parts;
        Some([
            Self { faces: behind, fragments: low, inside },
            Self { faces: before, fragments: high, inside },
        ])
    }

    /// Returns the tetrahedra between a vertex and the triangles of the faces that do not contain it.
    fn tetrahedra(&self) -> impl Iterator<Item = [&Vertex; 4]> {
        let apex = &self.faces[0].ring[0].at;
        let is_opposite =
            move |face: &&Polygon| !face.ring.iter().any(|corner| Rc::ptr_eq(&corner.at, apex));
        self.faces.iter().filter(is_opposite).flat_map(move |face| {
            let at = |k: usize| &*face.ring[k].at;
            (2..face.ring.len()).map(move |k| [&**apex, at(0), at(k - 1), at(k)])
        })
    }

    /// Returns a point of the interior.
    pub(super) fn interior_point(&self, unit: i32) -> Option<Vertex> {
        let size = |corners: &[&Vertex; 4]| near_six_volumes(*corners);
        let largest = self.tetrahedra().max_by(|p, q| size(p).total_cmp(&size(q)))?;
        Some(Vertex::mean(largest, unit))
    }

    /// Returns bounds of the volume in cubic world units.
    pub(super) fn volume(&self, unit: i32) -> [f64; 2] {
        let mut sum = [0.0; 2];
        let mut count = 0;
        for corners in self.tetrahedra() {
            let [low, high] = six_volumes(corners, unit);
            sum = [sum[0] + low, sum[1] + high];
            count += 1;
        }
        let rounding = f64::EPSILON * f64::from(count + 4);
        [sum[0] / 6.0 * (1.0 - rounding), sum[1] / 6.0 * (1.0 + rounding) + f64::MIN_POSITIVE]
    }

    /// Returns the volume of the rounded vertices, without a bound of its error.
    pub(super) fn near_volume(&self) -> f64 {
        self.tetrahedra().map(near_six_volumes).sum::<f64>().max(0.0) / 6.0
    }

    /// Iterates over the vertices, each of which occurs several times.
    pub(super) fn vertices(&self) -> impl Iterator<Item = &Rc<Vertex>> {
        self.faces.iter().flat_map(|face| face.ring.iter().map(|corner| &corner.at))
    }

    /// Returns the parts of facets in the interior of the cell. Facets without such a part are left out.
    pub(super) fn clip(&self, mut all: Vec<Fragment>, unit: i32) -> Vec<Fragment> {
        for face in &self.faces {
            let Some(off_plane) = self.off_plane(face) else { return Vec::new() };
            let inwards = face.plane.side(off_plane);
            let mut cut = Cut::new(&face.plane, unit);
            all = all.iter().filter_map(|of| of.part(&mut cut, inwards)).collect();
        }
        all
    }

    /// Returns a vertex that does not lie in the plane of a face.
    fn off_plane(&self, face: &Polygon) -> Option<&Vertex> {
        let mut all = self.vertices().map(|at| &**at);
        all.find(|at| face.plane.side(at) != Ordering::Equal)
    }
}

/// Returns six times the volume of a tetrahedron with the rounded corners.
fn near_six_volumes([a, b, c, d]: [&Vertex; 4]) -> f64 {
    (b.near - a.near).dot((c.near - a.near).cross(d.near - a.near))
}

/// Returns bounds of six times the volume of a tetrahedron, which is not negative.
fn six_volumes([a, b, c, d]: [&Vertex; 4], unit: i32) -> [f64; 2] {
    let [u, v, w] = [b, c, d].map(|p| p.near - a.near);
    let value = u.dot(v.cross(w));
    let longest = [u, v, w].iter().fold(0.0_f64, |most, e| most.max(e.abs().max_element()));
    let error = [a, b, c, d].iter().fold(0.0_f64, |most, p| most.max(p.error)) * 4.0;
    let off = 64.0 * longest * longest * (error + longest * f64::EPSILON) + TINY;
    if off <= value * VOLUME_ERROR {
        return [value - off, value + off];
    }
    // Rows `p / w_p - a / w_a`, times both denominators.
    let row =
        |p: &Vertex| [0, 1, 2].map(|k| &(&p.exact[k] * &a.exact[3]) - &(&a.exact[k] * &p.exact[3]));
    let exact = dot(&row(b), &cross(&row(c), &row(d)));
    let (mantissa, exponent) = exact.rounded();
    let (mut value, mut power) = (mantissa, exponent + 3 * i64::from(unit));
    for weight in [b, c, d, a, a, a].map(|p| p.exact[3].rounded()) {
        value /= weight.0;
        power -= weight.1;
        // The quotient of two mantissas is from 1/2 to 2.
        (value, power) = (value * 0.5, power + 1);
    }
    let value = scaled(value.max(0.0), power);
    let off = value * VOLUME_ERROR + if exact.sign() == Ordering::Equal { 0.0 } else { TINY };
    [(value - off).max(0.0), value + off]
}
