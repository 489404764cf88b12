//! The facets around a vertex: whether a direction points from the vertex into the material.
//!
//! Notation
//! - `v`: the vertex. `u`: the direction. A facet of the fan spans the cone of `a - v` and `b - v`.
//! - `m`: a point inside a facet of the fan, the *target*.
//!
//! A direction in no closed cone of the fan is inside or outside. The arc from `u` to `m - v` on the sphere
//! arrives at the target's facet from the side on which `u` lies of that facet's plane. Each other facet that
//! the arc crosses changes the side once. All signs are exact. A target is replaced by another one where the
//! arc to it passes through an edge.
//!
//! Each fan is looked at alone. Where two pits of one body meet in a vertex and in nothing else, the vertex blocks
//! what passes from one pit to the other through it.

use std::cmp::Ordering;
use std::cmp::Ordering::{Equal, Greater, Less};

use super::inside::{Mean, WEIGHTS};
use super::scene::{Corner, ExactPoint, Scene, Side};
use crate::body::solid::edges::NONE;

/// A line through a vertex `v`, with a direction `u`.
pub(super) enum Line {
    /// The direction of the query, or its opposite.
    Query { forward: bool },
    /// From one point to another one.
    Through([Corner; 2]),
}

impl Line {
    /// Returns the sign of `det[u, a - v, b - v]`.
    fn turn(
        &self,
        scene: &Scene,
        v: &Corner,
        a: &impl ExactPoint,
        b: &impl ExactPoint,
    ) -> Ordering {
        match self {
            Self::Query { forward: true } => scene.turn(v, a, b),
            Self::Query { forward: false } => scene.turn(v, a, b).reverse(),
            Self::Through([p, q]) => scene.outside(p, q, a, b),
        }
    }

    /// Returns the sign of `det[u, a - v, e]` with `e` the unit vector of an axis of the world.
    fn turn_about(&self, scene: &Scene, v: &Corner, axis: usize, a: &Corner) -> Ordering {
        match self {
            Self::Query { forward: true } => scene.drift(axis, v, a),
            Self::Query { forward: false } => scene.drift(axis, v, a).reverse(),
            Self::Through([p, q]) => scene.turn_about(axis, p, q, a),
        }
    }
}

/// Checks whether a point of the body that is `moving` or not enters the other one in passing a vertex of this
/// triangle along the direction of the query.
pub(super) fn enters(scene: &Scene, moving: bool, triangle: u32, vertex: &Corner) -> bool {
    let line = Line::Query { forward: moving };
    let side = scene.side(!moving);
    Fan::new(scene, side, triangle, vertex).is_some_and(|fan| {
        if side.solid.is_open(triangle as usize) {
            fan.is_passed(&line)
        } else {
            fan.has_inside(&line)
        }
    })
}

/// The facets around a vertex, each by its other two corners.
pub(super) struct Fan<'s, 'a> {
    scene: &'s Scene<'a>,
    vertex: Corner,
    facets: Vec<[Corner; 2]>,
}

impl<'s, 'a> Fan<'s, 'a> {
    /// Finds the facets around a corner of a triangle; `None` unless they close a ring.
    pub(super) fn new(
        scene: &'s Scene<'a>,
        side: &Side,
        triangle: u32,
        vertex: &Corner,
    ) -> Option<Self> {
        let solid = side.solid;
        let number = |t: u32| solid.triangles()[t as usize];
        let v = number(triangle).into_iter().find(|&v| side.vertex(v) == vertex.local)?;
        let (mut facets, mut t) = (Vec::new(), triangle);
        loop {
            let corners = number(t);
            let k = corners.iter().position(|&w| w == v)?;
            facets.push([1, 2].map(|i| side.corner(corners[(k + i) % 3])));
            t = solid.neighbours()[t as usize][k];
            if t == triangle {
                return Some(Self { scene, vertex: *vertex, facets });
            }
            if t == NONE || facets.len() > solid.triangles().len() {
                return None;
            }
        }
    }

    /// Checks whether the direction points into the material that the facets of a closed shell bound.
    pub(super) fn has_inside(&self, line: &Line) -> bool {
        let on_facet = |facet: &[Corner; 2]| self.along(line, facet) == Some(Greater);
        if self.facets.iter().any(on_facet) {
            return false;
        }
        let side = |own: usize, target: &Mean| {
            let [a, b] = &self.facets[own];
            let mut inside = line.turn(self.scene, &self.vertex, a, b) == Less;
            for (_, other) in self.facets.iter().enumerate().filter(|(k, _)| *k != own) {
                inside ^= self.crosses(line, target, other)?;
            }
            Some(inside)
        };
        // Without a target, of a fan in very many folds, the vertex blocks.
        self.first_target(line, side).unwrap_or(true)
    }

