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
//! of a large face have boxes that overlap by the thousand.

use std::cmp::Ordering;
use std::collections::BTreeSet;

use glam::DVec3;

use super::exact::side;
use super::tree::{self, Node};
use super::{Solid, shells};
use crate::body::Aabb;
use crate::work;

/// Facets within so many roundings of the largest coordinate of a plane lie in it.
const FLAT: f64 = 64.0 * f64::EPSILON;
/// Facets whose normals differ by more than this sine lie in no plane: a first look.
const TURNED: f32 = 0.5;

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

/// What tells of pairs of nodes that no facets of theirs pass through each other.
struct Fences {
    /// Around the facets of each node.
    boxes: Vec<Aabb>,
    /// Of nodes whose facets lie in a plane and look the same way.
    flats: Vec<Option<Flat>>,
}

/// A plane, and the farthest vertices of the facets in it along the axes.
struct Flat {
    normal: DVec3,
    on: DVec3,
    rim: [DVec3; 6],
    /// How far rounding may put points off the plane, and how far more for each unit of distance, by
    /// tilting it.
    tolerance: f64,
    tilt: f64,
}

impl Flat {
    fn new(placing: &Placing, node: &Node, tolerance: f64) -> Option<Self> {
        if node.spread > TURNED {
            return None;
        }
        let corners = || node.facets().flat_map(|t| placing.corners(t));
        let first = corners().next()?;
        let mut rim = [first; 6];
        for p in corners() {
            for k in 0..3 {
                if p[k] < rim[k][k] {
                    rim[k] = p;
                }
                if p[k] > rim[k + 3][k] {
                    rim[k + 3] = p;
                }
            }
        }
        let (mut area, mut longest) = (DVec3::ZERO, 0.0_f64);
        for i in 1..6 {
            for j in 0..i {
                let [u, v] = [rim[i] - rim[0], rim[j] - rim[0]];
                let product = u.cross(v);
                longest = longest.max(u.length()).max(v.length());
                if product.length_squared() > area.length_squared() {
                    area = product;
                }
            }
        }
        let facing = node.facets().map(|t| tree::normal(placing.corners(t)).0).sum::<DVec3>();
        let normal = (area * area.dot(facing).signum()).try_normalize()?;
        let tilt = tolerance * longest / area.length();
        let flat = Self { normal, on: rim[0], rim, tolerance, tilt };
        let alike = |t: usize| tree::normal(placing.corners(t)).0.dot(normal) > 0.0;
        let lies = corners().all(|p| flat.holds(p)) && node.facets().all(alike);
        lies.then_some(flat)
    }

    fn holds(&self, point: DVec3) -> bool {
        let away = point - self.on;
        self.normal.dot(away).abs() <= self.tolerance + self.tilt * away.length()
    }

    /// Whether both lie in one plane and look the same way.
    fn is_one_with(&self, other: &Self) -> bool {
        let holds = |f: &Self, g: &Self| g.rim.iter().all(|p| f.holds(*p));
        self.normal.dot(other.normal) > 0.0 && (holds(self, other) || holds(other, self))
    }
}

impl Fences {
    fn new(placing: &Placing) -> Self {
        let nodes = &placing.solid.nodes;
        let mut boxes = vec![Aabb::EMPTY; nodes.len()];
        // Children come after their node.
        for (k, node) in nodes.iter().enumerate().rev() {
            boxes[k] = if node.is_leaf() {
                Aabb::of_points(node.facets().flat_map(|t| placing.corners(t)))
            } else {
                let [a, b] = [0, 1].map(|n| boxes[k + node.skip as usize + n]);
                a.join(&b)
            };
        }
        let tolerance = FLAT * placing.solid.reach;
        let flats = nodes.iter().map(|node| Flat::new(placing, node, tolerance)).collect();
        Self { boxes, flats }
    }

    fn part(&self, a: usize, b: usize) -> bool {
        let touch = self.boxes[a].meets(&self.boxes[b]);
        let one_plane = match (&self.flats[a], &self.flats[b]) {
            (Some(f), Some(g)) => a == b || f.is_one_with(g),
            _ => false,
        };
        !touch || one_plane
    }
}

impl Placing<'_> {
    fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.solid.triangles[triangle].map(|v| self.vertices[v as usize])
    }

    /// All pairs of facets whose leaves' boxes touch and do not lie in one plane.
    fn each_pair(&self, visit: &mut impl FnMut([usize; 2])) {
        let fences = Fences::new(self);
        let mut stack = vec![[0, 0]];
        while let Some([a, b]) = stack.pop() {
            work::count(1);
            if fences.part(a, b) {
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
            } else if n.is_leaf() || (!m.is_leaf() && m.count >= n.count) {
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
