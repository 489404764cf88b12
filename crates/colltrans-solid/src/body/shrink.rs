//! Offsets of solids: each facet plane moves inwards, or outwards for a negative amount.
//!
//! - Under an offset by `e`, vertex `v` moves to `v + e x`. Here `x` is the shortest vector with `n.x <= -1` for the
//!   unit normals `n` of all facets around the vertex. If no such vector exists (at a saddle), the vertex stays.
//! - `x` does not depend on `e`, so one field of displacements serves all amounts. `v + e x` is computed in floating
//!   point, and coordinates too small for the exact range become 0. The results define the offset body. If `x` is
//!   longer than 64, the vertex stays, too.
//! - Sheets have no inner side. Their vertices, which they share only with other sheets, stay.
//! - Facets with a height below a millionth of the body's reach are ignored if the vertex has others, because in single
//!   precision their normals are noise.
//! - A [`NodeMotion`] bounds the changes of the facets of a node.
//!
//! Derivations: `docs/theory/offsets.md`.

use std::sync::{Mutex, PoisonError};
use std::thread;

use glam::DVec3;

use super::edges::{self, NO_NEIGHBOUR};
use super::error::SolidError;
use super::tree::{self, Node};
use super::{ShellKind, Solid, Surface};
use super::{self_intersection, shells};
use colltrans_convex::body::{Aabb, InputFacet, InputVertex};
use colltrans_kernel::range::{is_in_exact_range, with_tiny_components_zeroed};

/// Height below which the normal of a facet is noise, in multiples of the reach of the body.
const MIN_HEIGHT: f64 = 1e-6;
/// Maximum amount for which the rates of nodes hold, in multiples of the reach of the body.
const MAX_RATE_AMOUNT: f64 = 1.0 / 1024.0;
/// Maximum length of a displacement for amount 1; longer ones count as no solution.
const MAX_DISPLACEMENT: f64 = 64.0;
/// Maximum number of rounds of the search for the nearest point. Each round adds a violated normal.
const MAX_ROUNDS: usize = 64;

/// Displacements of the vertices of a solid under an offset.
#[derive(Debug, Clone)]
pub struct OffsetField {
    /// Displacement of each vertex for an amount of 1.
    pub displacements: Vec<DVec3>,
    /// Bounds on the changes of each node of the tree.
    pub node_motions: Vec<NodeMotion>,
    /// Maximum amount for which the rates of the nodes hold.
    pub(crate) max_rate_amount: f64,
    /// Length of the longest displacement.
    pub(crate) max_displacement: f64,
    /// Vertices that stay because no displacement satisfies all their facets.
    pub(crate) stuck: Vec<u32>,
}

/// Bounds on the changes of the facets of a node under an offset, as derived in `docs/theory/offsets.md`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NodeMotion {
    /// Rates at which the lower sides of the box move, per unit of the amount.
    pub(crate) low: [f32; 3],
    /// Rates at which the upper sides of the box move.
    pub(crate) high: [f32; 3],
    /// Rates at which the sides of the slab move.
    pub(crate) slab: [f32; 2],
    /// Rate of the sine of the angle by which a normal turns.
    pub normal_turn_rate: f32,
    /// Part of this sine that is due to rounding, for any amount.
    pub rounding_turn: f32,
}

/// Vertices and facets for which an offset is not exact.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ShrinkReport {
    /// Largest displacement of a vertex, in the units of the body.
    pub farthest: f64,
    /// Vertices that stay because no displacement is inwards for all facets around them; indices of the input.
    pub fixed_vertices: Vec<InputVertex>,
    /// Facets that turned inside out or passed through others, because the body is thinner there than twice the amount,
    /// or because an outward offset closes a gap. Indices of the input, in increasing order.
    pub inverted: Vec<InputFacet>,
}

