//! Walls whose two sides pass through each other when facets move.
//!
//! While facets move by more and more, a surface stays the rim of its material until facets touch that
//! were apart. After that some cross, or one shell has passed another one all round: a cavity around
//! what it was a cavity in. Either is looked for where the facets end up, exactly, among facets without a
//! common vertex (others only fold, which turns them) of one shell, or of two of which one is a
//! cavity's: shells around material may overlap, as pieces do. What crosses before anything has moved
//! is left out, pair by pair within a shell, and else shell by shell, for there curves of crossing
//! wander.
//!
//! The sides of a wall face away from each other, so facets of one plane that look the same way are no
//! wall's, whatever rounding does to them. Nodes of such facets are dismissed together: thin triangles
//! of a large face have boxes that overlap by the thousand. The box of a thin triangle also overlaps
//! those of the walls beside it, for example of all teeth of a comb. Therefore the longer of two nodes is
//! opened first, and the triangles themselves are compared with the boxes of much shorter nodes. Nodes
//! whose facets all have a vertex in common, as in a fan, are dismissed, because such facets only fold.

use std::cmp::Ordering;
use std::collections::BTreeSet;

use glam::DVec3;

use super::exact::side;
use super::{Solid, shells};
use colltrans_convex::body::Aabb;
use colltrans_kernel::work;

mod fences;

use fences::Fences;

/// The facets, as positions in the triangles, that pass through others when vertices go from where
/// they are to `moved`, in increasing order. `shell_of` and `volumes` tell the shells as they are.
pub(super) fn facets(
    solid: &Solid,
    moved: &[DVec3],
    shell_of: &[u32],
    volumes: &[f64],
) -> Vec<usize> {
    let shells = Shells { solid, shell_of, volumes };
    let [before, after] = [&solid.vertices[..], moved].map(|vertices| Placing { solid, vertices });
    let mut crossing: Vec<[usize; 2]> = Vec::new();
    after.each_pair(&mut |pair| {
        if shells.may_pass(pair) && after.touch(pair) {
            crossing.push(pair);
        }
    });
    let mut wandering = BTreeSet::new();
    if crossing.iter().any(|&pair| !shells.is_one(pair)) {
        before.each_pair(&mut |pair| {
            if !shells.is_one(pair) && shells.may_pass(pair) && before.cross(pair) {
                wandering.insert(shells.of(pair));
            }
        });
    }
    crossing.retain(|&pair| {
        if shells.is_one(pair) {
            !before.touch(pair)
        } else {
            !wandering.contains(&shells.of(pair))
        }
    });
    let mut found = crossing.into_flattened();
    found.extend(shells.swallowed(&before, &after));
    found.sort_unstable();
    found.dedup();
    found
}

/// Which facets belong together.
struct Shells<'a> {
    solid: &'a Solid,
    shell_of: &'a [u32],
    volumes: &'a [f64],
}

