//! Free arcs and single free directions that border no region of free or undecided directions. All decisions
//! are exact.
//!
//! The remainder of a cell has pieces with two corners and with one. On the great circle of each arc, the
//! ends of all arcs and of the regions' sides are sorted. Each stretch between two neighbours is free or not
//! as a whole. This joins arcs that cells have divided. A single direction is reported if no other piece
//! contains it. Undecided pieces count as regions.
//!
//! A direction on a circle with the form `n` is `n x m`, where `m` is the form of a transversal line. Then
//! `det[n, e, f]`, which is positive if `f` is within half a turn after `e`, equals `-|n|^2 m.f`: the side of
//! one line. Each line is identified by the vertices that span it, and by a pair of facets with the direction
//! on the boundary of its cone.

use std::cmp::Ordering;
use std::cmp::Ordering::{Equal, Greater, Less};

use glam::DVec3;

use super::bodies::Bodies;
use super::cell::Cell;
use super::cone::Cone;
use super::line::{Line, PlaneVertex, Ray, orientation};
use super::proof::CellState;
use super::remainder::{Outline, OutlineCorner};
use super::verify::remainder_of;

/// Enlargement of boxes of directions, because corners are rounded.
const BOX_SLACK: f64 = 1e-9;

/// Maximum number of pairs of pieces that are compared. For more pairs no arcs or points are reported.
const MAX_COMPARISONS: usize = 20_000_000;

/// Plane of directions that bounds the cone of a pair of facets.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FreePlane {
    /// Normal of the plane. For a plane of facets it is rounded and has length 1, otherwise it is exact.
    pub normal: DVec3,
    /// Facets and vertices that define the plane; `None` for the boundary of an undecided cell.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub of: Option<PlaneFacets>,
}

/// Definition of a plane of directions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PlaneFacets {
    /// Indices into [`Solid::triangles`](colltrans_solid::Solid::triangles) of the moving and the fixed body.
    pub triangles: [u32; 2],
    /// Vertices `a, b, c` of these triangles, in their placed positions. Both bodies are offset inwards by
    /// half the tolerance. `(b - a) x (c - a)` is exactly parallel to the normal.
    pub vertices: [PlaneVertex; 3],
}

/// Isolated free direction, or an end of an arc of free directions.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FreePoint {
    /// The direction, with a largest component of 1 or -1. Because it is rounded, the stored direction may
    /// lie slightly outside the free set and be blocked.
    pub direction: DVec3,
    /// The exact direction is the cross product of the normals of these planes.
    pub planes: [FreePlane; 2],
}

/// Arc of free directions that no region borders.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FreeArc {
    /// Plane of the arc, which runs counterclockwise around the normal.
    pub plane: FreePlane,
    /// Start and end. Each lies in this plane and in another one. `None` for a whole circle.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub ends: Option<[FreePoint; 2]>,
    /// Directions on the arc in order, from end to end. Each is less than half a turn after the previous one.
    /// They are rounded like [`FreePoint::direction`], so they may be blocked. For a whole circle the first
    /// direction is repeated at the end.
    pub along: Vec<DVec3>,
}

/// All arcs and isolated directions.
#[derive(Debug, Default)]
pub(super) struct LowerDimensional {
    pub(super) arcs: Vec<FreeArc>,
    pub(super) points: Vec<FreePoint>,
    /// Corners of arcs and points that border undecided directions. If there are too many pieces to compare,
    /// one corner of every free arc and point.
    pub(super) unclear: Vec<DVec3>,
}

/// Piece of the remainder of a cell.
struct SpherePiece {
    corners: Vec<OutlineCorner>,
    /// Lines, each with the side on which the piece lies. Together they define the piece.
    sides: Vec<(Line, Ordering)>,
    /// Line from each corner to the next one.
    edges: Vec<Line>,
    /// Box around the corners, slightly enlarged.
    around: [DVec3; 2],
    known: bool,
}