impl Solid {
    /// Returns the solid with each facet plane moved inwards by `amount`, in the units of the body, and a report of
    /// vertices and facets for which this is not exact.
    ///
    /// Vertices keep their indices. Vertices of [sheets](ShellKind::Sheet) stay.
    ///
    /// # Errors
    /// Returns [`SolidError::Amount`] for an amount that is negative, not finite, or moves coordinates out of the
    /// exact range, and [`SolidError::Rounded`] for a rounded solid.
    ///
    /// ```
    /// use colltrans::{Aabb, ConvexPolyhedron, Solid};
    /// use colltrans::glam::DVec3;
    ///
    /// let corners: Vec<DVec3> = (0..8)
    ///     .map(|i| DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64))
    ///     .collect();
    /// let cube = Solid::from_convex(&ConvexPolyhedron::from_points(&corners)?)?;
    /// let (smaller, report) = cube.shrunk(0.25)?;
    /// assert_eq!(smaller.bounds(), Aabb { low: DVec3::splat(0.25), high: DVec3::splat(0.75) });
    /// assert!((smaller.volume() - 0.125).abs() < 1e-15);
    /// assert!((report.farthest - 0.25 * 3.0_f64.sqrt()).abs() < 1e-15);
    /// assert!(report.fixed_vertices.is_empty() && report.inverted.is_empty());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn shrunk(&self, amount: f64) -> Result<(Self, ShrinkReport), SolidError> {
        self.offset_by(amount, amount)
    }

    /// Returns the solid with each facet plane moved outwards by `amount`, for example to reserve a margin, with the
    /// report of [`Self::shrunk`].
    ///
    /// # Errors
    /// Returns an error in the same cases as [`Self::shrunk`].
    pub fn grown(&self, amount: f64) -> Result<(Self, ShrinkReport), SolidError> {
        self.offset_by(amount, -amount)
    }

    /// Returns the offset solid for an amount and its signed value, which is negative for a growing solid.
    fn offset_by(&self, amount: f64, signed: f64) -> Result<(Self, ShrinkReport), SolidError> {
        if !(amount.is_finite() && amount >= 0.0) {
            return Err(SolidError::Amount { amount });
        }
        super::round::check_is_not_rounded(self.radius)?;
        let report = self.shrink_report(signed);
        let vertices: Vec<DVec3> = self
            .vertices
            .iter()
            .zip(&self.offset_field().displacements)
            .map(|(v, x)| offset_vertex(*v, *x, signed))
            .collect();
        if !vertices.iter().all(|v| is_in_exact_range(*v)) {
            return Err(SolidError::Amount { amount });
        }
        let surface = Surface {
            vertices,
            vertex_index: self.vertex_index.clone(),
            triangles: self.triangles.clone(),
            facet_index: self.facet_index.clone(),
            neighbours: self.neighbours.clone(),
            input_counts: self.input_counts,
            faces: Some(self.faces().clone()),
            kinds: self.kinds.clone(),
        };
        let mut solid_report = self.report.clone();
        for (shell, volume) in
            solid_report.shells.iter_mut().zip(self.volumes_of(&surface.vertices))
        {
            shell.volume = volume;
        }
        Ok((Self::from_surface(surface, solid_report), report))
    }

    /// Returns the volumes of the shells for other vertex positions. The shells are in the order of the report, that
    /// is, of their first facets.
    fn volumes_of(&self, vertices: &[DVec3]) -> Vec<f64> {
        let shell_of = edges::shell_numbers(&self.neighbours);
        let volumes = shells::shell_volumes(&shell_of, &self.triangles, |v| vertices[v as usize]);
        let mut first = vec![InputFacet(NO_NEIGHBOUR); volumes.len()];
        for (&shell, &facet) in shell_of.iter().zip(&self.facet_index) {
            first[shell as usize] = facet.min(first[shell as usize]);
        }
        let mut order: Vec<usize> = (0..volumes.len()).collect();
        order.sort_by_key(|&shell| first[shell]);
        order.into_iter().map(|shell| volumes[shell]).collect()
    }

    /// Returns the vertices and facets for which an inward offset by `amount` (outward if negative) is not exact.
    pub fn shrink_report(&self, amount: f64) -> ShrinkReport {
        let shrinking = self.offset_field();
        // A ball or cube that is thinner than twice the amount is mirrored in a point. Its facets keep their
        // orientations, and only the sign of the volume changes.
        let shell_of = edges::shell_numbers(&self.neighbours);
        let fields = self.vertices.iter().zip(&shrinking.displacements);
        let moved: Vec<DVec3> = fields.map(|(v, x)| offset_vertex(*v, *x, amount)).collect();
        let before =
            shells::shell_volumes(&shell_of, &self.triangles, |v| self.vertices[v as usize]);
        let after = shells::shell_volumes(&shell_of, &self.triangles, |v| moved[v as usize]);
        let inverted = |t: &usize| {
            let corners = self.triangles[*t].map(|v| v as usize);
            let before = tree::area_vector(corners.map(|v| self.vertices[v])).0;
            tree::area_vector(corners.map(|v| moved[v])).0.dot(before) <= 0.0
        };
        let mirrored = |t: &usize| {
            let shell = shell_of[*t] as usize;
            self.is_shell_closed(shell_of[*t]) && (before[shell] < 0.0) != (after[shell] < 0.0)
        };
        let mut facets: Vec<InputFacet> = (0..self.triangles.len())
            .filter(|t| !self.is_without_area(*t) && (mirrored(t) || inverted(t)))
            .chain(self_intersection::crossing_facets(self, &moved, &shell_of, &before))
            .map(|t| self.facet_index[t])
            .collect();
        facets.sort_unstable();
        facets.dedup();
        ShrinkReport {
            farthest: shrinking.max_displacement * amount.abs(),
            fixed_vertices: shrinking
                .stuck
                .iter()
                .map(|&v| self.vertex_index[v as usize])
                .collect(),
            inverted: facets,
        }
    }

    /// Returns the displacements, computed on first use.
    #[doc(hidden)]
    #[inline]
    pub fn offset_field(&self) -> &OffsetField {
        self.shrinking.get_or_init(|| OffsetField::new(self))
    }
}

