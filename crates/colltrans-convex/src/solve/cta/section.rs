//! The section of a body at one level, walked on the mesh.
//!
//! Each walk has a maximum number of steps: mesh vertices or section edges that it may pass. It starts at a
//! guess. Its result does not depend on the start.

use glam::DVec2;

use super::crossing::{Chain, Crossing, SectionEdge, is_horizontal};
use super::sectioned_body::SectionedBody;
use crate::body::convex::sections::{Turn, next_clockwise, next_counter_clockwise};
use colltrans_kernel::topology::HalfEdge;

/// Number of steps of a walk before its first search in the body's chains, if the body has chains.
pub(super) const STEPS_BEFORE_SEARCH: usize = 2;
/// Number of steps of a walk from one search in the body's chains to the next.
const STEPS_BETWEEN_SEARCHES: usize = 8;

/// Maximum number of edges of a vertex that are compared for the best one if the body has chains.
const MAX_FAN: usize = 16;

/// Maximum number of sides of a face that cells use. Larger faces are replaced by the part between two mesh
/// edges.
pub(super) const MAX_FACE_SIDES: usize = 6;

/// Result of the search for a height on a chain. The edge found is moved in place, because an edge has 144 bytes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Located {
    /// The edge is at this height, or is the first edge of the chain if the height is below the chain.
    AtHeight,
    /// The edge is the topmost one: the chain ends below the height.
    AboveTop,
}

/// The lowest vertex of a section.
#[derive(Debug, Clone, Copy)]
pub(super) struct SectionBottom {
    pub(super) vertex: Crossing,
    /// Directions from the vertex to its neighbours up the left and the right chain.
    pub(super) directions: [DVec2; 2],
}

/// The section of a body at one level.
#[derive(Debug, Clone, Copy)]
pub(super) struct Section<'a> {
    pub(super) side: &'a SectionedBody<'a>,
    pub(super) level: f64,
    /// Maximum number of steps of a walk.
    pub(super) max_steps: usize,
}

