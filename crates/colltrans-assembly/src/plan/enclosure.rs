//! Proof that a closed surface of one part encloses another part, so that no motion separates them.
//!
//! The winding number of a closed surface is constant along a path that does not cross the surface, and 0 far away. If
//! it is not 0 at a vertex of another part, this vertex stays enclosed in all motions in which the surfaces of both
//! parts do not cross: translations and turns, also of several parts at the same time. Surfaces are closed shells, with
//! as many half-edges in either direction between any two vertices, so that they need no further check. The
//! vertex is off the surface by more than rounding errors.

use std::collections::{BTreeMap, HashMap};

use colltrans::solid::ray_crossing;
use colltrans::{Aabb, Solid};
use glam::DVec3;
use petgraph::unionfind::UnionFind;

use crate::bodies::Bodies;

/// Maximum number of vertices that are tried for each shell.
const MAX_VERTICES: usize = 16;
/// Minimum distance of the vertex from the surface, as a share of the largest coordinate.
const MARGIN: f64 = 1e-9;

/// Checks whether no motion separates any of these parts from the others: each is connected with all others by pairs of
/// parts of which one encloses the other.
pub(super) fn are_enclosed(bodies: &Bodies, parts: &[usize]) -> bool {
    let mut sets = UnionFind::new(bodies.len());
    for &inner in parts {
        for &outer in parts.iter().filter(|outer| **outer != inner) {
            if !sets.equiv(inner, outer) && is_enclosed_by(bodies, inner, outer) {
                sets.union(inner, outer);
            }
        }
    }
    parts.iter().all(|&part| sets.equiv(part, parts[0]))
}

/// Checks whether a closed surface of the part `outer` encloses the part `inner`, with the bodies of the pair.
fn is_enclosed_by(bodies: &Bodies, inner: usize, outer: usize) -> bool {
    if !bodies.blocks_plainly([inner, outer]) {
        return false;
    }
    let [inner, outer] = bodies.pair_solids([inner, outer]);
    if !inner.is_closed() || !outer.bounds().contains_box(&inner.bounds()) {
        return false;
    }
    let far = outer.bounds().low.abs().max(outer.bounds().high.abs()).max_element();
    let shells = closed_shells(outer);
    let mut vertices =
        inner.triangles().iter().take(MAX_VERTICES).map(|t| inner.vertices()[t[0] as usize]);
    vertices.any(|p| shells.iter().any(|shell| is_inside(p, outer, shell, MARGIN * far)))
}

/// Returns the triangles of each connected closed surface of a solid.
fn closed_shells(solid: &Solid) -> Vec<Vec<usize>> {
    let mut sets = UnionFind::new(solid.vertices().len());
    for &[a, b, c] in solid.triangles() {
        sets.union(a as usize, b as usize);
        sets.union(b as usize, c as usize);
    }
    let mut shells = BTreeMap::<usize, Vec<usize>>::new();
    for (t, [a, ..]) in solid.triangles().iter().enumerate() {
        shells.entry(sets.find(*a as usize)).or_default().push(t);
    }
    let is_closed = |shell: &Vec<usize>| {
        let mut half_edges = HashMap::<[u32; 2], i64>::new();
        for &t in shell {
            let [a, b, c] = solid.triangles()[t];
            for [from, to] in [[a, b], [b, c], [c, a]] {
                let turn = if from < to { 1 } else { -1 };
                *half_edges.entry([from.min(to), from.max(to)]).or_default() += turn;
            }
        }
        shell.iter().all(|&t| !solid.is_open(t)) && half_edges.values().all(|count| *count == 0)
    };
    shells.into_values().filter(is_closed).collect()
}

/// Checks whether a point is enclosed by a closed surface, and farther from it than a margin.
fn is_inside(p: DVec3, solid: &Solid, shell: &[usize], margin: f64) -> bool {
    let corners = |t: &usize| solid.triangles()[*t].map(|v| solid.vertices()[v as usize]);
    let is_clear = |t: &usize| {
        let [a, b, c] = corners(t);
        let near = Aabb::from_points([a, b, c]).expanded(margin);
        let normal = (b - a).cross(c - a);
        !near.contains_box(&Aabb { low: p, high: p })
            || normal.dot(p - a).abs() > margin * normal.length()
    };
    shell.iter().map(|t| ray_crossing(p, corners(t))).sum::<i32>() != 0
        && shell.iter().all(is_clear)
}