/// Returns a vertex of the offset body. Coordinates too small for the exact range are replaced by 0.
#[inline]
pub fn offset_vertex(vertex: DVec3, field: DVec3, amount: f64) -> DVec3 {
    with_tiny_components_zeroed(vertex + field * amount)
}

impl OffsetField {
    fn new(solid: &Solid) -> Self {
        let vertex_facets = VertexFacets::new(solid);
        let mut field = vec![DVec3::ZERO; solid.vertices.len()];
        fill_in_chunks(&mut field, |first, part| {
            let mut normals = Vec::new();
            for (k, x) in part.iter_mut().enumerate() {
                vertex_facets.normals_around(first + k, &mut normals);
                *x = shortest_displacement(&normals).unwrap_or(DVec3::ZERO);
            }
        });
        let stuck = (0..field.len() as u32)
            .filter(|&v| {
                field[v as usize] == DVec3::ZERO && vertex_facets.has_moving_facets(v as usize)
            })
            .collect();
        let most = MAX_RATE_AMOUNT * solid.reach;
        let nodes = node_motions(solid, &field, most);
        let farthest = field.iter().map(|x| x.length()).fold(0.0, f64::max);
        Self {
            displacements: field,
            node_motions: nodes,
            max_rate_amount: most,
            max_displacement: farthest,
            stuck,
        }
    }

    /// Returns a box around the offset facets of a node, from the box of the node. The amount must not be negative.
    pub(crate) fn offset_box(&self, bounds: Aabb, amount: f64, node: usize) -> Aabb {
        if amount <= self.max_rate_amount {
            let motion = &self.node_motions[node];
            let rate = |r: [f32; 3]| DVec3::from_array(r.map(f64::from)) * amount;
            Aabb { low: bounds.low + rate(motion.low), high: bounds.high + rate(motion.high) }
        } else {
            bounds.expanded(self.max_displacement * amount.abs())
        }
    }

    pub(crate) fn heap_bytes(&self) -> usize {
        self.displacements.capacity() * size_of::<DVec3>()
            + self.node_motions.capacity() * size_of::<NodeMotion>()
            + self.stuck.capacity() * size_of::<u32>()
    }
}

/// Number of elements that a thread takes at once. Threads are started for at least two such chunks.
const CHUNK: usize = 4_096;

/// Fills a slice in chunks, on all processors if there are several chunks. `fill` gets the position of the first element
/// of a chunk, and the chunk.
fn fill_in_chunks<T: Send>(all: &mut [T], fill: impl Fn(usize, &mut [T]) + Sync) {
    let threads = thread::available_parallelism().map_or(1, usize::from).min(all.len() / CHUNK);
    if threads <= 1 {
        // This path also serves platforms without threads, such as browsers.
        fill(0, all);
        return;
    }
    let queue = Mutex::new(all.chunks_mut(CHUNK).enumerate());
    let next = || queue.lock().unwrap_or_else(PoisonError::into_inner).next();
    thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                while let Some((n, part)) = next() {
                    fill(n * CHUNK, part);
                }
            });
        }
    });
}

