//! Repairs surfaces that are not closed or not consistently oriented, where the repair is unambiguous.
//!
//! A *patch* is a set of facets connected over edges with two facets, a *piece* one connected over any edges.
//! An edge is *free* with one facet, and *crowded* with three or more. Steps, in this order:
//!
//! 1. Of facets with the same corners, one is kept.
//! 2. *Fins* are removed, repeatedly: patches with a free edge that adjoin a crowded edge.
//! 3. *Walls* are removed, repeatedly: patches without a free edge whose crowded edges all have an odd number of
//!    facets. Of walls that share an edge, those of pairs of opposite facets (a wall between two bodies) come
//!    first, then the smallest.
//! 4. Facets that are oriented against their neighbours are reversed ([`super::orient`]).
//!
//! The largest patch of a piece is never removed. Invariant of steps 1 to 3: a piece from which facets were removed
//! has only edges with an even number of facets. Its fins and walls had at most a hundredth of its area
//! ([`MAX_REMOVED_SHARE`]). All other pieces keep their facets.

use std::collections::{HashMap, HashSet};

use glam::DVec3;

use super::orient::orient_consistently;
use super::{Note, RemovedFaces};
use crate::Mesh;
use crate::edges::{FacetSide, area_normal, facet_sides, has_no_area, sides_by_edge};
use crate::sets::OrientedSets;

/// Maximum share of a piece's area to remove. A larger share counts as geometry.
const MAX_REMOVED_SHARE: f64 = 0.01;
/// Maximum number of rounds in which fins, or walls, are removed.
const MAX_ROUNDS: usize = 16;

/// Statistics of the repair of a surface.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct RepairCounts {
    /// Facets with the same corners as another one.
    pub(super) doubles: RemovedFaces,
    /// Facets of fins.
    pub(super) fins: RemovedFaces,
    /// Facets of walls.
    pub(super) walls: RemovedFaces,
    /// Number of facets that were reversed.
    pub(super) turned: usize,
}

impl RepairCounts {
    /// Returns the notes on the repair.
    pub(super) fn notes(self) -> impl Iterator<Item = Note> {
        let left = |left: RemovedFaces, note: fn(RemovedFaces) -> Note| {
            (left.facets > 0).then(|| note(left))
        };
        let turned = (self.turned > 0).then_some(Note::FacesTurned(self.turned));
        let all = [
            left(self.doubles, Note::Duplicates),
            left(self.fins, Note::Fins),
            left(self.walls, Note::Walls),
            turned,
        ];
        all.into_iter().flatten()
    }
}

/// Repairs a surface. On a one-sided surface no facets are reversed.
pub(super) fn repair(mesh: &mut Mesh) -> RepairCounts {
    let mut repaired = remove_facets(mesh);
    repaired.turned = orient_consistently(mesh).unwrap_or(0);
    repaired
}

/// Performs steps 1 to 3.
fn remove_facets(mesh: &mut Mesh) -> RepairCounts {
    let (vertices, faces) = mesh.welded_copy();
    let mut surface = Surface::new(&vertices, &faces);
    let back_to_back = surface.remove_duplicates();
    surface.remove_fins();
    surface.remove_walls(&back_to_back);
    surface.restore_pieces();
    let mut repaired = RepairCounts::default();
    for (&state, &area) in surface.states.iter().zip(&surface.areas) {
        match state {
            FacetState::Remains | FacetState::Flat => {}
            FacetState::Double => repaired.doubles.count(area),
            FacetState::Fin => repaired.fins.count(area),
            FacetState::Wall => repaired.walls.count(area),
        }
    }
    let mut states = surface.states.into_iter();
    mesh.faces.retain(|_| matches!(states.next(), Some(FacetState::Remains | FacetState::Flat)));
    repaired
}

/// The state of a facet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FacetState {
    Remains,
    /// It has fewer than three different corners, and does not count as a neighbour.
    Flat,
    Double,
    Fin,
    Wall,
}

/// A patch of the surface.
#[derive(Debug, Clone, Default)]
struct Patch {
    facets: Vec<usize>,
    area: f64,
    has_free: bool,
    /// The crowded edges around the patch, and whether all of them have an odd number of facets.
    crowded: Vec<u64>,
    is_odd: bool,
}

/// A surface from which facets are being removed.
struct Surface<'a> {
    faces: &'a [Vec<u32>],
    areas: Vec<f64>,
    states: Vec<FacetState>,
    /// For each facet the representative facet of its piece.
    pieces: Vec<usize>,
}

