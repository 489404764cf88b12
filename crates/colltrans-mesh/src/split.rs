//! Splits a mesh into the parts that its file names, or by the numbers of its faces.
//!
//! A named group need not be a body, because exporters group faces by material or by side. Groups that share an
//! open edge continue each other and form one part, with the name of the first one.

use std::collections::BTreeMap;

use crate::edges::{facet_sides, sides_by_edge};
use crate::mesh::{Groups, Mesh};
use crate::sets::OrientedSets;

/// The marker of a vertex that is not in use.
const NONE: u32 = u32::MAX;

impl Mesh {
    /// Returns the parts that the file names ([`Groups`]), in its order, each with its own vertices. Empty if
    /// there are fewer than two parts.
    ///
    /// Two groups belong to one part if at some edge both have sides without a matching side in the opposite
    /// direction.
    pub fn named_parts(&self) -> Vec<(String, Self)> {
        let Groups { names, of_face } = &self.groups;
        if of_face.len() != self.faces.len() || of_face.iter().any(|&g| g as usize >= names.len()) {
            return Vec::new();
        }
        let (_, faces) = self.welded_copy();
        let mut sets = OrientedSets::new(names.len());
        for edge in sides_by_edge(&facet_sides(&faces, |_| true)) {
            let mut balance: BTreeMap<u32, i64> = BTreeMap::new();
            for side in edge {
                *balance.entry(of_face[side.face]).or_default() +=
                    if side.backward { -1 } else { 1 };
            }
            // The sum over the directions is also not 0 if faces have opposite orientations.
            let mut open =
                balance.into_iter().filter(|(_, sides)| *sides != 0).map(|(g, _)| g as usize);
            if let Some(first) = open.next() {
                open.for_each(|other| {
                    sets.join(first, other, false);
                });
            }
        }
        // The sets are ordered by their first groups, because the root of a set is its smallest member.
        let mut places: BTreeMap<usize, u32> = BTreeMap::new();
        for &group in of_face {
            places.insert(sets.root(group as usize).0, 0);
        }
        if places.len() < 2 {
            return Vec::new();
        }
        for (place, number) in places.values_mut().zip(0..) {
            *place = number;
        }
        let of_face: Vec<u32> = of_face.iter().map(|&g| places[&sets.root(g as usize).0]).collect();
        let meshes = self.split_faces(&of_face, places.len());
        places.keys().map(|&group| names[group].clone()).zip(meshes).collect()
    }

    /// Splits the faces by their numbers. Returns a mesh for each number below `count`, with the faces and the
    /// used vertices in the order of this mesh. All corners must be valid vertex indices.
    pub fn split_faces(&self, number_of_face: &[u32], count: usize) -> Vec<Self> {
        let mut faces: Vec<Vec<usize>> = vec![Vec::new(); count];
        for (k, &number) in number_of_face.iter().enumerate() {
            if let Some(faces) = faces.get_mut(number as usize) {
                faces.push(k);
            }
        }
        let mut new_index = vec![NONE; self.vertices.len()];
        let mut pick = |faces: Vec<usize>| {
            let mut used: Vec<u32> = faces.iter().flat_map(|&k| &self.faces[k]).copied().collect();
            used.sort_unstable();
            used.dedup();
            for (&v, name) in used.iter().zip(0..) {
                new_index[v as usize] = name;
            }
            let renamed = |k: usize| self.faces[k].iter().map(|&v| new_index[v as usize]).collect();
            let vertices = used.iter().map(|&v| self.vertices[v as usize]).collect();
            let mesh = Self::new(vertices, faces.into_iter().map(renamed).collect());
            Self {
                precision: self.precision,
                format: self.format,
                unit: self.unit,
                up: self.up,
                ..mesh
            }
        };
        faces.into_iter().map(&mut pick).collect()
    }
}

#[cfg(test)]
mod tests {
    use colltrans_testkit::shapes::{block, ring_sphere};
    use glam::DVec3;

    use super::*;

    fn grouped(parts: &[(&str, &colltrans_testkit::shapes::Mesh)]) -> Mesh {
        let (mut mesh, mut groups) = (Mesh::default(), Groups::default());
        for (name, part) in parts {
            let base = mesh.vertices.len() as u32;
            mesh.vertices.extend(&part.vertices);
            mesh.faces.extend(part.faces.iter().map(|f| f.iter().map(|v| v + base).collect()));
            groups.end_group(name, mesh.faces.len());
        }
        Mesh { groups, ..mesh }
    }

    fn part_names(mesh: &Mesh) -> Vec<(String, usize)> {
        mesh.named_parts().into_iter().map(|(name, mesh)| (name, mesh.faces.len())).collect()
    }

    #[test]
    fn named_parts_have_their_own_vertices() {
        let (cube, ball) = (block(DVec3::ZERO, DVec3::ONE), ring_sphere(8, 3));
        let mesh = grouped(&[("cube", &cube), ("ball", &ball), ("cube", &cube)]);
        let named = mesh.named_parts();
        assert_eq!(
            named.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(),
            ["cube", "ball", "cube"]
        );
        for ((_, found), part) in named.iter().zip([&cube, &ball, &cube]) {
            assert_eq!((&found.vertices, &found.faces), (&part.vertices, &part.faces));
        }
        assert!(grouped(&[("cube", &cube)]).named_parts().is_empty());
    }

    #[test]
    fn groups_joined_at_open_edges_are_one_part() {
        // The sides of one cube as groups of a material, and two cubes that touch, which are two parts.
        let cube = block(DVec3::ZERO, DVec3::ONE);
        let of = |range: std::ops::Range<usize>| {
            let faces = cube.faces[range].to_vec();
            colltrans_testkit::shapes::Mesh { vertices: cube.vertices.clone(), faces }
        };
        let (front, rest) = (of(0..2), of(2..6));
        let beside = block(DVec3::X, DVec3::new(2.0, 1.0, 1.0));
        assert!(grouped(&[("front", &front), ("rest", &rest)]).named_parts().is_empty());
        let all = grouped(&[("front", &front), ("beside", &beside), ("rest", &rest)]);
        assert_eq!(part_names(&all), [("front".into(), 6), ("beside".into(), 6)]);
    }

    #[test]
    fn inconsistent_groups_yield_no_parts() {
        let cube = block(DVec3::ZERO, DVec3::ONE);
        let mut mesh = grouped(&[("a", &cube), ("b", &cube)]);
        mesh.faces.pop();
        assert!(mesh.named_parts().is_empty());
        mesh.groups.of_face.pop();
        assert_eq!(mesh.named_parts().len(), 2);
        mesh.groups.of_face[0] = 7;
        assert!(mesh.named_parts().is_empty());
    }
}