/// The facets with an offset, by vertex.
struct VertexFacets<'a> {
    solid: &'a Solid,
    starts: Vec<u32>,
    facets: Vec<u32>,
    /// Of each facet.
    normals: Vec<FacetNormal>,
}

/// Normal of a facet.
#[derive(Clone, Copy)]
struct FacetNormal {
    unit: DVec3,
    /// Length of the area vector, and of the longest side.
    area: f64,
    longest: f64,
}

impl FacetNormal {
    fn new([a, b, c]: [DVec3; 3]) -> Self {
        let vector = tree::area_vector([a, b, c]).0;
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        let area = vector.length();
        Self { unit: vector / area, area, longest }
    }
}

impl<'a> VertexFacets<'a> {
    fn new(solid: &'a Solid) -> Self {
        let mut starts = vec![0_u32; solid.vertices.len() + 1];
        let moved = |t: &usize| solid.kinds[*t] != ShellKind::Sheet;
        for v in (0..solid.triangles.len()).filter(moved).flat_map(|t| solid.triangles[t]) {
            starts[v as usize + 1] += 1;
        }
        for v in 0..solid.vertices.len() {
            starts[v + 1] += starts[v];
        }
        let mut next = starts.clone();
        let mut facets = vec![NO_NEIGHBOUR; next[solid.vertices.len()] as usize];
        for t in (0..solid.triangles.len()).filter(moved) {
            for v in solid.triangles[t] {
                facets[next[v as usize] as usize] = t as u32;
                next[v as usize] += 1;
            }
        }
        let none = FacetNormal { unit: DVec3::ZERO, area: 0.0, longest: 0.0 };
        let mut normals = vec![none; solid.triangles.len()];
        fill_in_chunks(&mut normals, |first, part| {
            for (k, normal) in part.iter_mut().enumerate() {
                let corners = solid.triangles[first + k];
                *normal = FacetNormal::new(corners.map(|v| solid.vertices[v as usize]));
            }
        });
        Self { solid, starts, facets, normals }
    }

    /// Checks whether a vertex has facets with an offset.
    fn has_moving_facets(&self, v: usize) -> bool {
        self.starts[v] < self.starts[v + 1]
    }

    /// Collects the unit normals of the facets around a vertex. Facets with noisy normals are omitted if there are
    /// others.
    fn normals_around(&self, v: usize, normals: &mut Vec<DVec3>) {
        let facets = &self.facets[self.starts[v] as usize..self.starts[v + 1] as usize];
        for least in [MIN_HEIGHT * self.solid.reach, 0.0] {
            normals.clear();
            for &t in facets {
                let FacetNormal { unit, area, longest } = self.normals[t as usize];
                if area > least * longest && normals.last() != Some(&unit) {
                    normals.push(unit);
                }
            }
            if !normals.is_empty() {
                return;
            }
        }
    }
}

/// Returns the shortest `x` with `n.x <= -1` for all normals; `None` if there is none with a length of at most
/// [`MAX_DISPLACEMENT`]. After [`MAX_ROUNDS`] rounds `x` satisfies the conditions, but it may not be the shortest.
fn shortest_displacement(normals: &[DVec3]) -> Option<DVec3> {
    let mut simplex = Simplex { points: [*normals.first()?; 4], count: 1 };
    for _ in 0..MAX_ROUNDS {
        let w = simplex.reduce_to_nearest();
        let size = w.length_squared();
        if size * MAX_DISPLACEMENT * MAX_DISPLACEMENT < 1.0 {
            return None;
        }
        let lowest = normals.iter().min_by(|a, b| a.dot(w).total_cmp(&b.dot(w)))?;
        let depth = lowest.dot(w);
        if depth >= size * (1.0 - 1e-12) || simplex.points().contains(lowest) {
            // Scaled by the lowest normal, so that rounding leaves no product above -1.
            return (depth * MAX_DISPLACEMENT > w.length()).then(|| w / -depth);
        }
        if simplex.count == simplex.points.len() {
            // Four points span the nearest point only if this is the origin, to within rounding.
            return None;
        }
        simplex.points[simplex.count] = *lowest;
        simplex.count += 1;
    }
    let w = simplex.reduce_to_nearest();
    let depth = normals.iter().map(|n| n.dot(w)).fold(f64::INFINITY, f64::min);
    (depth > 0.0 && depth * MAX_DISPLACEMENT > w.length()).then(|| w / -depth)
}