impl SpherePiece {
    fn new(bodies: &Bodies, outline: Outline, known: bool) -> Self {
        let Outline { corners, edges } = outline;
        let side_of = |line: &Line| {
            let sides = corners.iter().map(|corner| line.side_of_ray(bodies, &corner.ray));
            sides.into_iter().find(|side| *side != Equal).unwrap_or(Equal)
        };
        let lines = match corners.len() {
            1 => corners[0].lines.to_vec(),
            2 => {
                let own = |corner: &OutlineCorner| corner.lines.into_iter();
                let across = corners.iter().flat_map(own).filter(|line| side_of(line) != Equal);
                across.chain([edges[0]]).collect()
            }
            _ => edges.clone(),
        };
        let sides = lines.into_iter().map(|line| (line, side_of(&line))).collect();
        let around = bounding_box(corners.iter().map(|corner| corner.direction));
        Self { corners, sides, edges, around, known }
    }

    fn is_point(&self) -> bool {
        self.known && self.corners.len() == 1
    }

    fn is_arc(&self) -> bool {
        self.known && self.corners.len() == 2
    }

    fn contains_direction(&self, bodies: &Bodies, at: &OutlineCorner) -> bool {
        let within = |(line, side): &(Line, Ordering)| {
            let found = line.side_of_ray(bodies, &at.ray);
            found == Equal || found == *side
        };
        is_in_box(&self.around, at.direction) && self.sides.iter().all(within)
    }
}

/// Returns a bounding box of directions on the cube, slightly enlarged.
fn bounding_box(directions: impl Iterator<Item = DVec3>) -> [DVec3; 2] {
    let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let [low, high] = directions.fold(none, |[low, high], d| [low.min(d), high.max(d)]);
    [low - BOX_SLACK, high + BOX_SLACK]
}

fn is_in_box([low, high]: &[DVec3; 2], d: DVec3) -> bool {
    low.cmple(d).all() && high.cmpge(d).all()
}

/// Direction on a circle: the cross product of the form of the circle and that of the line `across`.
#[derive(Clone, Copy)]
struct CircleMark {
    at: OutlineCorner,
    across: Line,
}

/// Cell that is not blocked, and the pairs that block some of its directions.
struct CellBounds<'f> {
    bounds: [DVec3; 2],
    pairs: &'f [[u32; 2]],
}

struct LowerDimensionalSearch<'s, 'a> {
    bodies: &'s Bodies<'a>,
    cells: Vec<CellBounds<'s>>,
    pieces: Vec<SpherePiece>,
}

/// Finds the arcs and points of all cells.
pub(super) fn find_lower_dimensional<'s>(
    bodies: &'s Bodies<'_>,
    leaves: impl Iterator<Item = (Cell, &'s CellState)>,
) -> LowerDimensional {
    let (mut cells, mut rests) = (Vec::new(), Vec::new());
    for (cell, state) in leaves {
        let (CellState::Open(pairs) | CellState::Undecided(pairs)) = state else { continue };
        let Ok(remainder) = remainder_of(bodies, cell, pairs) else { continue };
        cells
            .push(CellBounds { bounds: bounding_box(cell.corner_directions().into_iter()), pairs });
        rests.push((remainder, matches!(state, CellState::Open(_))));
    }
    if rests.iter().all(|(remainder, known)| {
        !known || remainder.pieces.iter().all(super::remainder::Piece::is_region)
    }) {
        return LowerDimensional::default();
    }
    let of_rest = |(remainder, known): &(super::remainder::Remainder, bool)| -> Vec<SpherePiece> {
        remainder
            .pieces
            .iter()
            .map(|piece| SpherePiece::new(bodies, remainder.outline(piece), *known))
            .collect()
    };
    let pieces = rests.iter().flat_map(of_rest).collect();
    let search = LowerDimensionalSearch { bodies, cells, pieces };
    let mut lower_dimensional = LowerDimensional::default();
    let some = search.pieces.iter().filter(|part| part.is_point() || part.is_arc());
    if some.clone().count() * search.pieces.len() > MAX_COMPARISONS {
        lower_dimensional.unclear.extend(some.map(|part| part.corners[0].direction));
        return lower_dimensional;
    }
    search.find_arcs(&mut lower_dimensional);
    search.find_points(&mut lower_dimensional);
    lower_dimensional
}