impl Shells<'_> {
    fn of(&self, pair: [usize; 2]) -> [u32; 2] {
        let [a, b] = pair.map(|t| self.shell_of[t]);
        [a.min(b), a.max(b)]
    }

    fn is_one(&self, pair: [usize; 2]) -> bool {
        let [a, b] = self.of(pair);
        a == b
    }

    fn is_cavity(&self, shell: u32) -> bool {
        self.solid.is_shell_closed(shell) && self.volumes[shell as usize] < 0.0
    }

    fn may_pass(&self, pair: [usize; 2]) -> bool {
        self.is_one(pair) || self.of(pair).into_iter().any(|shell| self.is_cavity(shell))
    }

    /// The facets of cavities that are now around shells that they were not around, and of those.
    fn swallowed(&self, before: &Placing, after: &Placing) -> Vec<usize> {
        let count = self.volumes.len() as u32;
        let cavities: Vec<u32> = (0..count).filter(|&s| self.is_cavity(s)).collect();
        if cavities.is_empty() {
            return Vec::new();
        }
        let [old, new] = [before, after].map(|placing| self.boxes(placing));
        let within = |boxes: &[Aabb], inner: u32, outer: u32| {
            boxes[outer as usize].holds(&boxes[inner as usize])
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

    fn boxes(&self, placing: &Placing) -> Vec<Aabb> {
        let mut boxes = vec![Aabb::EMPTY; self.volumes.len()];
        for (t, &shell) in self.shell_of.iter().enumerate() {
            placing.corners(t).into_iter().for_each(|p| boxes[shell as usize].add(p));
        }
        boxes
    }

    /// Whether a corner of one shell is inside another one.
    fn is_inside(&self, placing: &Placing, inner: u32, outer: u32) -> bool {
        let of = |shell| (0..self.shell_of.len()).filter(move |&t| self.shell_of[t] == shell);
        let Some(first) = of(inner).next() else { return false };
        let [point, ..] = placing.corners(first);
        of(outer).map(|t| shells::crossing(point, placing.corners(t))).sum::<i32>() != 0
    }
}

/// The facets with their vertices in some places.
struct Placing<'a> {
    solid: &'a Solid,
    vertices: &'a [DVec3],
}

impl Placing<'_> {
    fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.solid.triangles[triangle].map(|v| self.vertices[v as usize])
    }

    /// Visits all pairs of facets, except those whose nodes [`Fences`] separate.
    fn each_pair(&self, visit: &mut impl FnMut([usize; 2])) {
        let fences = Fences::new(self);
        let mut stack = vec![[0, 0]];
        while let Some([a, b]) = stack.pop() {
            work::count(1);
            if fences.separate(a, b) {
                continue;
            }
            let [m, n] = [a, b].map(|k| &self.solid.nodes[k]);
            let halves = |k: usize| [0, 1].map(|n| k + self.solid.nodes[k].skip as usize + n);
            if m.is_leaf() && n.is_leaf() {
                work::count(m.facets().len() * n.facets().len());
                for s in m.facets() {
                    n.facets().filter(|&t| a != b || s < t).for_each(|t| visit([s, t]));
                }
            } else if a == b {
                let [x, y] = halves(a);
                stack.extend([[x, x], [y, y], [x, y]]);
            } else if n.is_leaf() || (!m.is_leaf() && fences.length(a) >= fences.length(b)) {
                stack.extend(halves(a).map(|x| [x, b]));
            } else {
                stack.extend(halves(b).map(|y| [a, y]));
            }
        }
    }

    /// Whether two facets without a common vertex have a point in common.
    fn touch(&self, pair: [usize; 2]) -> bool {
        self.meet(pair, |ends, turns| {
            ends[0] != ends[1]
                && !(turns.contains(&Ordering::Less) && turns.contains(&Ordering::Greater))
        })
    }

    /// Whether an edge of one runs through the inside of the other.
    fn cross(&self, pair: [usize; 2]) -> bool {
        self.meet(pair, |ends, turns| {
            ends[0] == ends[1].reverse()
                && ends[0] != Ordering::Equal
                && turns[0] != Ordering::Equal
                && turns.iter().all(|t| *t == turns[0])
        })
    }

    /// Whether of an edge of either facet, and the other facet, this holds: on which sides of its plane
    /// the ends are, and how the edge's line turns around its sides.
    fn meet(
        &self,
        [s, t]: [usize; 2],
        holds: impl Fn([Ordering; 2], [Ordering; 3]) -> bool,
    ) -> bool {
        let [f, g] = [s, t].map(|k| self.solid.triangles[k]);
        if f.iter().any(|v| g.contains(v)) {
            return false;
        }
        let (f, g) = (self.corners(s), self.corners(t));
        if !Aabb::of_points(f).meets(&Aabb::of_points(g)) || are_apart(&f, &g) {
            return false;
        }
        let sides = |f: [DVec3; 3], [a, b, c]: [DVec3; 3]| {
            let sides = f.map(|p| side(a, b, c, p));
            (sides[0] != sides[1] || sides[0] != sides[2]).then_some(sides)
        };
        // Of one plane, or one beside the other's.
        let (Some(of_f), Some(of_g)) = (sides(f, g), sides(g, f)) else { return false };
        let pierces = |f: [DVec3; 3], sides: [Ordering; 3], [a, b, c]: [DVec3; 3]| {
            (0..3).any(|k| {
                let (p, q) = (f[k], f[(k + 1) % 3]);
                let ends = [sides[k], sides[(k + 1) % 3]];
                ends[0] != ends[1]
                    && holds(ends, [(a, b), (b, c), (c, a)].map(|(u, v)| side(p, q, u, v)))
            })
        };
        pierces(f, of_f, g) || pierces(g, of_g, f)
    }
}

