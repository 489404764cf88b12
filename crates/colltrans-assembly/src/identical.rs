//! Identical parts: one shape in several poses, for example screws and nuts.
//!
//! The comparison uses numbers that do not depend on the pose, within the rounding of single precision: the numbers
//! of vertices and facets, the volume, the area, and the principal moments. For a part without symmetry it also uses
//! the handedness, which distinguishes mirror images. Mirror images that are symmetric in themselves, or nearly so,
//! count as identical, for example left-hand and right-hand screws. The result affects the order of a plan and its
//! texts, never which directions are free.

use std::collections::{BTreeMap, HashMap};

use colltrans::Solid;
use glam::DVec3;

use crate::inertia;
use crate::part::Assembly;

/// Relative difference below which two numbers are equal: some roundings of single precision, far from the origin.
const EQUAL: f64 = 1e-4;

/// Returns for each part the index of the first identical part, which may be the part itself.
pub fn first_identical_parts(assembly: &Assembly) -> Vec<usize> {
    let shapes: Vec<Shape> =
        assembly.parts().iter().map(|p| Shape::from_solid(p.solid())).collect();
    let mut seen: HashMap<[usize; 2], Vec<usize>> = HashMap::new();
    let first = |(k, shape): (usize, &Shape)| {
        let known = seen.entry(shape.counts).or_default();
        let like = known.iter().copied().find(|&other| shapes[other].is_identical_to(shape));
        like.unwrap_or_else(|| {
            known.push(k);
            k
        })
    };
    shapes.iter().enumerate().map(first).collect()
}

/// Returns the common beginning of some names without trailing numbers, or `None` if it is empty.
pub fn common_name(names: &[&str]) -> Option<String> {
    let (first, rest) = names.split_first()?;
    let shared = rest.iter().fold(first.len(), |length, name| {
        let same = first.char_indices().zip(name.chars()).find(|((_, a), b)| a != b);
        length.min(same.map_or(name.len(), |((at, _), _)| at))
    });
    let mut end = shared.min(first.len());
    while !first.is_char_boundary(end) {
        end -= 1;
    }
    let number = |c: char| c.is_ascii_digit() || " _-.:#".contains(c);
    let name = first[..end].trim_end_matches(number);
    (!name.is_empty()).then(|| name.to_owned())
}

/// Groups pairs of parts with the same shapes and key. Returns for each group the value of its first pair, and the
/// parts of both sides in increasing order.
pub(crate) fn group_identical_pairs<K: Ord, T>(
    likes: &[usize],
    all: impl Iterator<Item = ([usize; 2], K, T)>,
) -> Vec<(T, [Vec<usize>; 2])> {
    let like = |part: usize| likes.get(part).copied().unwrap_or(part);
    let mut groups = BTreeMap::<([usize; 2], K), (T, [Vec<usize>; 2])>::new();
    for (parts, key, value) in all {
        let (_, sides) =
            groups.entry((parts.map(like), key)).or_insert((value, Default::default()));
        for (side, part) in sides.iter_mut().zip(parts) {
            if let Err(at) = side.binary_search(&part) {
                side.insert(at, part);
            }
        }
    }
    groups.into_values().collect()
}

/// The quantities by which parts are compared.
struct Shape {
    counts: [usize; 2],
    volume: f64,
    area: f64,
    moments: DVec3,
    right_handed: Option<bool>,
}

impl Shape {
    fn from_solid(solid: &Solid) -> Self {
        let corner = |v: u32| solid.vertices()[v as usize];
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(corner);
            (b - a).cross(c - a).length() / 2.0
        };
        Self {
            counts: [solid.vertices().len(), solid.triangles().len()],
            volume: solid.volume(),
            area: solid.triangles().iter().map(area).sum(),
            moments: inertia::principal_moments(solid),
            right_handed: inertia::is_right_handed(solid),
        }
    }

    fn is_identical_to(&self, other: &Self) -> bool {
        let equal = |a: f64, b: f64| (a - b).abs() <= EQUAL * a.abs().max(b.abs());
        let largest = self.moments.abs().max_element();
        let near = (self.moments - other.moments).abs().max_element() <= EQUAL * largest;
        let mirrored = self.right_handed.zip(other.right_handed).is_some_and(|(a, b)| a != b);
        equal(self.volume, other.volume) && equal(self.area, other.area) && near && !mirrored
    }
}