impl LowerDimensionalSearch<'_, '_> {
    fn find_points(&self, lower_dimensional: &mut LowerDimensional) {
        let mut found: Vec<&SpherePiece> = Vec::new();
        for part in self.pieces.iter().filter(|part| part.is_point()) {
            let at = &part.corners[0];
            if found.iter().any(|other| other.contains_direction(self.bodies, at)) {
                continue;
            }
            found.push(part);
            let mut others = self.pieces.iter().filter(|other| !other.is_point());
            match others.find(|other| other.contains_direction(self.bodies, at)) {
                None => lower_dimensional.points.extend(self.build_point(at)),
                Some(other) if !other.known => lower_dimensional.unclear.push(at.direction),
                Some(_) => (),
            }
        }
    }

    /// Builds an isolated direction from two planes through it. Returns `None` if two such planes are not
    /// found.
    fn build_point(&self, at: &OutlineCorner) -> Option<FreePoint> {
        let mut planes = self.lines_through(at).into_iter();
        let (first, triangles) = planes.next()?;
        let (second, others) =
            planes.find(|(line, _)| !line.is_same_circle(self.bodies, &first))?;
        let second = oriented_line(self.bodies, &first, &second, at)?;
        Some(FreePoint {
            direction: at.direction,
            planes: [
                FreePlane::from_line(&first, triangles),
                FreePlane::from_line(&second, others),
            ],
        })
    }

    /// Returns the sides of cones that pass through a direction, each with its pair of facets. Only pairs of
    /// cells whose bounding box contains the direction are used. Sides of cones with the direction on their
    /// boundary come first.
    fn lines_through(&self, at: &OutlineCorner) -> Vec<(Line, [u32; 2])> {
        let (mut touching, mut others) = (Vec::new(), Vec::new());
        let cells = self.cells.iter().filter(|cell| is_in_box(&cell.bounds, at.direction));
        for pair in cells.flat_map(|cell| cell.pairs) {
            let cone = Cone::new(self.bodies, *pair);
            let sides = cone.lines.iter().map(|line| line.side_of_ray(self.bodies, &at.ray));
            let sides: Vec<Ordering> = sides.collect();
            let found = if sides.contains(&Less) { &mut others } else { &mut touching };
            let through = cone.lines.iter().zip(&sides).filter(|(_, side)| **side == Equal);
            found.extend(through.map(|(line, _)| (*line, *pair)));
        }
        touching.extend(others);
        touching
    }

    fn find_arcs(&self, lower_dimensional: &mut LowerDimensional) {
        let mut todo: Vec<&SpherePiece> = self.pieces.iter().filter(|part| part.is_arc()).collect();
        while let Some(first) = todo.first() {
            let circle = first.edges[0];
            let (own, others): (Vec<_>, Vec<_>) =
                todo.iter().partition(|part| self.are_on_circle(&circle, &part.corners));
            // The first arc is on its own circle. In any case at least one arc is removed.
            todo = if own.is_empty() { todo[1..].to_vec() } else { others };
            self.find_arcs_on(&circle, &own, lower_dimensional);
        }
    }

    fn are_on_circle(&self, circle: &Line, corners: &[OutlineCorner]) -> bool {
        corners.iter().all(|corner| circle.side_of_ray(self.bodies, &corner.ray) == Equal)
    }

