//! Merges duplicate vertices, which programs write for the same point with different rounding.
//!
//! Such duplicates leave the surface open along the edges between them. Therefore only vertices on open edges
//! are merged, and closed surfaces remain unchanged.
//!
//! - `tol` is the tolerance, a Euclidean distance. A *representative* is a vertex that replaces all vertices
//!   merged into it. It keeps its coordinates.
//! - Invariant: in their order, each vertex is merged into the nearest representative within `tol`, or becomes
//!   a representative. Hence no vertex moves by more than `tol`, representatives are more than `tol` apart, and
//!   a chain of near vertices is cut into pieces. Vertices with several representatives within `tol` are
//!   counted (`Merged::ambiguous`).
//! - Default tolerance, with the largest coordinate `m` in magnitude: duplicates in single precision differ by
//!   at most one unit in the last place, `2^-23 m`, per coordinate, hence by `sqrt(3)` times that, at most
//!   `2^-22 m`. Results in double precision have the errors of a few dozen roundings of `2^-53 m`, for which
//!   `2^-48 m` suffices. For text with fewer digits ([`digits`](crate::digits)) the tolerance is two units in
//!   the last printed place.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use glam::DVec3;

use crate::digits::{NumberFormat, largest_magnitude};
use crate::edges::sides;
use crate::mesh::Mesh;

/// The precision of the coordinates in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Precision {
    /// Whether the coordinates are in single precision, as in binary STL and PLY with `float` coordinates.
    pub(crate) single: bool,
    /// Whether the coordinates are text.
    pub(crate) text: bool,
}

impl Precision {
    /// Single precision, binary.
    pub(crate) const SINGLE: Self = Self { single: true, text: false };
    /// Double precision: binary, or transformed by a reader.
    #[cfg(any(test, feature = "dae"))]
    pub(crate) const DOUBLE: Self = Self { single: false, text: false };
    /// Text that is read in double precision.
    pub(crate) const TEXT: Self = Self { single: false, text: true };

    /// Returns the number format of the coordinates of a mesh.
    fn format_of(self, mesh: &Mesh) -> NumberFormat {
        match self {
            Self { text: true, single } => NumberFormat::of_text(mesh, single),
            Self { single: true, .. } => NumberFormat::Single,
            Self { single: false, .. } => NumberFormat::of_doubles(mesh),
        }
    }
}

/// The treatment of vertices that were merged into others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PlacePolicy {
    /// They remain in the list, unused, so that indices are those of the file.
    Kept,
    /// They are removed, because the file does not number its vertices.
    Closed,
}

impl Mesh {
    /// Merges vertices with equal coordinates (bit for bit, except that `-0` equals `0`).
    ///
    /// Vertices keep the order of their first occurrence. Then repeated consecutive corners, and steps to a vertex
    /// and back, are removed from faces. Faces with fewer than three corners left are removed. Such a face has no
    /// area, and the edges it connected become adjacent.
    #[must_use]
    pub fn weld(&self) -> Self {
        let (kept, faces) = self.first_of_equal();
        let vertices = kept.iter().map(|&v| self.vertices[v as usize]).collect();
        let printed = kept.iter().filter_map(|&v| self.printed.get(v as usize).copied()).collect();
        let mut mesh = Self { vertices, faces, printed, groups: self.groups.clone(), ..*self };
        mesh.remove_flat_faces();
        mesh
    }

    /// Returns the different vertices, and all faces over them. No faces are removed.
    pub(crate) fn welded_copy(&self) -> (Vec<DVec3>, Vec<Vec<u32>>) {
        let (kept, faces) = self.first_of_equal();
        (kept.into_iter().map(|v| self.vertices[v as usize]).collect(), faces)
    }

    /// Returns the index of the first vertex of each class of equal ones, and all faces over these classes.
    fn first_of_equal(&self) -> (Vec<u32>, Vec<Vec<u32>>) {
        let mut index_of = HashMap::with_capacity(self.vertices.len() / 4);
        let mut kept = Vec::new();
        let welded: Vec<u32> = self
            .vertices
            .iter()
            .enumerate()
            .map(|(v, &vertex)| match index_of.entry(coordinate_key(vertex)) {
                Entry::Occupied(known) => *known.get(),
                Entry::Vacant(new) => {
                    let index = kept.len() as u32;
                    kept.push(v as u32);
                    *new.insert(index)
                }
            })
            .collect();
        let renamed = |face: &Vec<u32>| face.iter().map(|&v| welded[v as usize]).collect();
        let faces = self.faces.iter().map(renamed).collect();
        (kept, faces)
    }

