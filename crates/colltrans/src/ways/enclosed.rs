//! That there is no way out by translations: cells of displacements that wall a body in, and their check.
//!
//! Cells are *room*, of which nothing is known, or *wall*, in all of which the bodies overlap. The place where the
//! body is lies in a room; beside each room, on each side, there are rooms or walls all over; no room is at the border
//! of all cells. A way out would have to leave the rooms, through a point that is on the border of one and in a wall.
//!
//! The search begins with one cell. As long as rooms lead from the body's place to the border of all cells, the
//! largest ones on the way in which surfaces may meet are cut in eight. Is there none, the way is one through space
//! that is wide: a proposal of legs, which casts have to prove.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap, HashSet, VecDeque};
use std::sync::atomic::{AtomicBool, Ordering};

use glam::DVec3;

use super::cells::{Crossing, DEEPEST, Displaced, Room, RoomCell, SIDES, Side};
use super::pairs::standing;
use crate::answer::CertificateError;
use crate::body::Placed;
use crate::body::solid::{AsSolid, Solid};
use crate::free::{Bodies, FreeError};
use crate::setting::error::QueryError;

/// Crossings that are tried first in a new cell, at most.
const MOST_SEEN: usize = 48;
/// Pairs of nodes looked at for one cell, at most.
const MOST_LOOKS: usize = 4_000;
/// Pairs of facets tried for one cell, at most.
const MOST_TRIED: usize = 400;

/// A proof that translations do not take one body out of another: [`verify`](Self::verify).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct NoWay {
    /// The tolerance: both bodies are shrunk by half of it.
    pub tolerance: f64,
    /// Where cells are: displacements of the moving body.
    pub room: Room,
    /// Where it may be.
    pub rooms: Vec<RoomCell>,
    /// Where it overlaps the other one, all over each cell, and what proves that.
    pub walls: Vec<(RoomCell, Crossing)>,
}

impl NoWay {
    /// How many cells prove it.
    pub fn cells(&self) -> usize {
        self.rooms.len() + self.walls.len()
    }

    /// Checks it against the bodies, placed as they were asked about; no search plays a part.
    ///
    /// # Errors
    /// What is not proven.
    pub fn verify<A: AsSolid, B: AsSolid>(
        &self,
        moving: &Placed<'_, A>,
        fixed: &Placed<'_, B>,
    ) -> Result<(), FreeError> {
        let a = moving.body.as_solid().map_err(QueryError::from)?.at(moving.pose);
        let b = fixed.body.as_solid().map_err(QueryError::from)?.at(fixed.pose);
        let Room { low, side } = self.room;
        let refused = |entry: usize| Err(CertificateError::Cover { entry }.into());
        let all = || self.rooms.iter().chain(self.walls.iter().map(|wall| &wall.0));
        let proper =
            |cell: &RoomCell| cell.depth <= DEEPEST && cell.at.iter().all(|&x| x < 1 << cell.depth);
        if !(low.is_finite() && side.is_finite() && side > 0.0 && all().all(proper)) {
            return refused(0);
        }
        let bodies = bodies([a, b], self.tolerance)?;
        let displaced = Displaced::new(&bodies, self.room);
        let home = self.rooms.iter().any(|&cell| {
            let [low, high] = self.room.corners(cell);
            low.cmplt(DVec3::ZERO).all() && high.cmpgt(DVec3::ZERO).all()
        });
        if !home {
            return refused(0);
        }
        for (k, &(cell, crossing)) in self.walls.iter().enumerate() {
            if !displaced.blocks(crossing, self.room.corners(cell)) {
                return refused(self.rooms.len() + k);
            }
        }
        let known: HashSet<RoomCell> = all().copied().collect();
        for (k, &cell) in self.rooms.iter().enumerate() {
            for (axis, upper) in SIDES {
                let beside = cell.beside((axis, upper));
                if !beside.is_some_and(|beside| is_covered(&known, beside, (axis, !upper))) {
                    return refused(k);
                }
            }
        }
        Ok(())
    }
}

/// Whether known cells are all over a side of a cell, on its inside.
fn is_covered(known: &HashSet<RoomCell>, cell: RoomCell, side: Side) -> bool {
    let above = std::iter::successors(Some(cell), |cell| cell.parent());
    above.into_iter().any(|cell| known.contains(&cell)) || is_covered_below(known, cell, side)
}

fn is_covered_below(known: &HashSet<RoomCell>, cell: RoomCell, side: Side) -> bool {
    known.contains(&cell)
        || cell.depth < DEEPEST
            && cell.parts_at(side).all(|part| is_covered_below(known, part, side))
}