    /// Finds the arcs on one circle.
    fn find_arcs_on(
        &self,
        circle: &Line,
        own: &[&SpherePiece],
        lower_dimensional: &mut LowerDimensional,
    ) {
        let span = |a: &OutlineCorner, b: &OutlineCorner| {
            let [a, b] = [self.mark_at(circle, a)?, self.mark_at(circle, b)?];
            Some(if self.order_around(&a, &b) == Less { [b, a] } else { [a, b] })
        };
        let arcs: Vec<[CircleMark; 2]> =
            own.iter().filter_map(|part| span(&part.corners[0], &part.corners[1])).collect();
        let mut taken: Vec<([CircleMark; 2], bool)> = Vec::new();
        for part in self.pieces.iter().filter(|part| !part.is_arc() && !part.is_point()) {
            let corners = &part.corners;
            for (k, a) in corners.iter().enumerate() {
                let b = &corners[(k + 1) % corners.len()];
                let near = |at: &OutlineCorner| {
                    own.iter().any(|arc| {
                        boxes_overlap(
                            &arc.around,
                            &bounding_box([at.direction, b.direction].into_iter()),
                        )
                    })
                };
                if corners.len() > 1 && near(a) && self.are_on_circle(circle, &[*a, *b]) {
                    taken.extend(span(a, b).map(|span| (span, part.known)));
                }
            }
        }
        let marks = self.sorted_marks(
            arcs.iter().chain(taken.iter().map(|(span, _)| span)).flatten().copied().collect(),
        );
        let number = |mark: &CircleMark| marks.iter().position(|other| self.is_same(mark, other));
        let count = marks.len();
        let between = |[from, to]: &[CircleMark; 2]| -> Vec<usize> {
            let (Some(from), Some(to)) = (number(from), number(to)) else { return Vec::new() };
            (0..(to + count - from) % count).map(|k| (from + k) % count).collect()
        };
        let mut alone = vec![false; count];
        for k in arcs.iter().flat_map(between) {
            alone[k] = true;
        }
        for (span, known) in &taken {
            for k in between(span) {
                if alone[k] && !known {
                    lower_dimensional.unclear.push(marks[k].at.direction);
                }
                alone[k] = false;
            }
        }
        let starts: Vec<usize> =
            (0..count).filter(|&k| alone[k] && !alone[(k + count - 1) % count]).collect();
        if starts.is_empty() && alone.contains(&true) {
            lower_dimensional.arcs.extend(self.build_arc(circle, &marks, 0, count));
        }
        for start in starts {
            let length = (0..count).take_while(|k| alone[(start + k) % count]).count();
            lower_dimensional.arcs.extend(self.build_arc(circle, &marks, start, length));
        }
    }

    /// Builds the arc of `length` consecutive stretches between marks.
    fn build_arc(
        &self,
        circle: &Line,
        marks: &[CircleMark],
        start: usize,
        length: usize,
    ) -> Option<FreeArc> {
        let mark = |k: usize| &marks[(start + k) % marks.len()];
        let own = self.lines_through(&mark(0).at);
        let (line, triangles) =
            own.into_iter().find(|(line, _)| line.is_same_circle(self.bodies, circle))?;
        let line = if line.form.dot(circle.form) < 0.0 { line.reversed() } else { line };
        let plane = FreePlane::from_line(&line, triangles);
        let end = |mark: &CircleMark| FreePoint {
            direction: mark.at.direction,
            planes: [plane, self.plane_across(circle, mark)],
        };
        let ends = (length < marks.len()).then(|| [end(mark(0)), end(mark(length))]);
        Some(FreeArc { plane, ends, along: (0..=length).map(|k| mark(k).at.direction).collect() })
    }

    /// Returns the plane that crosses a circle at an end.
    fn plane_across(&self, circle: &Line, mark: &CircleMark) -> FreePlane {
        let lines = self.lines_through(&mark.at).into_iter();
        let mut others = lines.filter(|(line, _)| !line.is_same_circle(self.bodies, circle));
        let found = others.find_map(|(line, triangles)| {
            Some(FreePlane::from_line(
                &oriented_line(self.bodies, circle, &line, &mark.at)?,
                triangles,
            ))
        });
        found.unwrap_or(FreePlane { normal: mark.across.form + 0.0, of: None })
    }

    fn mark_at(&self, circle: &Line, at: &OutlineCorner) -> Option<CircleMark> {
        let across = at.lines.iter().find(|line| !line.is_same_circle(self.bodies, circle))?;
        Some(CircleMark { at: *at, across: oriented_line(self.bodies, circle, across, at)? })
    }