impl Section<'_> {
    /// Computes the section vertex on a mesh edge, given by its half-edge upwards.
    fn section_vertex(&self, half_edge: u32) -> Crossing {
        self.side.count_iterations(1);
        let half_edges = self.side.topology.half_edges();
        let HalfEdge { origin, twin, .. } = half_edges[half_edge as usize];
        let vertices = [origin, half_edges[twin as usize].origin];
        let (low, high) = (self.side.level_point(vertices[0]), self.side.level_point(vertices[1]));
        let drift = (high.shadow - low.shadow) * (1.0 / (high.level - low.level));
        Crossing {
            half_edge,
            vertices,
            levels: [low.level, high.level],
            w: low.shadow + drift * (self.level - low.level),
            drift,
        }
    }

    /// Returns the neighbour of `from` in the direction of `chain`: up the section and, past the top, down
    /// again.
    pub(super) fn next_vertex(&self, chain: Chain, from: &Crossing) -> Crossing {
        let topology = self.side.topology;
        let above = |v: u32| self.side.vertex_level(v) > self.level;
        self.section_vertex(match self.side.turn_up_chain(chain) {
            Turn::CounterClockwise => next_counter_clockwise(topology, from.half_edge, above),
            Turn::Clockwise => next_clockwise(topology, from.half_edge, above),
        })
    }

    /// Returns the neighbour of `from` against the direction of `chain`.
    pub(super) fn previous_vertex(&self, chain: Chain, from: &Crossing) -> Crossing {
        self.next_vertex(chain.opposite(), from)
    }

    /// Returns the direction of the polygon edge from `from` to its neighbour in the direction of `chain`, of
    /// any length. Computes it from one more vertex of the face, without the neighbour.
    fn edge_direction(&self, chain: Chain, from: &Crossing) -> DVec2 {
        let topology = self.side.topology;
        let along = match self.side.turn_up_chain(chain) {
            Turn::CounterClockwise => topology.half_edge(from.half_edge).twin,
            Turn::Clockwise => from.half_edge,
        };
        let half_edges = topology.half_edges();
        let face = topology.face_half_edges(half_edges[along as usize].face);
        let after_next =
            if along + 2 < face.end { along + 2 } else { along + 2 - face.len() as u32 };
        let third = self.side.level_point(half_edges[after_next as usize].origin);
        // The component of the vector to the third vertex that keeps the level.
        let base = from.w - from.drift * (self.level - from.levels[0]);
        (third.shadow - base) - from.drift * (third.level - from.levels[0])
    }

    /// Walks along the mesh from the half-edge `from`, which leads upwards, to an edge that crosses the level.
    /// At each vertex takes the edge whose line has the least `score` of its height at the level. `None` after
    /// [`Self::max_steps`], or if rounding hides the way.
    fn walk_to_level(&self, from: u32, score: impl Fn(f64) -> f64) -> Option<u32> {
        let topology = self.side.topology;
        let half_edges = topology.half_edges();
        let mut up = from;
        for step in 0..=self.max_steps {
            let HalfEdge { origin: low, twin, .. } = half_edges[up as usize];
            let high = half_edges[twin as usize].origin;
            let (vertex, sign) = if self.side.vertex_level(high) <= self.level {
                (high, 1.0)
            } else if self.side.vertex_level(low) > self.level {
                (low, -1.0)
            } else {
                return Some(up);
            };
            if let Some(search) = self.side.chain_search(self.level) {
                if let Some(found) = search.crossing_along_faces(up) {
                    return Some(found);
                }
                if step == STEPS_BEFORE_SEARCH
                    || topology.outgoing_half_edges(vertex).len() > MAX_FAN
                {
                    return search.any_crossing_edge(up);
                }
            }
            let h = self.best_edge_toward_level(vertex, sign, &score)?;
            up = if sign > 0.0 { h } else { half_edges[h as usize].twin };
        }
        None
    }

    /// Finds the half-edge from a vertex towards the level whose line has the least `score` there. The level is
    /// above the vertex for a `sign` of 1, below it for -1. `None` if no edge leads towards the level.
    fn best_edge_toward_level(
        &self,
        vertex: u32,
        sign: f64,
        score: impl Fn(f64) -> f64,
    ) -> Option<u32> {
        self.side.count_iterations(1);
        let topology = self.side.topology;
        let start = self.side.level_point(vertex);
        let mut best = f64::INFINITY;
        let mut found = None;
        for (&h, &neighbour) in
            topology.outgoing_half_edges(vertex).iter().zip(topology.neighbours(vertex))
        {
            let end = self.side.level_point(neighbour);
            let rise = end.level - start.level;
            let drift = (end.shadow.x - start.shadow.x) / rise;
            let candidate = score(start.shadow.x + drift * (self.level - start.level));
            let better = sign * rise > 0.0 && (found.is_none() || candidate < best);
            (best, found) = if better { (candidate, Some(h)) } else { (best, found) };
        }
        found
    }

    /// Finds the last vertex in the direction of `chain` for which `holds` is true, by a search in the body's chains.
    /// `holds` must be true for `from` and the vertices after it up to some vertex, and false for all others.
    /// `None` if the body has no chains or the search fails.
    pub(super) fn last_vertex_where(
        &self,
        chain: Chain,
        from: &Crossing,
        mut holds: impl FnMut(&Crossing) -> bool,
    ) -> Option<Crossing> {
        let search = self.side.chain_search(self.level)?;
        let mut last = *from;
        search.last_while(from.half_edge, self.side.turn_up_chain(chain), |up| {
            let crossing = self.section_vertex(up);
            let found = holds(&crossing);
            last = if found { crossing } else { last };
            found
        })?;
        Some(last)
    }

    /// Finds the last vertex in the direction of `chain` from which the section still falls, starting at
    /// `from`, where it falls. `None` as for [`Self::last_vertex_where`].
    fn skip_to_bottom(&self, chain: Chain, from: &Crossing) -> Option<Crossing> {
        self.last_vertex_where(chain, from, |v| {
            v.h() <= from.h() && !chain.is_ascending(self.edge_direction(chain, v))
        })
    }

    /// Finds the last vertex up a chain that is not above height `h` and from which the chain ascends. `None`
    /// as for [`Self::last_vertex_where`].
    fn skip_up_to_height(&self, chain: Chain, from: &Crossing, h: f64) -> Option<Crossing> {
        self.last_vertex_where(chain, from, |v| {
            (from.h()..=h).contains(&v.h()) && chain.is_ascending(self.edge_direction(chain, v))
        })
    }

    /// Finds the last vertex down a chain that is above height `h` and to which the chain ascends. `None` as
    /// for [`Self::last_vertex_where`].
    fn skip_down_to_height(&self, chain: Chain, from: &Crossing, h: f64) -> Option<Crossing> {
        let other = chain.opposite();
        self.last_vertex_where(other, from, |v| {
            let below = -self.edge_direction(other, v);
            v.h() > h && v.h() <= from.h() && chain.is_ascending(below) && !is_horizontal(below)
        })
    }

    /// Finds the lowest vertex, from a half-edge upwards that crosses a level nearby. `None` after
    /// [`Self::max_steps`], or if rounding hides the way.
    pub(super) fn find_bottom(&self, from: u32) -> Option<SectionBottom> {
        let vertex = self.section_vertex(self.walk_to_level(from, |h| h)?);
        let directions =
            [Chain::Left, Chain::Right].map(|chain| self.edge_direction(chain, &vertex));
        let mut bottom = SectionBottom { vertex, directions };
        for step in 0..self.max_steps {
            let [left, right] = bottom.directions;
            let falls = if Chain::Left.is_ascending(left) { Chain::Right } else { Chain::Left };
            if step % STEPS_BETWEEN_SEARCHES == STEPS_BEFORE_SEARCH
                && !falls.is_ascending(bottom.directions[usize::from(falls == Chain::Right)])
                && let Some(vertex) = self.skip_to_bottom(falls, &bottom.vertex)
            {
                let directions =
                    [Chain::Left, Chain::Right].map(|c| self.edge_direction(c, &vertex));
                bottom = SectionBottom { vertex, directions };
                continue;
            }
            if !Chain::Left.is_ascending(left) {
                let vertex = self.next_vertex(Chain::Left, &bottom.vertex);
                let ahead = self.edge_direction(Chain::Left, &vertex);
                bottom = SectionBottom { vertex, directions: [ahead, -left] };
            } else if !Chain::Right.is_ascending(right) {
                let vertex = self.next_vertex(Chain::Right, &bottom.vertex);
                let ahead = self.edge_direction(Chain::Right, &vertex);
                bottom = SectionBottom { vertex, directions: [-right, ahead] };
            } else {
                return Some(bottom);
            }
        }
        None
    }

    /// Returns the end towards `chain` of the lowest edge if this edge is horizontal, else the lowest vertex.
    pub(super) fn bottom_end(&self, bottom: &SectionBottom, chain: Chain) -> Crossing {
        if is_horizontal(bottom.directions[usize::from(chain == Chain::Right)]) {
            self.next_vertex(chain, &bottom.vertex)
        } else {
            bottom.vertex
        }
    }

    /// Finds the edge of a chain at height `h`, or the topmost one, from a half-edge upwards that crosses a level
    /// nearby, and stores it in `edge`. `None` after [`Self::max_steps`], or if rounding hides the way.
    pub(super) fn edge_at_height(
        &self,
        chain: Chain,
        h: f64,
        from: u32,
        edge: &mut SectionEdge,
    ) -> Option<Located> {
        let start = self.section_vertex(self.walk_to_level(from, |height| (height - h).abs())?);
        self.edge_toward_height(chain, start, h, edge);
        if !chain.is_ascending(edge.direction) {
            *edge = self.any_chain_edge(chain, start)?;
        }
        self.walk_to_height(chain, h, edge)
    }

    /// Walks along a chain from one of its edges to the edge at height `h`, or the topmost one. `None` after
    /// [`Self::max_steps`].
    pub(super) fn walk_to_height(
        &self,
        chain: Chain,
        h: f64,
        edge: &mut SectionEdge,
    ) -> Option<Located> {
        for step in 0..self.max_steps {
            if edge.low.h() <= h {
                return self.climb_to_height(chain, edge, h);
            }
            if step % STEPS_BETWEEN_SEARCHES == STEPS_BEFORE_SEARCH
                && let Some(low) = self.skip_down_to_height(chain, &edge.low, h)
            {
                *edge = SectionEdge::new(low, self.next_vertex(chain, &low));
            }
            if !self.move_below(chain, edge) {
                return self.climb_to_height(chain, edge, h);
            }
        }
        None
    }

    /// Walks up a chain to the edge at height `h`, from an edge that is not above this height or is the chain's
    /// first. `None` after [`Self::max_steps`].
    fn climb_to_height(&self, chain: Chain, edge: &mut SectionEdge, h: f64) -> Option<Located> {
        for step in 0..self.max_steps {
            if step % STEPS_BETWEEN_SEARCHES == STEPS_BEFORE_SEARCH
                && let Some(low) = self.skip_up_to_height(chain, &edge.low, h)
            {
                *edge = SectionEdge::new(low, self.next_vertex(chain, &low));
            }
            if edge.high.h() > h && !is_horizontal(edge.direction) {
                return Some(Located::AtHeight);
            }
            if !self.move_above(chain, edge) {
                let reaches = edge.high.h() >= h;
                return Some(if reaches { Located::AtHeight } else { Located::AboveTop });
            }
        }
        None
    }

    /// Stores the section edge at the vertex `start` that leads along `chain` towards height `h` in `edge`. It may lie
    /// past the ends of the chain.
    fn edge_toward_height(&self, chain: Chain, start: Crossing, h: f64, edge: &mut SectionEdge) {
        *edge = if start.h() <= h {
            SectionEdge::new(start, self.next_vertex(chain, &start))
        } else {
            SectionEdge::new(self.previous_vertex(chain, &start), start)
        };
    }

    /// Finds an edge of the chain near the vertex `start`. This vertex is at the top or at the bottom of the chain, or
    /// on the opposite chain. `None` after [`Self::max_steps`].
    fn any_chain_edge(&self, chain: Chain, start: Crossing) -> Option<SectionEdge> {
        // Walks around the bottom and back over the top at once; the shorter way ends first.
        let (mut ahead, mut back) = (start, start);
        for step in 0..self.max_steps {
            if step % STEPS_BETWEEN_SEARCHES == STEPS_BEFORE_SEARCH
                && let Some(last) = self.skip_to_bottom(chain, &ahead)
            {
                // `last` is on the opposite chain; its neighbour is past the bottom.
                ahead = self.next_vertex(chain, &last);
            }
            let below = SectionEdge::new(self.previous_vertex(chain, &back), back);
            if chain.is_ascending(below.direction) {
                return Some(below);
            }
            back = below.low;
            let above = SectionEdge::new(ahead, self.next_vertex(chain, &ahead));
            if chain.is_ascending(above.direction) {
                return Some(above);
            }
            ahead = above.high;
        }
        None
    }

    /// Returns the edge of the section on the face of a half-edge, and its chain. `None` for a face that the level does
    /// not cut, a horizontal edge, or a face with more than [`MAX_FACE_SIDES`] sides if the body has no chains.
    pub(super) fn edge_on_face(&self, half_edge: u32) -> Option<(Chain, SectionEdge)> {
        let [from, to] = self.mesh_edges_on_face(half_edge)?;
        // The face's boundary is traversed counter-clockwise.
        let (from, to) = (self.section_vertex(from), self.section_vertex(to));
        let chain = match self.side.turn_up_chain(Chain::Left) {
            Turn::CounterClockwise => Chain::Left,
            Turn::Clockwise => Chain::Right,
        };
        let ahead = SectionEdge::new(from, to);
        if is_horizontal(ahead.direction) {
            return None;
        }
        Some(if chain.is_ascending(ahead.direction) {
            (chain, ahead)
        } else {
            (chain.opposite(), SectionEdge::new(to, from))
        })
    }

    /// Returns the half-edges upwards of the two mesh edges of a face that cross the level, counter-clockwise. `None` as
    /// [`Self::edge_on_face`].
    fn mesh_edges_on_face(&self, half_edge: u32) -> Option<[u32; 2]> {
        let topology = self.side.topology;
        let face = topology.half_edge(half_edge).face;
        let boundary = topology.face_half_edges(face);
        let above = |v: u32| self.side.vertex_level(v) > self.level;
        if boundary.len() > MAX_FACE_SIDES {
            let [start, end] = [topology.origin(half_edge), topology.target(half_edge)].map(above);
            let up = match (start, end) {
                (false, true) => half_edge,
                (true, false) => topology.half_edge(half_edge).twin,
                _ => self.side.chain_search(self.level)?.crossing_along_faces(half_edge)?,
            };
            let faces = [up, topology.half_edge(up).twin].map(|h| topology.half_edge(h).face);
            return match faces.map(|beside| beside == face) {
                [true, _] => Some([next_clockwise(topology, up, above), up]),
                [_, true] => Some([up, next_counter_clockwise(topology, up, above)]),
                _ => None,
            };
        }
        let (mut from, mut to) = (None, None);
        let mut last = boundary.end - 1;
        for h in boundary {
            match (above(topology.origin(last)), above(topology.origin(h))) {
                (true, false) => from = Some(topology.half_edge(last).twin),
                (false, true) => to = Some(last),
                _ => {}
            }
            last = h;
        }
        Some([from?, to?])
    }

    /// Moves `edge` to the edge above it on its chain. Returns `false` and keeps it at the top of the chain.
    pub(super) fn move_above(&self, chain: Chain, edge: &mut SectionEdge) -> bool {
        let next = self.next_vertex(chain, &edge.high);
        let direction = edge.high.edge_direction_to(&next);
        let rises = chain.is_ascending(direction);
        if rises {
            edge.low = edge.high;
            (edge.high, edge.direction) = (next, direction);
        }
        rises
    }

    /// Moves `edge` to the edge below it on its chain. Returns `false` and keeps it at the bottom of the chain, or if
    /// that edge is horizontal.
    pub(super) fn move_below(&self, chain: Chain, edge: &mut SectionEdge) -> bool {
        let previous = self.previous_vertex(chain, &edge.low);
        let direction = previous.edge_direction_to(&edge.low);
        let rises = chain.is_ascending(direction) && !is_horizontal(direction);
        if rises {
            edge.high = edge.low;
            (edge.low, edge.direction) = (previous, direction);
        }
        rises
    }
}