impl<'a> Surface<'a> {
    /// Builds a surface with all facets and finds its pieces.
    fn new(vertices: &[DVec3], faces: &'a [Vec<u32>]) -> Self {
        let areas = faces.iter().map(|face| area_normal(vertices, face).length() / 2.0).collect();
        let state = |face: &Vec<u32>| {
            if has_no_area(face) { FacetState::Flat } else { FacetState::Remains }
        };
        let states: Vec<FacetState> = faces.iter().map(state).collect();
        let mut pieces = OrientedSets::new(faces.len());
        for edge in sides_by_edge(&facet_sides(faces, |k| states[k] == FacetState::Remains)) {
            for pair in edge.windows(2) {
                pieces.join(pair[0].face, pair[1].face, false);
            }
        }
        let pieces = (0..faces.len()).map(|k| pieces.root(k).0).collect();
        Self { faces, areas, states, pieces }
    }

    /// Returns the sides of the facets that remain.
    fn remaining_uses(&self) -> Vec<FacetSide> {
        facet_sides(self.faces, |k| self.states[k] == FacetState::Remains)
    }

    /// Performs step 1. Returns for each facet whether its duplicates (itself included) have both orientations
    /// equally often.
    fn remove_duplicates(&mut self) -> Vec<bool> {
        let mut same: HashMap<Vec<u32>, (usize, i64)> = HashMap::with_capacity(self.faces.len());
        let mut keeps = vec![None; self.faces.len()];
        for (k, (face, state)) in self.faces.iter().zip(&mut self.states).enumerate() {
            if *state == FacetState::Flat {
                continue;
            }
            let (canonical_cycle, sign) = canonical_cycle(face);
            let (first, sum) = same.entry(canonical_cycle).or_insert((k, 0));
            if *first != k {
                *state = FacetState::Double;
            }
            *sum += sign;
            keeps[*first] = Some(*sum);
        }
        keeps.into_iter().map(|sum| sum == Some(0)).collect()
    }

    /// Performs step 2.
    fn remove_fins(&mut self) {
        for _ in 0..MAX_ROUNDS {
            let patches = self.smaller_patches();
            let mut fins =
                patches.iter().filter(|p| p.has_free && !p.crowded.is_empty()).peekable();
            if fins.peek().is_none() {
                break;
            }
            for &facet in fins.flat_map(|fin| &fin.facets) {
                self.states[facet] = FacetState::Fin;
            }
        }
    }

    /// Performs step 3.
    fn remove_walls(&mut self, back_to_back: &[bool]) {
        for _ in 0..MAX_ROUNDS {
            let mut walls = self.smaller_patches();
            walls.retain(|p| !p.has_free && !p.crowded.is_empty() && p.is_odd);
            let is_between = |p: &Patch| p.facets.iter().all(|&k| back_to_back[k]);
            walls.sort_by(|x, y| is_between(y).cmp(&is_between(x)).then(x.area.total_cmp(&y.area)));
            if walls.is_empty() {
                break;
            }
            let mut touched: HashSet<u64> = HashSet::new();
            for wall in walls {
                if wall.crowded.iter().any(|edge| touched.contains(edge)) {
                    continue;
                }
                touched.extend(&wall.crowded);
                for &facet in &wall.facets {
                    self.states[facet] = FacetState::Wall;
                }
            }
        }
    }

    /// Returns all patches except the largest of each piece.
    fn smaller_patches(&self) -> Vec<Patch> {
        let facet_sides = self.remaining_uses();
        let mut sets = OrientedSets::new(self.faces.len());
        for edge in sides_by_edge(&facet_sides) {
            if let [a, b] = edge {
                sets.join(a.face, b.face, false);
            }
        }
        let mut patches: HashMap<usize, Patch> = HashMap::new();
        for k in (0..self.faces.len()).filter(|&k| self.states[k] == FacetState::Remains) {
            let first = || Patch { is_odd: true, ..Patch::default() };
            let patch = patches.entry(sets.root(k).0).or_insert_with(first);
            patch.facets.push(k);
            patch.area += self.areas[k];
        }
        for edge in sides_by_edge(&facet_sides).filter(|edge| edge.len() != 2) {
            for used in edge {
                let Some(patch) = patches.get_mut(&sets.root(used.face).0) else { continue };
                if edge.len() == 1 {
                    patch.has_free = true;
                } else {
                    patch.crowded.push(used.edge);
                    patch.is_odd &= edge.len() % 2 == 1;
                }
            }
        }
        let mut patches: Vec<Patch> = patches.into_values().collect();
        // Patches with equal areas are in the order of the file.
        patches.sort_by(|x, y| y.area.total_cmp(&x.area).then(x.facets.cmp(&y.facets)));
        let mut seen = HashSet::new();
        patches.retain(|patch| !seen.insert(self.pieces[patch.facets[0]]));
        patches
    }