#[cfg(test)]
mod tests {
    use colltrans_mesh::Mesh;
    use colltrans_testkit::random::Random;
    use colltrans_testkit::shapes::{cuboid, prism};
    use glam::DAffine3;

    use super::*;
    use crate::part::{Part, Piece};

    #[test]
    fn moved_copies_are_identical_and_other_shapes_are_not() {
        let mut random = Random::new(3);
        let shapes = [
            cuboid(DVec3::new(1.0, 2.0, 3.0)),
            cuboid(DVec3::new(1.0, 2.0, 3.01)),
            prism(12, 2.0),
            prism(12, 0.5),
        ];
        let mut parts = Vec::new();
        for k in 0..12 {
            let at = DVec3::new(random.unit(), random.unit(), random.unit()) * 100.0;
            let place = DAffine3::from_rotation_translation(random.rotation(), at);
            let shape = &shapes[k % 4];
            // Coordinates are rounded to single precision, as in a file.
            let corner = |v: &DVec3| place.transform_point3(*v).as_vec3().as_dvec3();
            let mesh = Mesh::new(shape.vertices.iter().map(corner).collect(), shape.faces.clone());
            let piece = Piece { mesh, world_from_piece: DAffine3::IDENTITY };
            parts.push(Part::new(format!("part {k}"), &[piece]).unwrap());
        }
        let found = first_identical_parts(&Assembly::new(parts).unwrap());
        assert_eq!(found, (0..12).map(|k| k % 4).collect::<Vec<_>>());
    }

    #[test]
    fn mirror_images_are_identical_only_if_symmetric() {
        let mut random = Random::new(5);
        let corners =
            [DVec3::ZERO, DVec3::X * 4.0, DVec3::new(1.0, 2.5, 0.0), DVec3::new(0.5, 0.4, 1.2)];
        let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]].map(|f| f.to_vec()).to_vec();
        let wedge = |corners: [DVec3; 4]| Mesh::new(corners.to_vec(), faces.clone());
        let block = cuboid(DVec3::new(1.0, 2.0, 3.0));
        let mut parts = Vec::new();
        for k in 0..24 {
            let at = DVec3::new(random.unit(), random.unit(), random.unit()) * 100.0;
            let mirror = DVec3::new(if k % 2 == 0 { 1.0 } else { -1.0 }, 1.0, 1.0);
            let turn = DAffine3::from_rotation_translation(random.rotation(), at);
            let place = turn * DAffine3::from_scale(mirror);
            let mesh = if k % 4 < 2 {
                wedge(corners)
            } else {
                Mesh::new(block.vertices.clone(), block.faces.clone())
            };
            let piece = Piece { mesh, world_from_piece: place };
            parts.push(Part::new(format!("part {k}"), &[piece]).unwrap());
        }
        let found = first_identical_parts(&Assembly::new(parts).unwrap());
        assert_eq!(found, (0..24).map(|k| [0, 1, 2, 2][k % 4]).collect::<Vec<_>>());
    }

    #[test]
    fn common_name_drops_trailing_numbers() {
        assert_eq!(common_name(&["bolt_1", "bolt_12"]).as_deref(), Some("bolt"));
        assert_eq!(common_name(&["M8 bolt", "M8 bolt_2"]).as_deref(), Some("M8 bolt"));
        assert_eq!(common_name(&["müßig", "müde"]).as_deref(), Some("mü"));
        assert_eq!(common_name(&["a", "b"]), None);
        assert_eq!(common_name(&[]), None);
    }
}
