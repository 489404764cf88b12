//! Bodies of a solid: a shell with its cavities.
//!
//! A cavity is a closed shell with a negative volume. It belongs to the smallest closed shell of positive volume in the
//! same piece that contains it. If there is none, it is a body of its own. As in [`shells`], containment is decided
//! exactly by the ray along `z` from a vertex of the cavity, with the tree of boxes.

use std::collections::{BTreeMap, HashMap};

use glam::DVec3;

use super::edges;
use super::shells::{self, MAX_TRIED_TRIANGLES, lies_on_triangle, ray_crossing};
use super::{Solid, SolidError};
use colltrans_convex::body::Aabb;

impl Solid {
    /// Builds each piece of a union as a solid of its own. A body that is not a union is its only piece.
    ///
    /// # Errors
    /// Returns an error if the facets of a piece are not a surface of their own.
    pub fn to_pieces(&self) -> Result<Vec<Self>, SolidError> {
        if self.groups.piece_starts.is_empty() {
            return Ok(vec![self.clone()]);
        }
        let mut pieces: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for t in 0..self.triangles.len() {
            pieces.entry(self.piece_of(t)).or_default().push(t);
        }
        let build = |own: &Vec<usize>| {
            let (mut vertices, mut numbers) = (Vec::new(), HashMap::new());
            let mut number = |v: u32| {
                *numbers.entry(v).or_insert_with(|| {
                    vertices.push(self.vertices[v as usize]);
                    vertices.len() as u32 - 1
                })
            };
            let facets: Vec<_> = own.iter().map(|&t| self.triangles[t].map(&mut number)).collect();
            if own.iter().any(|&t| self.is_open(t)) {
                Self::from_open_mesh(&vertices, &facets)
            } else {
                Self::from_mesh(&vertices, &facets)
            }
        };
        pieces.values().map(build).collect()
    }

    /// Returns the body of each of [`Self::triangles`]: a closed shell with its cavities, or an open shell.
    ///
    /// Bodies are numbered from 0, in the order of their first facets in the input.
    ///
    /// ```
    /// use colltrans::Solid;
    /// use colltrans::glam::DVec3;
    ///
    /// let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    /// let vertices: Vec<DVec3> = corners.into_iter().chain(corners.map(|p| p + 5.0)).collect();
    /// let facets: Vec<[u32; 3]> = [0, 4]
    ///     .into_iter()
    ///     .flat_map(|k| [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]].map(|t| t.map(|v| v + k)))
    ///     .collect();
    /// let both = Solid::from_mesh(&vertices, &facets)?;
    /// let mut bodies = both.bodies();
    /// bodies.sort_unstable();
    /// assert_eq!(bodies, [0, 0, 0, 0, 1, 1, 1, 1]);
    /// # Ok::<(), colltrans::solid::SolidError>(())
    /// ```
    pub fn bodies(&self) -> Vec<u32> {
        let shell_of = edges::shell_numbers(&self.neighbours);
        let corner = |v: u32| self.vertices[v as usize];
        let volumes = shells::shell_volumes(&shell_of, &self.triangles, corner);
        let body_of = |shell: usize| {
            let is_cavity = volumes[shell] < 0.0 && self.is_shell_closed(shell as u32);
            if is_cavity { self.enclosing_shell(shell, &shell_of, &volumes) } else { shell }
        };
        let body_of: Vec<usize> = (0..volumes.len()).map(body_of).collect();
        let mut first = vec![u32::MAX; volumes.len()];
        for (&shell, facet) in shell_of.iter().zip(&self.facet_index) {
            let first = &mut first[body_of[shell as usize]];
            *first = facet.0.min(*first);
        }
        let mut bodies: Vec<usize> = (0..volumes.len()).filter(|&s| body_of[s] == s).collect();
        bodies.sort_by_key(|&s| (first[s], s));
        let mut number = vec![0; volumes.len()];
        for (&body, k) in bodies.iter().zip(0..) {
            number[body] = k;
        }
        shell_of.iter().map(|&shell| number[body_of[shell as usize]]).collect()
    }

    /// Returns the smallest closed shell of the same piece around a cavity, or the cavity itself if there is none.
    ///
    /// The tested vertex lies on no other shell, if one of the first [`MAX_TRIED_TRIANGLES`] triangles has such a
    /// vertex, because shells may touch.
    fn enclosing_shell(&self, cavity: usize, shell_of: &[u32], volumes: &[f64]) -> usize {
        let corners = |t: usize| self.triangle_corners(t as u32);
        let first = self.spans[cavity].triangle as usize;
        let others = (0..shell_of.len()).filter(|&t| t != first && shell_of[t] as usize == cavity);
        let points = || std::iter::once(first).chain(others.clone()).flat_map(corners);
        let is_off = |p: &DVec3| {
            let is_on =
                |t: usize| shell_of[t] as usize != cavity && lies_on_triangle(*p, corners(t));
            !(0..shell_of.len()).any(is_on)
        };
        let [on_first, ..] = corners(first);
        let p = points().take(3 * MAX_TRIED_TRIANGLES).find(is_off).unwrap_or(on_first);
        let piece = self.piece_of(first);
        let windings = self.shell_windings(p, shell_of, |t| self.piece_of(t) == piece);
        let around = windings.into_iter().filter(|&(shell, winding)| {
            winding != 0 && volumes[shell] > 0.0 && self.is_shell_closed(shell as u32)
        });
        let smallest = around.min_by(|(a, _), (b, _)| volumes[*a].total_cmp(&volumes[*b]));
        smallest.map_or(cavity, |(shell, _)| shell)
    }

