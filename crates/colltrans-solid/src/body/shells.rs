//! Connected shells of a surface: their nesting and orientation.
//!
//! - A shell with a negative volume is the wall of a cavity if another shell contains it, else it is inside out.
//! - If all outermost shells are inside out, all shells are reversed, else only the outermost shells that are inside
//!   out.
//! - Containment is decided by a vertex of the shell and a ray along `z` from this vertex, shifted by an
//!   infinitesimal amount, in exact arithmetic.

use std::cmp::Ordering;

use glam::DVec3;

use super::edges::{NO_NEIGHBOUR, shell_numbers};
use super::exact;
use super::openness;
use super::report::{Shell, ShellKind, SolidReport};
use super::validate::Surface;
use colltrans_convex::body::Aabb;

/// Finds the shells, reverses those that are inside out, classifies open shells, and adds all shells to the report.
pub(super) fn orient_shells(surface: &mut Surface, report: &mut SolidReport) {
    let shell_of = shell_numbers(&surface.neighbours);
    let count = shell_of.iter().max().map_or(0, |&s| s as usize + 1);
    let mut shells = describe_shells(surface, &shell_of, count);
    if shells.iter().any(|s| is_closed(s) && s.volume < 0.0) {
        let nesting = Nesting::new(surface, &shell_of, count);
        let closed = |s: &usize| is_closed(&shells[*s]);
        let outermost: Vec<usize> =
            (0..count).filter(closed).filter(|&s| nesting.is_outermost(s)).collect();
        let inverted = |s: usize| shells[s].volume < 0.0;
        let all = outermost.iter().all(|&s| inverted(s));
        let turn: Vec<usize> = if all {
            (0..count).filter(closed).collect()
        } else {
            outermost.into_iter().filter(|&s| inverted(s)).collect()
        };
        for s in turn {
            shells[s].reversed = true;
            shells[s].volume = -shells[s].volume;
        }
        reverse_turned_shells(surface, &shell_of, &shells);
    }
    openness::classify_shells(surface, &shell_of, &mut shells);
    report.shells.extend(shells);
}

fn is_closed(shell: &Shell) -> bool {
    shell.kind == ShellKind::Closed
}

/// Computes triangle count, volume, genus and closedness of each shell.
fn describe_shells(surface: &Surface, shell_of: &[u32], count: usize) -> Vec<Shell> {
    let empty = Shell {
        triangles: 0,
        volume: 0.0,
        holes_through: None,
        reversed: false,
        kind: ShellKind::Closed,
    };
    let mut shells = vec![empty; count];
    let mut origins = vec![None; count];
    // A vertex that several shells share is counted for each of them.
    let mut vertices = vec![0_i64; count];
    let mut seen = vec![NO_NEIGHBOUR; surface.vertices.len()];
    let mut shared = vec![false; count];
    for (t, corners) in surface.triangles.iter().enumerate() {
        let s = shell_of[t] as usize;
        let [a, b, c] = corners.map(|v| surface.vertices[v as usize]);
        let origin = *origins[s].get_or_insert(a);
        shells[s].volume += (a - origin).dot((b - origin).cross(c - origin)) / 6.0;
        shells[s].triangles += 1;
        if surface.neighbours[t].contains(&NO_NEIGHBOUR) {
            shells[s].kind = ShellKind::Sheet;
        }
        for &v in corners {
            let last = std::mem::replace(&mut seen[v as usize], s as u32);
            if last != s as u32 {
                vertices[s] += 1;
                if last != NO_NEIGHBOUR {
                    shared[s] = true;
                    shared[last as usize] = true;
                }
            }
        }
    }
    for (s, shell) in shells.iter_mut().enumerate() {
        // The Euler characteristic `V - E + F`, with three half-edges per facet. It is odd if the shell touches
        // itself in a vertex.
        let doubled = 2 * vertices[s] - shell.triangles as i64;
        let euler = doubled / 2;
        if is_closed(shell) && !shared[s] && doubled % 2 == 0 && euler % 2 == 0 && euler <= 2 {
            shell.holes_through = Some((1 - euler / 2) as u32);
        }
    }
    shells
}

/// Returns the volume of each shell, with the positions of vertices given by `vertex`.
pub(super) fn shell_volumes(
    shell_of: &[u32],
    triangles: &[[u32; 3]],
    vertex: impl Fn(u32) -> DVec3,
) -> Vec<f64> {
    let count = shell_of.iter().max().map_or(0, |&s| s as usize + 1);
    let mut volumes = vec![0.0; count];
    let mut origins = vec![None; count];
    for (corners, &shell) in triangles.iter().zip(shell_of) {
        let [a, b, c] = corners.map(&vertex);
        let origin = *origins[shell as usize].get_or_insert(a);
        volumes[shell as usize] += (a - origin).dot((b - origin).cross(c - origin)) / 6.0;
    }
    volumes
}

/// Reverses the triangles of shells that are marked as turned: corners `a c b`, and neighbours in the corresponding
/// order.
fn reverse_turned_shells(surface: &mut Surface, shell_of: &[u32], shells: &[Shell]) {
    for (t, &s) in shell_of.iter().enumerate() {
        if shells[s as usize].reversed {
            surface.triangles[t].swap(1, 2);
            surface.neighbours[t].swap(0, 2);
        }
    }
}

