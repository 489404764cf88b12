//! Facets that pass through each other under an offset, because a wall is too thin.
//!
//! - *Crossing facets* belong to one shell, or to two shells of which one is a cavity. Shells around material may
//!   overlap, as pieces do.
//! - *Enclosed shells*: the offset moves a cavity around a shell that it did not contain.
//! - Both are tested exactly at the final positions. Facets with a common vertex only fold, which reverses them, and
//!   are not compared.
//! - Existing crossings are ignored: within one shell by pairs of facets, between two shells by pairs of shells.
//!
//! A descent of the tree with itself finds the pairs. [`PairFilter`] dismisses pairs of nodes. Reasons:
//! `docs/theory/offsets.md`.

use std::cmp::Ordering;
use std::collections::BTreeSet;

use glam::DVec3;

use super::exact::sign_of_side;
use super::{Solid, shells};
use colltrans_convex::body::Aabb;
use colltrans_kernel::visit_counter;

mod pair_filter;

use pair_filter::PairFilter;

/// Returns the triangles, in increasing order, that pass through others when the vertices move to `moved`. `shell_of`
/// and `volumes` are those before the move.
pub(super) fn crossing_facets(
    solid: &Solid,
    moved: &[DVec3],
    shell_of: &[u32],
    volumes: &[f64],
) -> Vec<usize> {
    let shells = Shells { solid, shell_of, volumes };
    let [before, after] =
        [&solid.vertices[..], moved].map(|vertices| PlacedFacets { solid, vertices });
    let mut crossing: Vec<[usize; 2]> = Vec::new();
    after.visit_pairs(&mut |pair| {
        if shells.is_defect(pair) && after.have_common_point(pair) {
            crossing.push(pair);
        }
    });
    let mut crossing_shells = BTreeSet::new();
    if crossing.iter().any(|&pair| !shells.is_one_shell(pair)) {
        before.visit_pairs(&mut |pair| {
            if !shells.is_one_shell(pair)
                && shells.is_defect(pair)
                && before.edge_pierces_facet(pair)
            {
                crossing_shells.insert(shells.shells_of_pair(pair));
            }
        });
    }
    crossing.retain(|&pair| {
        if shells.is_one_shell(pair) {
            !before.have_common_point(pair)
        } else {
            !crossing_shells.contains(&shells.shells_of_pair(pair))
        }
    });
    let mut found = crossing.into_flattened();
    found.extend(shells.newly_enclosed_facets(&before, &after));
    found.sort_unstable();
    found.dedup();
    found
}

/// The shells of a solid.
struct Shells<'a> {
    solid: &'a Solid,
    shell_of: &'a [u32],
    volumes: &'a [f64],
}

impl Shells<'_> {
    /// Returns the shells of two facets, the smaller number first.
    fn shells_of_pair(&self, pair: [usize; 2]) -> [u32; 2] {
        let [a, b] = pair.map(|t| self.shell_of[t]);
        [a.min(b), a.max(b)]
    }

    fn is_one_shell(&self, pair: [usize; 2]) -> bool {
        let [a, b] = self.shells_of_pair(pair);
        a == b
    }

    /// Checks whether a shell is the wall of a cavity.
    fn is_cavity(&self, shell: u32) -> bool {
        self.solid.is_shell_closed(shell) && self.volumes[shell as usize] < 0.0
    }

    /// Checks whether a crossing of two facets is a defect: they belong to one shell, or one of them to a cavity.
    fn is_defect(&self, pair: [usize; 2]) -> bool {
        self.is_one_shell(pair)
            || self.shells_of_pair(pair).into_iter().any(|shell| self.is_cavity(shell))
    }

    /// Returns the facets of cavities that newly contain another shell, and the facets of that shell.
    fn newly_enclosed_facets(&self, before: &PlacedFacets, after: &PlacedFacets) -> Vec<usize> {
        let count = self.volumes.len() as u32;
        let cavities: Vec<u32> = (0..count).filter(|&s| self.is_cavity(s)).collect();
        if cavities.is_empty() {
            return Vec::new();
        }
        let [old, new] = [before, after].map(|placed| self.shell_boxes(placed));
        let within = |boxes: &[Aabb], inner: u32, outer: u32| {
            boxes[outer as usize].contains_box(&boxes[inner as usize])
        };
        let mut found = BTreeSet::new();
        for &cavity in &cavities {
            let around =
                |s: &u32| *s != cavity && within(&new, *s, cavity) && !within(&old, *s, cavity);
            for shell in (0..count).filter(around) {
                if self.is_inside(after, shell, cavity) {
                    found.extend([cavity, shell]);
                }
            }
        }
        let belongs = |t: &usize| found.contains(&self.shell_of[*t]);
        (0..self.shell_of.len()).filter(belongs).collect()
    }

    fn shell_boxes(&self, placed: &PlacedFacets) -> Vec<Aabb> {
        let mut boxes = vec![Aabb::EMPTY; self.volumes.len()];
        for (t, &shell) in self.shell_of.iter().enumerate() {
            placed.facet_corners(t).into_iter().for_each(|p| boxes[shell as usize].extend_to(p));
        }
        boxes
    }

    /// Checks whether the first corner of one shell is inside another shell.
    fn is_inside(&self, placed: &PlacedFacets, inner: u32, outer: u32) -> bool {
        let of = |shell| (0..self.shell_of.len()).filter(move |&t| self.shell_of[t] == shell);
        let Some(first) = of(inner).next() else { return false };
        let [point, ..] = placed.facet_corners(first);
        of(outer).map(|t| shells::ray_crossing(point, placed.facet_corners(t))).sum::<i32>() != 0
    }
}