    /// Restores the invariant: pieces that are not closed, or lost too much area, get back all facets.
    fn restore_pieces(&mut self) {
        let mut left: HashMap<usize, [f64; 2]> = HashMap::new();
        for (k, state) in self.states.iter().enumerate() {
            let [all, out] = left.entry(self.pieces[k]).or_default();
            match state {
                FacetState::Flat | FacetState::Double => {}
                FacetState::Remains => *all += self.areas[k],
                FacetState::Fin | FacetState::Wall => {
                    *all += self.areas[k];
                    *out += self.areas[k];
                }
            }
        }
        left.retain(|_, [all, out]| *out > MAX_REMOVED_SHARE * *all);
        for edge in sides_by_edge(&self.remaining_uses()).filter(|edge| edge.len() % 2 == 1) {
            left.insert(self.pieces[edge[0].face], [0.0; 2]);
        }
        for (state, piece) in self.states.iter_mut().zip(&self.pieces) {
            if *state != FacetState::Flat && left.contains_key(piece) {
                *state = FacetState::Remains;
            }
        }
    }
}

/// Returns the corners of a facet in a canonical order, which is the same for its duplicates, and 1 or -1 for
/// its orientation.
fn canonical_cycle(face: &[u32]) -> (Vec<u32>, i64) {
    let lowest = (0..face.len()).min_by_key(|&k| face[k]).unwrap_or(0);
    let at = |k: usize| face[(lowest + k) % face.len()];
    let (forward, n) = (at(1) <= at(face.len() - 1), face.len());
    let corners = (0..n).map(|k| if forward { at(k) } else { at(n - k) }).collect();
    (corners, if forward { 1 } else { -1 })
}

#[cfg(test)]
mod tests {
    use colltrans::Solid;
    use colltrans_testkit::random::Random;
    use colltrans_testkit::shapes::{self, block, prism, ring_sphere};

    use super::*;

    /// Returns the facets as canonical cycles, independent of their order and first corners.
    fn canonical_facets(mesh: &Mesh) -> Vec<(Vec<u32>, i64)> {
        let mut all: Vec<_> = mesh.faces.iter().map(|face| canonical_cycle(face)).collect();
        all.sort_unstable();
        all
    }

    fn mesh_from(shape: shapes::Mesh) -> Mesh {
        Mesh::new(shape.vertices, shape.faces)
    }

    /// Two spheres and a prism, disjoint, of triangles or of polygons.
    fn clean_mesh(random: &mut Random) -> Mesh {
        let all = ring_sphere(24, 11)
            .joined(&ring_sphere(20, 12).translated(DVec3::X * 4.0))
            .joined(&prism(30, 2.0).translated(DVec3::Y * 5.0));
        mesh_from(if random.one_in(2) { all.triangulated() } else { all })
    }

    /// Adds a strip of facets that adjoins an edge, with distances up to `size`.
    fn add_fin(mesh: &mut Mesh, size: f64, random: &mut Random) {
        let face = mesh.faces[random.index(mesh.faces.len())].clone();
        let (mut a, mut b) = (face[0], face[1]);
        if random.one_in(2) {
            (a, b) = (b, a);
        }
        for _ in 0..=random.index(3) {
            let top = mesh.vertices.len() as u32;
            let middle = (mesh.vertices[a as usize] + mesh.vertices[b as usize]) / 2.0;
            mesh.vertices.push(middle + size * random.direction());
            mesh.faces.push(vec![a, b, top]);
            if random.one_in(2) {
                a = top;
            } else {
                b = top;
            }
        }
    }