    /// Merges vertices that denote the same point in a number format: vertices with equal coordinates, then those on
    /// open edges that rounding explains. Merged vertices remain in the list, unused, so that indices are those of the
    /// input.
    ///
    /// Readers of files do this; it is meant for meshes from other sources, for example of a graphics library, which
    /// repeats a vertex for each of its normals.
    #[must_use]
    pub fn with_merged_vertices(self, format: NumberFormat) -> Self {
        let mut mesh = self.with_format(format);
        let precision = Precision { single: format == NumberFormat::Single, text: false };
        mesh.merge_open_edges(None, precision, PlacePolicy::Kept);
        mesh
    }

    /// Merges duplicate vertices along open edges. `None` selects the default tolerance.
    pub(crate) fn merge_open_edges(
        &mut self,
        asked: Option<f64>,
        precision: Precision,
        places: PlacePolicy,
    ) {
        let format = precision.format_of(self);
        let precision = format.precision(largest_magnitude(self.vertices_in_use()));
        self.printed = Vec::new();
        // A reader that has transformed the vertices has set a precision of its own.
        if self.precision <= precision {
            (self.format, self.precision) = (format, precision);
        }
        self.merged.tolerance = asked.unwrap_or(self.precision);
        let mut on_border: Vec<u32> = self.open_edges().into_iter().flatten().collect();
        if !on_border.is_empty() {
            on_border.sort_unstable();
            on_border.dedup();
            let mut names = self.representatives(&on_border);
            if places == PlacePolicy::Closed {
                self.remove_replaced(&mut names);
            }
            for corner in self.faces.iter_mut().flatten() {
                *corner = names[*corner as usize];
            }
        }
        self.remove_flat_faces();
    }

    /// Removes the vertices that were replaced, and updates `names` to the new indices.
    fn remove_replaced(&mut self, names: &mut [u32]) {
        let mut kept = 0;
        for v in 0..names.len() {
            // A representative precedes the vertices that it replaces.
            names[v] = if names[v] as usize == v {
                self.vertices[kept] = self.vertices[v];
                kept += 1;
                kept as u32 - 1
            } else {
                names[names[v] as usize]
            };
        }
        self.vertices.truncate(kept);
    }

    /// Returns each edge that is not used equally often in both directions, once, in the direction that is used
    /// more often.
    ///
    /// A surface without open edges encloses a volume, if its faces are oriented outwards.
    pub fn open_edges(&self) -> Vec<[u32; 2]> {
        let mut open = Vec::new();
        for same in sides(&self.faces).chunk_by(|(a, _), (b, _)| a == b) {
            let backward = same.iter().filter(|(_, side)| side & 1 == 1).count();
            let [low, high] = [(same[0].0 >> 32) as u32, same[0].0 as u32];
            match (same.len() - backward).cmp(&backward) {
                std::cmp::Ordering::Equal => {}
                std::cmp::Ordering::Greater => open.push([low, high]),
                std::cmp::Ordering::Less => open.push([high, low]),
            }
        }
        open
    }

    /// Returns for each vertex its representative, which for most is the vertex itself.
    fn representatives(&mut self, candidates: &[u32]) -> Vec<u32> {
        let mut places: Vec<u32> = (0..self.vertices.len() as u32).collect();
        let mut grid = Grid::new(self.merged.tolerance, &self.vertices);
        for &v in candidates {
            let position = self.vertices[v as usize];
            let Some(near) = grid.nearest(position, &self.vertices) else {
                grid.insert(v, position);
                continue;
            };
            places[v as usize] = near.vertex;
            if near.distance > 0.0 {
                self.merged.vertices += 1;
                self.merged.largest_distance = self.merged.largest_distance.max(near.distance);
            }
            self.merged.ambiguous += usize::from(near.choices > 1);
        }
        places
    }