/// The facets of a solid with other positions of the vertices.
struct PlacedFacets<'a> {
    solid: &'a Solid,
    vertices: &'a [DVec3],
}

impl PlacedFacets<'_> {
    fn facet_corners(&self, triangle: usize) -> [DVec3; 3] {
        self.solid.triangles[triangle].map(|v| self.vertices[v as usize])
    }

    /// Visits all pairs of facets, except those whose nodes [`PairFilter::excludes_pair`] excludes.
    fn visit_pairs(&self, visit: &mut impl FnMut([usize; 2])) {
        let pair_filter = PairFilter::new(self);
        let mut stack = vec![[0, 0]];
        while let Some([a, b]) = stack.pop() {
            visit_counter::count_visits(1);
            if pair_filter.excludes_pair(a, b) {
                continue;
            }
            let [m, n] = [a, b].map(|k| &self.solid.nodes[k]);
            let halves =
                |k: usize| [0, 1].map(|n| k + self.solid.nodes[k].child_offset as usize + n);
            if m.is_leaf() && n.is_leaf() {
                visit_counter::count_visits(m.facets().len() * n.facets().len());
                for s in m.facets() {
                    n.facets().filter(|&t| a != b || s < t).for_each(|t| visit([s, t]));
                }
            } else if a == b {
                let [x, y] = halves(a);
                stack.extend([[x, x], [y, y], [x, y]]);
            } else if n.is_leaf()
                || (!m.is_leaf() && pair_filter.longest_side(a) >= pair_filter.longest_side(b))
            {
                stack.extend(halves(a).map(|x| [x, b]));
            } else {
                stack.extend(halves(b).map(|y| [a, y]));
            }
        }
    }

    /// Checks whether two facets without a common vertex have a common point.
    fn have_common_point(&self, pair: [usize; 2]) -> bool {
        self.any_edge_satisfies(pair, |ends, turns| {
            ends[0] != ends[1]
                && !(turns.contains(&Ordering::Less) && turns.contains(&Ordering::Greater))
        })
    }

    /// Checks whether an edge of one facet passes through the interior of the other one.
    fn edge_pierces_facet(&self, pair: [usize; 2]) -> bool {
        self.any_edge_satisfies(pair, |ends, turns| {
            ends[0] == ends[1].reverse()
                && ends[0] != Ordering::Equal
                && turns[0] != Ordering::Equal
                && turns.iter().all(|t| *t == turns[0])
        })
    }

    /// Checks whether the condition `holds` is true for an edge of one facet and the other facet. Its first argument
    /// is the sides of the plane of the facet on which the ends of the edge lie. Its second argument is the
    /// orientations of the line of the edge with the sides of the facet. Returns false for facets with a common
    /// vertex, in one plane, or on one side of the plane of the other.
    fn any_edge_satisfies(
        &self,
        [s, t]: [usize; 2],
        holds: impl Fn([Ordering; 2], [Ordering; 3]) -> bool,
    ) -> bool {
        let [f, g] = [s, t].map(|k| self.solid.triangles[k]);
        if f.iter().any(|v| g.contains(v)) {
            return false;
        }
        let (f, g) = (self.facet_corners(s), self.facet_corners(t));
        if !Aabb::from_points(f).intersects(&Aabb::from_points(g))
            || are_certainly_separated(&f, &g)
        {
            return false;
        }
        let sides = |f: [DVec3; 3], [a, b, c]: [DVec3; 3]| {
            let sides = f.map(|p| sign_of_side(a, b, c, p));
            (sides[0] != sides[1] || sides[0] != sides[2]).then_some(sides)
        };
        // `None` if the facets lie in one plane, or one of them strictly on one side of the plane of the other.
        let (Some(of_f), Some(of_g)) = (sides(f, g), sides(g, f)) else { return false };
        let pierces = |f: [DVec3; 3], sides: [Ordering; 3], [a, b, c]: [DVec3; 3]| {
            (0..3).any(|k| {
                let (p, q) = (f[k], f[(k + 1) % 3]);
                let ends = [sides[k], sides[(k + 1) % 3]];
                ends[0] != ends[1]
                    && holds(ends, [(a, b), (b, c), (c, a)].map(|(u, v)| sign_of_side(p, q, u, v)))
            })
        };
        pierces(f, of_f, g) || pierces(g, of_g, f)
    }
}