    /// Computes the winding numbers of shells around a point, of those that a ray from it meets, with the triangles for
    /// which `counts` holds.
    fn shell_windings(
        &self,
        p: DVec3,
        shell_of: &[u32],
        counts: impl Fn(usize) -> bool,
    ) -> BTreeMap<usize, i32> {
        let mut windings = BTreeMap::new();
        let mut open = vec![0];
        while let Some(at) = open.pop() {
            let node = &self.nodes[at];
            let [low, high] = [node.bounds.low, node.bounds.high];
            if p.z > high.z || !(low.x..=high.x).contains(&p.x) || !(low.y..=high.y).contains(&p.y)
            {
                continue;
            }
            if !node.is_leaf() {
                open.extend([at + node.child_offset as usize, at + node.child_offset as usize + 1]);
                continue;
            }
            for t in node.facets().filter(|&t| counts(t)) {
                *windings.entry(shell_of[t] as usize).or_default() +=
                    ray_crossing(p, self.triangle_corners(t as u32));
            }
        }
        windings
    }

    /// Checks whether a closed shell winds around one of some points, and has a distance of more than `margin` from it.
    #[doc(hidden)]
    pub fn encloses_any(&self, points: impl IntoIterator<Item = DVec3>, margin: f64) -> bool {
        let shell_of = edges::shell_numbers(&self.neighbours);
        let is_beyond = |t: usize, p: DVec3| {
            let [a, b, c] = self.triangle_corners(t as u32);
            let near = Aabb::from_triangle([a, b, c]).expanded(margin);
            let normal = (b - a).cross(c - a);
            !near.contains_box(&Aabb { low: p, high: p })
                || normal.dot(p - a).abs() > margin * normal.length()
        };
        points.into_iter().any(|p| {
            let windings = self.shell_windings(p, &shell_of, |_| true);
            windings.into_iter().any(|(shell, winding)| {
                winding != 0
                    && self.is_shell_closed(shell as u32)
                    && (0..shell_of.len())
                        .filter(|&t| shell_of[t] as usize == shell)
                        .all(|t| is_beyond(t, p))
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use colltrans_testkit::shapes::{Mesh, block};
    use glam::DVec3;

    use super::*;

    fn cube_between(low: f64, high: f64) -> Mesh {
        block(DVec3::splat(low), DVec3::splat(high))
    }

    /// Returns the body of each input facet.
    fn bodies_of_facets(mesh: &Mesh) -> Vec<u32> {
        let solid = Solid::from_open_mesh(&mesh.vertices, &mesh.faces).unwrap();
        let mut of_facet = vec![u32::MAX; mesh.faces.len()];
        for (body, facet) in solid.bodies().into_iter().zip(solid.facet_indices()) {
            let known = &mut of_facet[facet.index()];
            assert!(*known == u32::MAX || *known == body);
            *known = body;
        }
        of_facet
    }

    /// Returns each number six times.
    fn six_of_each(numbers: &[u32]) -> Vec<u32> {
        numbers.iter().flat_map(|&n| [n; 6]).collect()
    }

    #[test]
    fn cavities_belong_to_the_enclosing_shell() {
        // A nut in a hollow ball in a hollow box, with the facets out of order, next to a reversed box.
        let mesh = cube_between(2.0, 3.0)
            .joined(&cube_between(0.5, 4.5).reversed())
            .joined(&cube_between(1.0, 4.0))
            .joined(&cube_between(1.5, 3.5).reversed())
            .joined(&cube_between(0.0, 5.0));
        // Reversing all shells changes no body.
        assert_eq!(bodies_of_facets(&mesh.clone().reversed()), six_of_each(&[0, 1, 2, 2, 1]));
        assert_eq!(
            bodies_of_facets(&mesh.joined(&cube_between(6.0, 7.0).reversed())),
            six_of_each(&[0, 1, 2, 2, 1, 3])
        );
    }

    #[test]
    fn touching_or_overlapping_shells_are_two_bodies() {
        let side = |at: f64| block(DVec3::new(at, 0.0, 0.0), DVec3::new(at + 1.0, 1.0, 1.0));
        let face_to_face = side(0.0).joined(&side(1.0));
        assert_eq!(bodies_of_facets(&face_to_face), six_of_each(&[0, 1]));
        let edge = block(DVec3::new(1.0, 1.0, 0.0), DVec3::new(2.0, 2.0, 1.0));
        assert_eq!(bodies_of_facets(&side(0.0).joined(&edge)), six_of_each(&[0, 1]));
        // Overlapping shells, and a shell inside another one that is not a cavity.
        assert_eq!(bodies_of_facets(&side(0.0).joined(&side(0.5))), six_of_each(&[0, 1]));
        assert_eq!(
            bodies_of_facets(&cube_between(0.0, 3.0).joined(&cube_between(1.0, 2.0))),
            six_of_each(&[0, 1])
        );
    }

    #[test]
    fn open_shell_is_a_separate_body() {
        let mut mesh = cube_between(0.0, 3.0)
            .joined(&cube_between(1.0, 2.0).reversed())
            .joined(&cube_between(5.0, 6.0));
        mesh.faces.pop();
        assert_eq!(bodies_of_facets(&mesh), six_of_each(&[0, 0, 1])[..17]);
    }
}