    /// Checks whether a point that passes the vertex changes the side of an open shell.
    pub(super) fn is_passed(&self, line: &Line) -> bool {
        if self.facets.iter().any(|facet| self.along(line, facet).is_some()) {
            return false;
        }
        let odd = |_: usize, target: &Mean| {
            let over = |facet: &&[Corner; 2]| self.is_over(line, target, facet);
            Some(self.facets.iter().filter(over).count() % 2 == 1)
        };
        self.first_target(line, odd).unwrap_or(true)
    }

    /// Returns what is answered of the first target for which there is an answer.
    fn first_target(
        &self,
        line: &Line,
        answer: impl Fn(usize, &Mean) -> Option<bool>,
    ) -> Option<bool> {
        let (scene, v) = (self.scene, &self.vertex);
        let upright = |k: &usize| {
            let [a, b] = &self.facets[*k];
            line.turn(scene, v, a, b) == Equal
        };
        (0..self.facets.len()).filter(|k| !upright(k)).find_map(|own| {
            let [a, b] = self.facets[own];
            WEIGHTS[..3].iter().find_map(|&weights| {
                let target = Mean::new(scene, [*v, a, b], weights);
                // An edge opposite to the direction is on no arc.
                let on_line = |c: &Corner| (0..3).all(|k| line.turn_about(scene, v, k, c) == Equal);
                let through_edge = |f: &[Corner; 2]| {
                    line.turn(scene, v, &target, &f[0]) == Equal && !on_line(&f[0])
                };
                if self.facets.iter().any(through_edge) { None } else { answer(own, &target) }
            })
        })
    }

    /// Returns `Greater` if the direction lies in the closed cone of a facet, `Less` if its opposite does.
    fn along(&self, line: &Line, [a, b]: &[Corner; 2]) -> Option<Ordering> {
        let (scene, v) = (self.scene, &self.vertex);
        if line.turn(scene, v, a, b) != Equal {
            return None;
        }
        let area = |axis: &usize| scene.turn_about(*axis, v, a, b) != Equal;
        let axis = (0..3).find(area)?;
        let whole = scene.turn_about(axis, v, a, b);
        // The shares of `a` and `b` in the direction: `det[u, b, e]` and `det[a, u, e]` over the whole.
        let of_a = line.turn_about(scene, v, axis, b);
        let of_b = line.turn_about(scene, v, axis, a).reverse();
        let signed = |way: Ordering| [of_a, of_b].iter().all(|&s| s == Equal || s == way);
        match (signed(whole), signed(whole.reverse())) {
            (true, false) => Some(Greater),
            (false, true) => Some(Less),
            _ => None,
        }
    }

    /// Checks whether the half-plane of the direction and the target cuts a facet.
    fn is_over(&self, line: &Line, target: &Mean, [a, b]: &[Corner; 2]) -> bool {
        let [of_a, of_b] = [a, b].map(|c| line.turn(self.scene, &self.vertex, target, c));
        of_a != of_b && of_b == line.turn(self.scene, &self.vertex, a, b)
    }

    /// Checks whether the arc from the direction to the target crosses a facet; `None` if the target lies on it.
    fn crosses(&self, line: &Line, target: &Mean, [a, b]: &[Corner; 2]) -> Option<bool> {
        let (scene, v) = (self.scene, &self.vertex);
        let [of_a, of_b] = [a, b].map(|c| line.turn(scene, v, target, c));
        let start = line.turn(scene, v, a, b);
        // An arc that begins in the plane of a facet, and not on the facet, does not cross it.
        if of_a == of_b || start == Equal {
            return Some(false);
        }
        let end = scene.outside(v, a, b, target);
        if end == Equal {
            let area = |axis: &usize| scene.turn_about(*axis, v, a, b) != Equal;
            let axis = (0..3).find(area)?;
            let whole = scene.turn_about(axis, v, a, b);
            let holds = scene.turn_about(axis, v, a, target) == whole
                && scene.turn_about(axis, v, target, b) == whole;
            return (!holds).then_some(false);
        }
        Some(start == end.reverse() && of_b == start)
    }
}