/// Checks whether a plane that is perpendicular to one facet and parallel to one of its sides certainly separates the
/// facets. The normal may be rounded, because any vector can prove separation. Its products have an error below `4 u`
/// times its sum norm and the largest coordinate.
fn are_certainly_separated(f: &[DVec3; 3], g: &[DVec3; 3]) -> bool {
    let size = |t: &[DVec3; 3]| t.iter().fold(0.0_f64, |most, p| most.max(p.abs().max_element()));
    let size = size(f).max(size(g));
    [f, g].into_iter().any(|t| {
        let normal = (t[1] - t[0]).cross(t[2] - t[0]);
        (0..3).any(|k| {
            let across = normal.cross(t[(k + 1) % 3] - t[k]);
            let ends = |t: &[DVec3; 3]| {
                let [a, b, c] = t.map(|p| across.dot(p));
                [a.min(b).min(c), a.max(b).max(c)]
            };
            let ([low, high], [least, most]) = (ends(f), ends(g));
            let slack = 8.0 * f64::EPSILON * across.abs().element_sum() * size;
            low - most > slack || least - high > slack
        })
    })
}

#[cfg(test)]
mod tests {
    use colltrans_testkit::random::Random;
    use colltrans_testkit::shapes::{Mesh, cone, extruded, ring};
    use colltrans_testkit::solids::{bumpy_ball, comb, perforated_plate, slab, washer};

    use super::*;

    /// Returns solids with thin triangles, with facets that touch without a common vertex, and with neither.
    fn test_meshes(random: &mut Random) -> Vec<Mesh> {
        let phase = random.range(0.0, 6.0);
        let star = |k: usize, p: DVec3| p * [1.0, 0.3][k % 2];
        let star: Vec<DVec3> = ring(40, 1.0, 0.0).enumerate().map(|(k, p)| star(k, p)).collect();
        let cube = |low: f64, high: f64| slab(DVec3::splat(low), DVec3::splat(high), [2; 3]);
        vec![
            comb(12),
            washer([1.0, 2.0], [0.0, 0.1], 40),
            cone(60, [0.0, 3.0]),
            extruded(&star, [0.0, 0.05]),
            perforated_plate([2, 2], 0.1, 12),
            cube(-1.0, 1.0).joined(&cube(-0.9, 0.9).reversed()),
            // Shells that touch, and shells that overlap.
            cube(0.0, 1.0).joined(&cube(1.0, 2.0)).joined(&cube(0.5, 1.5)),
            bumpy_ball(300).mapped(|p| p * (1.0 + 0.2 * (40.0 * p.x + phase).sin())),
        ]
    }

    #[test]
    fn visited_pairs_include_all_touching_pairs() {
        let mut random = Random::new(21);
        let mut found = 0;
        for _ in 0..3 {
            let turn = random.rotation();
            for mesh in test_meshes(&mut random) {
                for mesh in [mesh.clone(), mesh.mapped(|p| turn * p)] {
                    let solid = Solid::from_mesh(&mesh.vertices, &mesh.faces).expect("a solid");
                    for by in [0.0, 0.02, 0.06, 0.2, -0.1] {
                        found += assert_all_pairs(&solid, by);
                    }
                }
            }
        }
        assert!(found > 1_000, "{found} pairs");
    }

    /// Asserts that visited pairs include all touching pairs, and returns the number of these.
    fn assert_all_pairs(solid: &Solid, by: f64) -> usize {
        let field = &solid.offset_field().displacements;
        let vertices: Vec<DVec3> =
            solid.vertices.iter().zip(field).map(|(v, x)| *v + *x * by).collect();
        let placed = PlacedFacets { solid, vertices: &vertices };
        let mut visited = BTreeSet::new();
        placed.visit_pairs(&mut |[s, t]| {
            assert!(visited.insert([s.min(t), s.max(t)]), "{s} and {t} are visited twice");
        });
        let mut touching = 0;
        for t in 0..solid.triangles.len() {
            for s in (0..t).filter(|&s| placed.have_common_point([s, t])) {
                let known = visited.contains(&[s, t]);
                assert!(known || are_coplanar(&placed, [s, t]), "{s} and {t}, moved by {by}");
                touching += usize::from(known);
            }
        }
        touching
    }

    /// Checks whether two facets lie in one plane within rounding and have the same orientation. Rounding may make
    /// such facets touch.
    fn are_coplanar(placed: &PlacedFacets, pair: [usize; 2]) -> bool {
        let [f, g] = pair.map(|t| placed.facet_corners(t));
        let [m, n] = [f, g].map(|[a, b, c]| (b - a).cross(c - a));
        let near =
            |n: DVec3, p: DVec3, q: DVec3| n.dot(q - p).abs() <= 1e-12 * n.length().max(1e-3);
        m.dot(n) > 0.0
            && (g.iter().all(|q| near(m, f[0], *q)) || f.iter().all(|q| near(n, g[0], *q)))
    }
}