    /// Returns `Greater` if mark `b` is within half a turn after mark `a`, and `Less` if it is within half a
    /// turn before it.
    fn order_around(&self, a: &CircleMark, b: &CircleMark) -> Ordering {
        a.across.side_of_ray(self.bodies, &b.at.ray).reverse()
    }

    fn is_same(&self, a: &CircleMark, b: &CircleMark) -> bool {
        self.order_around(a, b) == Equal && a.at.direction.dot(b.at.direction) > 0.0
    }

    /// Sorts marks around a circle, starting with the first one, and removes duplicates.
    fn sorted_marks(&self, mut marks: Vec<CircleMark>) -> Vec<CircleMark> {
        let Some(&first) = marks.first() else { return marks };
        let is_late = |mark: &CircleMark| match self.order_around(&first, mark) {
            Greater => false,
            Less => true,
            Equal => !self.is_same(&first, mark),
        };
        marks.sort_by(|a, b| {
            is_late(a).cmp(&is_late(b)).then_with(|| self.order_around(a, b).reverse())
        });
        marks.dedup_by(|a, b| self.is_same(a, b));
        marks
    }
}

fn boxes_overlap([a, b]: &[DVec3; 2], [c, d]: &[DVec3; 2]) -> bool {
    a.cmple(*d).all() && c.cmple(*b).all()
}

/// Returns a line, possibly reversed, so that the cross product of the circle's form and its own form has the
/// given direction. Returns `None` if the sign of the product is zero or cannot be computed.
fn oriented_line(
    bodies: &Bodies,
    circle: &Line,
    across: &Line,
    at: &OutlineCorner,
) -> Option<Line> {
    let main = at.direction.abs().max_position();
    let axis = Line::from_exact_form(DVec3::AXES[main] * at.direction[main].signum());
    match orientation(bodies, [circle, across, &axis])? {
        Greater => Some(*across),
        Less => Some(across.reversed()),
        Equal => None,
    }
}

impl FreePlane {
    fn from_line(line: &Line, triangles: [u32; 2]) -> Self {
        match line.spanning_vertices() {
            Some(vertices) => Self {
                normal: line.form.normalize() + 0.0,
                of: Some(PlaneFacets { triangles, vertices }),
            },
            None => Self { normal: line.form + 0.0, of: None },
        }
    }

    /// Returns the line of the plane. Returns `None` if a vertex does not exist or the normal is not finite.
    fn exact_line(&self, bodies: &Bodies) -> Option<Line> {
        let Some(PlaneFacets { vertices, .. }) = self.of else {
            return Some(Line::from_exact_form(self.normal)).filter(|_| self.normal.is_finite());
        };
        let exists = |vertex: &PlaneVertex| bodies.has_vertex(*vertex);
        vertices.iter().all(exists).then(|| Line::through(bodies, vertices))
    }
}

impl FreePoint {
    /// Checks exactly whether a direction is this one.
    pub(super) fn has_direction(&self, bodies: &Bodies, d: DVec3) -> bool {
        let on = |plane: &FreePlane| {
            plane.exact_line(bodies).is_some_and(|line| line.side_of_direction(bodies, d) == Equal)
        };
        self.direction.dot(d) > 0.0 && self.planes.iter().all(on)
    }
}

impl FreeArc {
    /// Checks exactly whether a direction is on the arc.
    pub(super) fn has_direction(&self, bodies: &Bodies, d: DVec3) -> bool {
        let Some(circle) = self.plane.exact_line(bodies) else { return false };
        if circle.side_of_direction(bodies, d) != Equal {
            return false;
        }
        let Some(ends) = &self.ends else { return true };
        let [Some(from), Some(to)] = ends.map(|end| end.planes[1].exact_line(bodies)) else {
            return false;
        };
        let (behind, before) =
            (from.side_of_direction(bodies, d) != Greater, to.side_of_direction(bodies, d) != Less);
        let is_long = from.side_of_ray(bodies, &Ray::Crossing([circle, to])) == Greater;
        if is_long { behind || before } else { behind && before }
    }
}