    /// Removes repeated consecutive corners and steps to a vertex and back from faces, and faces with fewer than
    /// three corners left.
    ///
    /// Each removed step consists of opposite uses of one edge, so edges that were closed remain closed.
    pub(crate) fn remove_flat_faces(&mut self) {
        let before = self.faces.len();
        let (mut number, mut dropped) = (0, Vec::new());
        self.faces.retain_mut(|face| {
            let kept = reduced_cycle(face);
            if kept.len() < face.len() {
                *face = kept;
            }
            if face.len() < 3 {
                dropped.push(number);
            }
            number += 1;
            face.len() >= 3
        });
        if !self.groups.of_face.is_empty() {
            let (mut number, mut dropped) = (0, dropped.into_iter().peekable());
            self.groups.of_face.retain(|_| {
                number += 1;
                dropped.next_if_eq(&(number - 1)).is_none()
            });
        }
        self.merged.dropped_faces += before - self.faces.len();
    }
}

/// Returns a key that is equal exactly for equal coordinates.
fn coordinate_key(vertex: DVec3) -> [u64; 3] {
    // Adding 0 converts -0 to 0 and does not change other numbers.
    vertex.to_array().map(|c| (c + 0.0).to_bits())
}

/// Returns a cycle of corners without consecutive equal corners (`a a`) and without spikes (`a b a`).
fn reduced_cycle(face: &[u32]) -> Vec<u32> {
    let mut kept: Vec<u32> = Vec::with_capacity(face.len());
    for &corner in face {
        if kept.last() == Some(&corner) {
            continue;
        }
        if kept.len() >= 2 && kept[kept.len() - 2] == corner {
            kept.pop();
        } else {
            kept.push(corner);
        }
    }
    // Applies the same rules across the seam of the cycle.
    let mut cycle = kept.as_slice();
    loop {
        let count = cycle.len();
        cycle = match cycle {
            [first, .., last] if first == last => &cycle[1..],
            [first, _, .., before, _] if first == before => &cycle[..count - 2],
            [_, second, .., last] if count > 2 && second == last => &cycle[2..],
            _ => return cycle.to_vec(),
        };
    }
}

/// A grid of cells with representatives.
///
/// Cells are several tolerances wide, so that the vicinity of a position is mostly in one cell. Representatives
/// are more than a tolerance apart, so that a cell has a bounded number of them.
struct Grid {
    cell: f64,
    tolerance: f64,
    /// For each cell the representative that was inserted last.
    last: HashMap<[u64; 3], u32>,
    /// For each vertex the representative that was inserted before it into its cell.
    before: Vec<u32>,
}

/// Returns a key of the same type as those of coordinates ([`coordinate_key`]), because one instance of the map type
/// halves the code.
fn cell_key(cell: [i64; 3]) -> [u64; 3] {
    cell.map(|c| c as u64)
}

/// The nearest representative, and the number of representatives within the tolerance.
#[derive(Clone, Copy)]
struct NearestFound {
    vertex: u32,
    distance: f64,
    choices: usize,
}

/// The marker for no vertex.
const NONE: u32 = u32::MAX;

/// Width of a cell in tolerances.
const CELL_TOLERANCES: f64 = 4.0;

/// Returns the length of a vector, also if its square underflows.
fn scaled_length(v: DVec3) -> f64 {
    let largest = v.abs().max_element();
    if largest == 0.0 { 0.0 } else { largest * (v / largest).length() }
}

impl Grid {
    /// Builds an empty grid.
    fn new(tolerance: f64, vertices: &[DVec3]) -> Self {
        // Cell indices must fit in 64 bits.
        let smallest =
            largest_magnitude(vertices.iter().copied()) * f64::from_bits((1023 - 60) << 52);
        let cell = (CELL_TOLERANCES * tolerance).max(smallest).max(f64::MIN_POSITIVE);
        Self { cell, tolerance, last: HashMap::new(), before: vec![NONE; vertices.len()] }
    }

    /// Returns the indices of the cell of a position.
    fn cell_of(&self, position: DVec3) -> [i64; 3] {
        position.to_array().map(|c| (c / self.cell).floor() as i64)
    }

    /// Inserts a representative.
    fn insert(&mut self, vertex: u32, position: DVec3) {
        let last = self.last.entry(cell_key(self.cell_of(position))).or_insert(NONE);
        self.before[vertex as usize] = *last;
        *last = vertex;
    }