/// Up to four points.
struct Simplex {
    points: [DVec3; 4],
    count: usize,
}

impl Simplex {
    fn points(&self) -> &[DVec3] {
        &self.points[..self.count]
    }

    /// Returns the points of a set of positions, in order.
    fn part(&self, mask: u32) -> Self {
        let mut part = Self { points: self.points, count: 0 };
        for (k, point) in self.points().iter().enumerate() {
            if mask >> k & 1 == 1 {
                part.points[part.count] = *point;
                part.count += 1;
            }
        }
        part
    }

    /// Returns the point of the convex hull that is nearest to the origin, and keeps the points that span it.
    fn reduce_to_nearest(&mut self) -> DVec3 {
        let mut best: Option<(f64, DVec3, u32)> = None;
        for mask in 1..1_u32 << self.count {
            let Some(w) = nearest_in_affine_hull(self.part(mask).points()) else { continue };
            if best.is_none_or(|b| w.length_squared() < b.0) {
                best = Some((w.length_squared(), w, mask));
            }
        }
        let Some((_, w, mask)) = best else { return self.points[0] };
        *self = self.part(mask);
        w
    }
}

/// Returns the point of the affine hull that is nearest to the origin; `None` if it is outside the convex hull.
fn nearest_in_affine_hull(points: &[DVec3]) -> Option<DVec3> {
    match *points {
        [a] => Some(a),
        [a, b] => {
            let u = b - a;
            let s = -a.dot(u) / u.length_squared();
            (0.0..=1.0).contains(&s).then(|| a + u * s)
        }
        [a, b, c] => {
            let normal = (b - a).cross(c - a);
            let foot = normal * (a.dot(normal) / normal.length_squared());
            let inside = |p: DVec3, q: DVec3| (q - p).cross(foot - p).dot(normal) >= 0.0;
            (inside(a, b) && inside(b, c) && inside(c, a)).then_some(foot)
        }
        [a, b, c, d] => {
            let side = |p: DVec3, q: DVec3, r: DVec3, s: DVec3| {
                let normal = (q - p).cross(r - p);
                normal.dot(s - p) * normal.dot(-p) >= 0.0
            };
            let inside =
                side(a, b, c, d) && side(b, c, d, a) && side(c, d, a, b) && side(d, a, b, c);
            inside.then_some(DVec3::ZERO)
        }
        _ => None,
    }
}

/// Bounds of the moved facets of a node.
#[derive(Clone, Copy)]
struct MovedFacets {
    bounds: Aabb,
    /// Largest rate of a normal, and sine that rounding adds.
    turn: [f64; 2],
}

impl MovedFacets {
    fn union(&self, other: &Self) -> Self {
        let turn = [0, 1].map(|k| self.turn[k].max(other.turn[k]));
        Self { bounds: self.bounds.union(&other.bounds), turn }
    }
}

/// Computes the bounds on the changes of all nodes, for amounts up to `most`.
fn node_motions(solid: &Solid, field: &[DVec3], most: f64) -> Vec<NodeMotion> {
    let moved: Vec<DVec3> =
        solid.vertices.iter().zip(field).map(|(v, x)| offset_vertex(*v, *x, most)).collect();
    let none = MovedFacets { bounds: Aabb::EMPTY, turn: [0.0; 2] };
    let mut facets = vec![none; solid.nodes.len()];
    // Children are after their parents.
    for (at, node) in solid.nodes.iter().enumerate().rev() {
        facets[at] = if node.is_leaf() {
            node.facets().fold(none, |all, t| {
                let corners = solid.triangles[t].map(|v| moved[v as usize]);
                let turn = normal_turn_rate(solid, field, t);
                all.union(&MovedFacets { bounds: Aabb::from_points(corners), turn })
            })
        } else {
            let [first, second] = node.child_positions(at as u32);
            facets[first as usize].union(&facets[second as usize])
        };
    }
    let still = NodeMotion {
        low: [0.0; 3],
        high: [0.0; 3],
        slab: [0.0; 2],
        normal_turn_rate: 0.0,
        rounding_turn: 0.0,
    };
    let mut motions = vec![still; solid.nodes.len()];
    fill_in_chunks(&mut motions, |first, part| {
        for (k, motion) in part.iter_mut().enumerate() {
            *motion = node_motion(solid, &moved, most, &solid.nodes[first + k], &facets[first + k]);
        }
    });
    motions
}