    #[test]
    fn added_defects_are_repaired() {
        let mut random = Random::new(31);
        for round in 0..300 {
            let clean_mesh = clean_mesh(&mut random);
            let mut spoilt = clean_mesh.clone();
            let [fins, doubles, turned] = [4, 30, 40].map(|most| random.index(most));
            for _ in 0..doubles {
                let mut double = spoilt.faces[random.index(clean_mesh.faces.len())].clone();
                double.rotate_left(random.index(3));
                if random.one_in(2) {
                    double.reverse();
                }
                spoilt.faces.push(double);
            }
            // Some facets of the clean mesh are reversed, so that the first of two duplicates may be reversed.
            for _ in 0..turned {
                let facet = random.index(clean_mesh.faces.len());
                spoilt.faces[facet].reverse();
            }
            let before = spoilt.faces.len();
            for _ in 0..fins {
                add_fin(&mut spoilt, 0.05, &mut random);
            }
            let of_fins = spoilt.faces.len() - before;
            let repaired = repair(&mut spoilt);
            let case = format!("round {round}: {fins} fins, {doubles} doubles: {repaired:?}");
            assert_eq!(canonical_facets(&spoilt), canonical_facets(&clean_mesh), "{case}");
            assert_eq!(
                (repaired.doubles.facets, repaired.fins.facets),
                (doubles, of_fins),
                "{case}"
            );
            assert_eq!(repaired.walls, RemovedFaces::default(), "{case}");
            assert!(Solid::from_mesh(&spoilt.vertices, &spoilt.faces).is_ok(), "{case}");
        }
    }

    /// A square face is present twice, cut along different diagonals: two ways to close one hole.
    #[test]
    fn one_of_two_closings_of_a_hole_remains() {
        let whole = mesh_from(prism(60, 0.05));
        let side = |mesh: &Mesh| mesh.faces.iter().position(|face| face.len() == 4).unwrap();
        let mut spoilt = whole.clone();
        let square = spoilt.faces.swap_remove(side(&spoilt));
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| square[k]);
        spoilt.faces.extend([vec![a, b, c], vec![a, c, d], vec![b, d, a], vec![b, c, d]]);
        let repaired = repair(&mut spoilt);
        assert_eq!((repaired.walls.facets, repaired.fins.facets), (2, 0), "{repaired:?}");
        let solid = Solid::from_mesh(&spoilt.vertices, &spoilt.faces).unwrap();
        assert!(solid.is_closed());
        assert!((spoilt.signed_volume() - whole.signed_volume()).abs() < 1e-12);
    }

    /// The wall between two bodies, of opposite facets, is removed, and not the smaller lid.
    #[test]
    fn wall_between_two_bodies_is_removed() {
        let tall = block(DVec3::ZERO, DVec3::new(1.0, 1.0, 80.0));
        let lid = block(DVec3::new(0.0, 0.0, 80.0), DVec3::new(1.0, 1.0, 80.01));
        let mut both = mesh_from(tall.joined(&lid));
        let (vertices, welded) = both.welded_copy();
        let is_wall = |face: &Vec<u32>| face.iter().all(|&v| vertices[v as usize].z == 80.0);
        // A pyramid that points down, larger than the lid.
        let apex = vertices.len() as u32;
        let mut faces = Vec::new();
        for face in welded {
            if is_wall(&face) {
                faces.extend((0..4).map(|k| vec![face[k], face[(k + 1) % 4], apex]));
            } else {
                faces.push(face);
            }
        }
        both = Mesh::new([&vertices[..], &[DVec3::new(0.5, 0.5, 79.0)]].concat(), faces);
        both.faces[0].reverse();
        let repaired = repair(&mut both);
        assert_eq!((repaired.doubles.facets, repaired.walls.facets), (4, 4), "{repaired:?}");
        assert!(Solid::from_mesh(&both.vertices, &both.faces).unwrap().is_closed());
        assert!((both.signed_volume() - 80.01).abs() < 1e-9);
    }

    /// Large parts are geometry: a sail on a pole, a book of three pages, a box without a lid with a sheet in
    /// it.
    #[test]
    fn large_parts_are_not_removed() {
        let mut sail = mesh_from(prism(60, 1.0));
        add_fin(&mut sail, 40.0, &mut Random::new(7));
        let page = |k: u32| vec![0, 1, 2 + k];
        let book = Mesh::new(
            vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_Y],
            vec![page(0), page(1), page(2)],
        );
        let mut open = mesh_from(block(DVec3::ZERO, DVec3::ONE));
        open.faces.pop();
        let side = open.faces[0].clone();
        open.vertices.push(DVec3::splat(0.5));
        open.faces.push(vec![side[0], side[1], open.vertices.len() as u32 - 1]);
        for mesh in [sail, book, open] {
            let mut repaired = mesh.clone();
            let done = repair(&mut repaired);
            assert_eq!(repaired.faces.len(), mesh.faces.len(), "{done:?}");
        }
    }
}