    /// Returns the nearest representative within the tolerance of a position; `None` if there is none.
    fn nearest(&self, position: DVec3, vertices: &[DVec3]) -> Option<NearestFound> {
        let low = self.cell_of(position - self.tolerance);
        let high = self.cell_of(position + self.tolerance);
        // At most two cells in each dimension, even if the sum overflows.
        let high: [i64; 3] = std::array::from_fn(|i| high[i].min(low[i].saturating_add(1)));
        let mut found: Option<NearestFound> = None;
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    let Some(&last) = self.last.get(&cell_key([x, y, z])) else { continue };
                    found = self.nearest_with_cell(found, last, position, vertices);
                }
            }
        }
        found
    }

    /// Returns the nearest of `found` and the representatives in a cell; if distances are equal, the one with
    /// the smallest index.
    fn nearest_with_cell(
        &self,
        mut found: Option<NearestFound>,
        last: u32,
        position: DVec3,
        vertices: &[DVec3],
    ) -> Option<NearestFound> {
        let mut vertex = last;
        while vertex != NONE {
            let distance = scaled_length(vertices[vertex as usize] - position);
            if distance <= self.tolerance {
                let choices = found.map_or(1, |near| near.choices + 1);
                let best = found.filter(|n| (n.distance, n.vertex) < (distance, vertex));
                found = Some(NearestFound {
                    choices,
                    ..best.unwrap_or(NearestFound { vertex, distance, choices })
                });
            }
            vertex = self.before[vertex as usize];
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use colltrans_testkit::random::Random;

    use super::*;

    #[test]
    fn welding_merges_signed_zeros_and_removes_zero_area_faces() {
        let mesh = Mesh::new(
            vec![
                DVec3::new(0.0, 0.0, 0.0),
                DVec3::new(1.0, 0.0, 0.0),
                DVec3::new(0.0, 1.0, 0.0),
                DVec3::new(-0.0, 0.0, 0.0),
                DVec3::new(1.0, 0.0, 1e-300),
            ],
            vec![vec![0, 1, 2], vec![0, 3, 1], vec![3, 1, 4, 2], vec![2, 0, 3, 1]],
        );
        let welded = mesh.weld();
        assert_eq!(welded.vertices.len(), 4, "only the two zeros are equal");
        assert_eq!(welded.faces, [vec![0, 1, 2], vec![0, 1, 3, 2], vec![2, 0, 1]]);
        assert_eq!(welded.merged.dropped_faces, 1);
        assert_eq!(welded.weld(), welded);
    }

    #[test]
    fn faces_lose_repeated_corners_and_spikes() {
        let reduce = |face: &[u32]| reduced_cycle(face);
        assert_eq!(reduce(&[0, 1, 2, 3]), [0, 1, 2, 3]);
        assert_eq!(reduce(&[0, 0, 1, 2, 2]), [0, 1, 2]);
        assert_eq!(reduce(&[0, 1, 2, 0]), [1, 2, 0]);
        assert_eq!(reduce(&[0, 1, 2, 1, 3]), [0, 1, 3]);
        assert_eq!(reduce(&[1, 2, 3, 4, 1, 5]), [1, 2, 3, 4], "a spike to 5 over the seam");
        assert_eq!(reduce(&[5, 1, 2, 3, 4, 1]), [2, 3, 4, 1], "the same from 5");
        for flat in [&[0, 1, 0][..], &[0, 1, 2, 1], &[0, 0, 0], &[0, 1, 2, 2, 1], &[]] {
            assert!(reduce(flat).len() < 3, "{flat:?}");
        }
    }

    /// Points on a line with the spacing `gap`, each of which is a corner of an open triangle of its own.
    fn triangle_chain(count: u32, gap: f64) -> Mesh {
        let mut vertices: Vec<DVec3> = Vec::new();
        for i in 0..count {
            vertices.push(DVec3::X * (f64::from(i) * gap));
            vertices.push(DVec3::new(f64::from(i), 10.0, 0.0));
            vertices.push(DVec3::new(f64::from(i), 10.0, 1.0));
        }
        let faces = (0..count).map(|i| vec![3 * i, 3 * i + 1, 3 * i + 2]).collect();
        Mesh::new(vertices, faces)
    }

    #[test]
    fn chain_of_near_vertices_is_cut_into_pieces() {
        let mut mesh = triangle_chain(10, 0.0625);
        mesh.merge_open_edges(Some(0.1), Precision::DOUBLE, PlacePolicy::Kept);
        let ends: Vec<u32> = mesh.faces.iter().map(|face| face[0]).collect();
        assert_eq!(ends, [0, 0, 6, 6, 12, 12, 18, 18, 24, 24]);
        assert_eq!(mesh.merged.vertices, 5);
        assert_eq!(mesh.merged.largest_distance, 0.0625);
        assert_eq!(mesh.merged.ambiguous, 0);
        let mut closed = triangle_chain(10, 0.0625);
        closed.merge_open_edges(Some(0.1), Precision::DOUBLE, PlacePolicy::Closed);
        assert_eq!(closed.vertices.len(), 25);
        for (a, b) in closed.faces.iter().flatten().zip(mesh.faces.iter().flatten()) {
            assert_eq!(closed.vertices[*a as usize], mesh.vertices[*b as usize]);
        }
        let mut mesh = triangle_chain(3, 0.0625);
        mesh.vertices.swap(3, 6);
        mesh.merge_open_edges(Some(0.1), Precision::DOUBLE, PlacePolicy::Kept);
        assert_eq!(mesh.merged.ambiguous, 1, "the one in the middle came last");
    }

    #[test]
    fn closed_surface_is_unchanged() {
        let (a, b, c, d) = (DVec3::ZERO, DVec3::X * 1e-3, DVec3::Y, DVec3::Z);
        let faces = vec![vec![0, 2, 1], vec![0, 1, 3], vec![1, 2, 3], vec![0, 3, 2]];
        let sliver = Mesh::new(vec![a, b, c, d], faces);
        let mut closed = sliver.clone();
        closed.merge_open_edges(Some(0.01), Precision::DOUBLE, PlacePolicy::Kept);
        assert_eq!(closed.faces, sliver.faces);
        let mut open = sliver;
        open.faces.pop();
        assert_eq!(open.open_edges(), [[0, 2], [3, 0], [2, 3]]);
        open.merge_open_edges(Some(0.01), Precision::DOUBLE, PlacePolicy::Kept);
        assert_eq!(open.merged.vertices, 0, "1 is on no open edge");
    }

    /// Compares the grid with all pairs.
    #[test]
    fn grid_matches_search_over_all_pairs() {
        let mut random = Random::new(1);
        for scale in [1.0, 1e-9, 1e9] {
            let vertices: Vec<DVec3> = (0..600).map(|_| random.vector() * (0.5 * scale)).collect();
            let tolerance = 0.07 * scale;
            let mut grid = Grid::new(tolerance, &vertices);
            let mut representatives: Vec<u32> = Vec::new();
            for (v, &position) in vertices.iter().enumerate() {
                let distance = |&w: &u32| scaled_length(vertices[w as usize] - position);
                let within = representatives.iter().filter(|w| distance(w) <= tolerance);
                let nearest = within.clone().map(distance).fold(f64::INFINITY, f64::min);
                if let Some(near) = grid.nearest(position, &vertices) {
                    assert_eq!(near.distance, nearest);
                    assert_eq!(near.choices, within.count());
                } else {
                    assert_eq!(within.count(), 0);
                    grid.insert(v as u32, position);
                    representatives.push(v as u32);
                }
            }
            assert!((100..600).contains(&representatives.len()));
        }
    }

    #[test]
    fn zero_tolerance_merges_equal_vertices_only() {
        let mut mesh = triangle_chain(4, 1e-300);
        mesh.vertices[9] = mesh.vertices[0];
        mesh.merge_open_edges(Some(0.0), Precision::SINGLE, PlacePolicy::Kept);
        assert_eq!(mesh.faces[3][0], 0);
        assert_eq!((mesh.faces[1][0], mesh.merged.vertices), (3, 0));
        mesh.vertices[3] = DVec3::NAN;
        mesh.vertices[6] = DVec3::splat(f64::INFINITY);
        mesh.merge_open_edges(None, Precision::SINGLE, PlacePolicy::Kept);
        assert_eq!(mesh.faces[1][0], 3);
        assert!(mesh.merged.tolerance.is_finite());
    }
}