/// Computes the bounds on the changes of a node from those of its facets, with all vertices `moved` by `most`.
fn node_motion(
    solid: &Solid,
    moved: &[DVec3],
    most: f64,
    node: &Node,
    MovedFacets { bounds, turn }: &MovedFacets,
) -> NodeMotion {
    let mut slab = [f64::INFINITY, f64::NEG_INFINITY];
    // A node with all orientations has no slab, and no cone of normals that could turn.
    let has_slab = node.slab[1] < f64::INFINITY;
    if has_slab {
        for v in solid.triangles[node.facets()].as_flattened() {
            let level = node.axis.dot(moved[*v as usize]);
            slab = [slab[0].min(level), slab[1].max(level)];
        }
    }
    let [turn, rough] = if has_slab { *turn } else { [0.0; 2] };
    // Rounds outwards, by more than the rounding errors of the ends of the chords.
    let slack = 16.0 * f64::EPSILON * solid.reach / most;
    let down = |end: f64, start: f64| ((end - start) / most - slack) as f32;
    let up = |end: f64, start: f64| ((end - start) / most + slack) as f32;
    let finite = |x: f32| if x.is_finite() { x } else { 0.0 };
    NodeMotion {
        low: [0, 1, 2].map(|k| down(bounds.low[k], node.bounds.low[k]).next_down()),
        high: [0, 1, 2].map(|k| up(bounds.high[k], node.bounds.high[k]).next_up()),
        slab: [
            finite(down(slab[0], node.slab[0]).next_down()),
            finite(up(slab[1], node.slab[1]).next_up()),
        ],
        normal_turn_rate: (turn * 1.000_001) as f32,
        rounding_turn: (rough * 1.000_001) as f32,
    }
}

/// Returns the rate at which the normal of a facet turns, and the sine that rounding adds.
fn normal_turn_rate(solid: &Solid, field: &[DVec3], t: usize) -> [f64; 2] {
    let corners = solid.triangles[t].map(|v| v as usize);
    let [a, b, c] = corners.map(|v| solid.vertices[v]);
    let [x, y, z] = corners.map(|v| field[v]);
    let apart = (y - x).length().max((z - x).length());
    let ratio = ((b - a).length() + (c - a).length()) / tree::area_vector([a, b, c]).0.length();
    [2.0 * apart * ratio, 8.0 * f64::EPSILON * solid.reach * ratio]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn displacements_exist_for_faces_edges_and_corners_only() {
        let x = shortest_displacement(&[DVec3::X]).unwrap();
        assert_eq!(x, DVec3::NEG_X);
        let x = shortest_displacement(&[DVec3::X, DVec3::Y, DVec3::X]).unwrap();
        assert!((x - DVec3::new(-1.0, -1.0, 0.0)).length() < 1e-15);
        let x = shortest_displacement(&[DVec3::X, DVec3::Y, DVec3::Z]).unwrap();
        assert!((x + DVec3::ONE).length() < 1e-15);
        assert!(shortest_displacement(&[DVec3::X, DVec3::NEG_X]).is_none());
        let saddle =
            [DVec3::X, DVec3::Y, DVec3::new(-1.0, -1.0, 1.0), DVec3::new(-1.0, -1.0, -1.0)];
        assert!(shortest_displacement(&saddle.map(DVec3::normalize)).is_none());
    }

    #[test]
    fn cones_of_normals_have_axial_displacements() {
        for n in [3, 7, 40, 1_000] {
            let normals: Vec<DVec3> = (0..n)
                .map(|k| f64::from(k) * std::f64::consts::TAU / f64::from(n))
                .map(|a| DVec3::new(a.cos(), a.sin(), 0.75).normalize())
                .collect();
            let x = shortest_displacement(&normals).unwrap();
            assert!((x - DVec3::new(0.0, 0.0, -1.25 / 0.75)).length() < 1e-6, "{n}: {x}");
            assert!(normals.iter().all(|m| m.dot(x) <= -1.0 + 1e-15));
        }
    }
}