/// Both bodies, shrunk.
fn bodies(placed: [Placed<'_, Solid>; 2], tolerance: f64) -> Result<Bodies<'_>, FreeError> {
    for (which, body) in [("moving", &placed[0]), ("fixed", &placed[1])] {
        if !body.body.is_closed() {
            return Err(FreeError::Open { which });
        }
    }
    Ok(Bodies::new(standing(placed, tolerance)?.asked_of_something()?))
}

/// What is known of a cell.
#[derive(Clone, Copy)]
enum State {
    /// It was cut in eight.
    Cut,
    /// A room; whether surfaces may meet in it.
    Room(bool),
    Wall(Crossing),
}

struct Search<'b, 'a> {
    displaced: Displaced<'b, 'a>,
    room: Room,
    states: HashMap<RoomCell, State>,
    /// What blocked cells before, the last ones first.
    seen: VecDeque<Crossing>,
}

/// What cells of displacements say.
pub(super) enum Cells {
    /// There is no way out.
    Proven(NoWay),
    /// There may be one, from displacement to displacement; the last is beyond everything.
    Way(Vec<DVec3>),
    /// Neither, with so many cells.
    Spent,
}

/// Looks for a proof that one body, of two, does not leave the other by translations, or for a way that is wide.
pub(super) fn enclosed(
    placed: [Placed<'_, Solid>; 2],
    tolerance: f64,
    far: f64,
    most: usize,
    cancel: Option<&AtomicBool>,
) -> Result<Cells, FreeError> {
    let bodies = bodies(placed, tolerance)?;
    let room = Room::around(far);
    let displaced = Displaced::new(&bodies, room);
    let (states, seen) = (HashMap::new(), VecDeque::new());
    let mut search = Search { displaced, room, states, seen };
    search.look(RoomCell::ALL);
    loop {
        if cancel.is_some_and(|flag| flag.load(Ordering::Relaxed)) {
            return Err(FreeError::Cancelled);
        }
        let way = match search.flood() {
            Ok((rooms, walls)) => {
                return Ok(Cells::Proven(NoWay { tolerance, room, rooms, walls }));
            }
            Err(way) => way,
        };
        let may_be_cut = |cell: &&RoomCell| {
            cell.depth < DEEPEST && matches!(search.states[*cell], State::Room(true))
        };
        let cut: Vec<RoomCell> = way.iter().filter(may_be_cut).copied().collect();
        let Some(least) = cut.iter().map(|cell| cell.depth).min() else {
            return Ok(if way.iter().all(|cell| cell.depth < DEEPEST) {
                Cells::Way(search.through(&way))
            } else {
                Cells::Spent
            });
        };
        for cell in cut.into_iter().filter(|cell| cell.depth == least) {
            search.states.insert(cell, State::Cut);
            for part in cell.parts() {
                search.look(part);
            }
        }
        if search.states.len() > most {
            return Ok(Cells::Spent);
        }
    }
}

type Walls = Vec<(RoomCell, Crossing)>;

impl Search<'_, '_> {
    /// All rooms that are reached from the body's place, and the walls around; or rooms from there to the border.
    fn flood(&self) -> Result<(Vec<RoomCell>, Walls), Vec<RoomCell>> {
        let mut home = RoomCell::ALL;
        while let State::Cut = self.states[&home] {
            let inside = |part: &RoomCell| {
                let [low, high] = self.room.corners(*part);
                low.cmple(DVec3::ZERO).all() && high.cmpge(DVec3::ZERO).all()
            };
            home = home.parts().into_iter().find(inside).unwrap_or(home.parts()[0]);
        }
        let mut from = HashMap::from([(home, home)]);
        // Where no surfaces meet first, then large ones: a way that is wide is found before narrow ones are cut. Of equal
        // ones those nearest to the border, that it is soon found.
        let mut queue = BinaryHeap::from([(Reverse((false, 0, 0)), home)]);
        let (mut walls, mut around) = (Vec::new(), HashSet::new());
        let (mut rooms, mut touching) = (Vec::new(), Vec::new());
        while let Some((_, cell)) = queue.pop() {
            rooms.push(cell);
            for (axis, upper) in SIDES {
                let Some(beside) = cell.beside((axis, upper)) else {
                    let back = |cell: &RoomCell| Some(from[cell]).filter(|before| before != cell);
                    let mut way: Vec<_> = std::iter::successors(Some(cell), back).collect();
                    way.reverse();
                    return Err(way);
                };
                touching.clear();
                self.leaves(beside, (axis, !upper), &mut touching);
                for &leaf in &touching {
                    match self.states[&leaf] {
                        State::Wall(crossing) => {
                            if around.insert(leaf) {
                                walls.push((leaf, crossing));
                            }
                        }
                        _ if from.contains_key(&leaf) => (),
                        _ => {
                            from.insert(leaf, cell);
                            let may = matches!(self.states[&leaf], State::Room(true));
                            queue.push((Reverse((may, leaf.depth, leaf.to_border())), leaf));
                        }
                    }
                }
            }
        }
        Ok((rooms, walls))
    }

    /// Displacements from that of now through cells, one after another, and on.
    fn through(&self, way: &[RoomCell]) -> Vec<DVec3> {
        let mut places = vec![DVec3::ZERO];
        for pair in way.windows(2) {
            let [a, b] = [pair[0], pair[1]].map(|cell| self.room.corners(cell));
            // From the middle of one through the middle of what they have in common.
            places.push((a[0] + a[1]) / 2.0);
            places.push((a[0].max(b[0]) + a[1].min(b[1])) / 2.0);
        }
        let [low, high] = self.room.corners(way[way.len() - 1]);
        places.push((low + high) / 2.0);
        places
    }

    /// The cells that are not cut and touch a side of a cell from inside, or the one that holds all of it.
    fn leaves(&self, cell: RoomCell, side: Side, found: &mut Vec<RoomCell>) {
        match self.states.get(&cell) {
            None => found.extend(
                std::iter::successors(cell.parent(), |cell| cell.parent())
                    .find(|cell| self.states.contains_key(cell)),
            ),
            Some(State::Cut) => cell.parts_at(side).for_each(|part| self.leaves(part, side, found)),
            Some(_) => found.push(cell),
        }
    }

    /// Finds out about a new cell.
    fn look(&mut self, cell: RoomCell) {
        let corners = self.room.corners(cell);
        let known = self.seen.iter().position(|&seen| self.displaced.blocks(seen, corners));
        let state = if let Some(k) = known {
            self.seen.swap(0, k);
            State::Wall(self.seen[0])
        } else if let Some(crossing) = self.crossing(corners) {
            self.seen.push_front(crossing);
            self.seen.truncate(MOST_SEEN);
            State::Wall(crossing)
        } else {
            State::Room(self.may_meet(corners))
        };
        self.states.insert(cell, state);
    }

    /// An edge and a facet that block all of a cell.
    fn crossing(&self, corners: [DVec3; 2]) -> Option<Crossing> {
        let mut tried = 0;
        let [low, high] = corners;
        let mut found = None;
        // Their boxes have to meet wherever in the cell the body is.
        let meets = |[a, b]: [&crate::free::View; 2]| {
            (a.low + high).cmple(b.high).all() && (a.high + low).cmpge(b.low).all()
        };
        self.pairs(meets, |triangles| {
            tried += 1;
            found = self.of_facets(triangles, corners);
            found.is_some() || tried >= MOST_TRIED
        });
        found
    }

    /// Whether any facets may meet in a cell.
    fn may_meet(&self, [low, high]: [DVec3; 2]) -> bool {
        let meets = |[a, b]: [&crate::free::View; 2]| {
            (a.low + low).cmple(b.high).all() && (a.high + high).cmpge(b.low).all()
        };
        self.pairs(meets, |_| true)
    }

    /// Hands on pairs of triangles in nodes that meet until it is told to end; whether it was, or there were too many.
    fn pairs(
        &self,
        meets: impl Fn([&crate::free::View; 2]) -> bool,
        mut end: impl FnMut([u32; 2]) -> bool,
    ) -> bool {
        let bodies = self.displaced.bodies;
        let (mut stack, mut looks) = (vec![[0_u32, 0]], 0);
        while let Some(pair) = stack.pop() {
            looks += 1;
            if looks > MOST_LOOKS {
                return true;
            }
            let [a, b] = [0, 1].map(|k| &bodies.views[k][pair[k] as usize]);
            if !meets([a, b]) {
                continue;
            }
            if a.is_facet() && b.is_facet() {
                if end([bodies.triangle(true, pair[0]), bodies.triangle(false, pair[1])]) {
                    return true;
                }
                continue;
            }
            let first = b.is_facet() || (!a.is_facet() && a.size() >= b.size());
            let parts = if first { a.parts() } else { b.parts() };
            stack.extend(parts.map(|k| if first { [k, pair[1]] } else { [pair[0], k] }));
        }
        false
    }

    /// An edge of one of two facets that passes through the other in all of a cell.
    fn of_facets(&self, [a, b]: [u32; 2], corners: [DVec3; 2]) -> Option<Crossing> {
        let both = [(true, a, b), (false, b, a)].into_iter();
        let edges = |(moving, own, facet)| {
            (0..3).map(move |first| Crossing { moving, edge: (own, first), facet })
        };
        both.flat_map(edges).find(|&crossing| self.displaced.blocks(crossing, corners))
    }
}