/// Whether one of the planes of the sides of two facets, upright on them, has the facets on different sides for certain.
/// Any vector may say so; products with it are off by less than `4 u` of its sum norm times the largest coordinate.
fn are_apart(f: &[DVec3; 3], g: &[DVec3; 3]) -> bool {
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

    /// Solids of thin triangles, of facets that touch without a common vertex, and of none of these.
    fn solids(random: &mut Random) -> Vec<Mesh> {
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
            // Shells that touch, and that overlap.
            cube(0.0, 1.0).joined(&cube(1.0, 2.0)).joined(&cube(0.5, 1.5)),
            bumpy_ball(300).mapped(|p| p * (1.0 + 0.2 * (40.0 * p.x + phase).sin())),
        ]
    }

    #[test]
    fn pairs_that_touch_are_those_of_all_pairs() {
        let mut random = Random::new(21);
        let mut found = 0;
        for _ in 0..3 {
            let turn = random.rotation();
            for mesh in solids(&mut random) {
                for mesh in [mesh.clone(), mesh.mapped(|p| turn * p)] {
                    let solid = Solid::from_mesh(&mesh.vertices, &mesh.faces).expect("a solid");
                    for by in [0.0, 0.02, 0.06, 0.2, -0.1] {
                        found += assert_all_pairs(&solid, by);
                    }
                }
            }
        }
        assert!(found > 2_000, "{found} pairs");
    }

    /// Compares the pairs that touch among those visited with those among all, and returns their number.
    fn assert_all_pairs(solid: &Solid, by: f64) -> usize {
        let field = &solid.shrinking().field;
        let vertices: Vec<DVec3> =
            solid.vertices.iter().zip(field).map(|(v, x)| *v + *x * by).collect();
        let placing = Placing { solid, vertices: &vertices };
        let mut visited = BTreeSet::new();
        placing.each_pair(&mut |[s, t]| {
            assert!(visited.insert([s.min(t), s.max(t)]), "{s} and {t} are visited twice");
        });
        let mut touching = 0;
        for t in 0..solid.triangles.len() {
            for s in (0..t).filter(|&s| placing.touch([s, t])) {
                let known = visited.contains(&[s, t]);
                assert!(known || is_one_plane(&placing, [s, t]), "{s} and {t}, moved by {by}");
                touching += usize::from(known);
            }
        }
        touching
    }

    /// Checks whether two facets lie in one plane to rounding and look the same way. Rounding may let them touch.
    fn is_one_plane(placing: &Placing, pair: [usize; 2]) -> bool {
        let [f, g] = pair.map(|t| placing.corners(t));
        let [m, n] = [f, g].map(|[a, b, c]| (b - a).cross(c - a));
        let near =
            |n: DVec3, p: DVec3, q: DVec3| n.dot(q - p).abs() <= 1e-12 * n.length().max(1e-3);
        m.dot(n) > 0.0
            && (g.iter().all(|q| near(m, f[0], *q)) || f.iter().all(|q| near(n, g[0], *q)))
    }
}