/// Data for containment tests of shells.
struct Nesting<'a> {
    surface: &'a Surface,
    shell_of: &'a [u32],
    /// The last triangles of each shell, at most [`MAX_TRIED_TRIANGLES`], in decreasing order.
    last: Vec<Vec<usize>>,
    boxes: Vec<Aabb>,
}

/// Maximum number of triangles of a shell that are searched for a vertex on no other shell.
pub(super) const MAX_TRIED_TRIANGLES: usize = 64;

impl<'a> Nesting<'a> {
    fn new(surface: &'a Surface, shell_of: &'a [u32], count: usize) -> Self {
        let mut last = vec![Vec::new(); count];
        let mut boxes = vec![Aabb::EMPTY; count];
        for (t, corners) in surface.triangles.iter().enumerate().rev() {
            let s = shell_of[t] as usize;
            if last[s].len() < MAX_TRIED_TRIANGLES {
                last[s].push(t);
            }
            for &v in corners {
                boxes[s].extend_to(surface.vertices[v as usize]);
            }
        }
        Self { surface, shell_of, last, boxes }
    }

    /// Checks whether no other shell contains this shell. The test uses a vertex that lies on no other shell, if the
    /// search finds one.
    fn is_outermost(&self, shell: usize) -> bool {
        let corners = |t: &usize| self.surface.triangles[*t].into_iter().rev();
        let vertices = self.last[shell].iter().flat_map(corners);
        let mut points = vertices.map(|v| self.surface.vertices[v as usize]).peekable();
        let first = points.peek().copied();
        let decided = points.find_map(|p| self.is_outside_others(shell, p));
        decided.unwrap_or_else(|| first.is_none_or(|p| self.is_outside(shell, p)))
    }

    /// Checks whether a point of a shell is outside all other shells; `None` if it lies on one.
    fn is_outside_others(&self, shell: usize, p: DVec3) -> Option<bool> {
        let corners =
            |t: usize| self.surface.triangles[t].map(|v| self.surface.vertices[v as usize]);
        let is_other = |t: &usize| self.shell_of[*t] as usize != shell;
        let is_on = (0..self.surface.triangles.len())
            .filter(is_other)
            .any(|t| lies_on_triangle(p, corners(t)));
        (!is_on).then(|| self.is_outside(shell, p))
    }

    /// Checks whether the ray from a point of a shell gives winding number 0 for all other shells.
    fn is_outside(&self, shell: usize, p: DVec3) -> bool {
        let boxed = |s: usize| self.boxes[s].contains_box(&Aabb { low: p, high: p });
        let candidates: Vec<bool> = (0..self.boxes.len()).map(|s| s != shell && boxed(s)).collect();
        if !candidates.contains(&true) {
            return true;
        }
        let mut windings = vec![0_i32; self.boxes.len()];
        for (t, corners) in self.surface.triangles.iter().enumerate() {
            let s = self.shell_of[t] as usize;
            if candidates[s] {
                windings[s] += ray_crossing(p, corners.map(|v| self.surface.vertices[v as usize]));
            }
        }
        windings.iter().all(|&w| w == 0)
    }
}

/// Checks whether a point lies on a triangle.
pub(super) fn lies_on_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> bool {
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    if p.cmplt(low).any()
        || p.cmpgt(high).any()
        || exact::sign_of_side(a, b, c, p) != Ordering::Equal
    {
        return false;
    }
    let facing = |axis: &usize| exact::sign_along_axis(a, b, c, *axis) != Ordering::Equal;
    (0..3).find(facing).is_some_and(|axis| {
        let outside = exact::sign_along_axis(a, b, c, axis).reverse();
        [[a, b], [b, c], [c, a]]
            .into_iter()
            .all(|[u, v]| exact::sign_along_axis(u, v, p, axis) != outside)
    })
}

/// Returns 1 if the ray from `p` along `z` leaves through the triangle, -1 if it enters, and 0 if it misses the
/// triangle.
#[inline]
pub fn ray_crossing(p: DVec3, [a, b, c]: [DVec3; 3]) -> i32 {
    let facing = exact::sign_along_axis(a, b, c, 2);
    if facing == Ordering::Equal {
        return 0;
    }
    let edges = [[a, b], [b, c], [c, a]];
    let inside = edges.into_iter().all(|[u, v]| perturbed_turn(u, v, p) == facing);
    if !inside || exact::sign_of_side(a, b, c, p) != facing.reverse() {
        return 0;
    }
    if facing == Ordering::Greater { 1 } else { -1 }
}

/// Returns the side of the line from `u` to `v` on which the point `p + (e, e^2)` lies, seen along `z`, for an
/// infinitesimal `e > 0`.
fn perturbed_turn(u: DVec3, v: DVec3, p: DVec3) -> Ordering {
    let sign = |x: f64| exact::sign_of(x);
    // det[v - u, p - u + (e, e^2)] = det[v - u, p - u] + e^2 (v - u).x - e (v - u).y.
    exact::sign_along_axis(u, v, p, 2).then(sign(u.y - v.y)).then(sign(v.x - u.x))
}
