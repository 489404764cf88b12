//! Judges puzzles (burrs) of unit cubes by trying all moves by whole units.
//!
//! A state is the displacement of each piece; one piece stays. A move translates any set of the others by some
//! units along an axis, until it would collide. The search is breadth-first, so the first move that takes a
//! group beyond the box of the others has the fewest predecessors. Intermediate positions need no check,
//! because a cube that moves by one unit occupies only its first and its last cell.

use std::collections::{HashSet, VecDeque};

use colltrans::{ConvexPolyhedron, Solid};
use glam::DVec3;

use crate::random::Random;

type Cell = [i32; 3];

/// Pieces of unit cubes, given by their lowest corners.
#[derive(Debug, Clone)]
pub struct Cubes {
    /// The cells of each piece.
    pub pieces: Vec<Vec<Cell>>,
}

/// A group of pieces that leaves the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Freedom {
    /// The number of moves, including the last one.
    pub moves: usize,
    /// The pieces as a bit set.
    pub group: u32,
}

impl Cubes {
    /// Draws a block with a tunnel along a random walk, and one or two bars of one or two cubes in it. The
    /// block is the last piece.
    pub fn random(random: &mut Random) -> Self {
        let size = [5, 5, 4];
        let step = |cell: Cell, random: &mut Random| {
            let mut to = cell;
            to[random.index(3)] += if random.unit() < 0.5 { 1 } else { -1 };
            to
        };
        let mut walk: Vec<Cell> = vec![[2, 2, 1 + random.index(2) as i32]];
        let length = 4 + random.index(14);
        while walk.len() < length {
            let to = step(*walk.last().unwrap_or(&[2; 3]), random);
            if (0..3).any(|k| to[k] < 0 || to[k] >= size[k]) {
                break;
            }
            walk.push(to);
        }
        let mut free: Vec<Cell> = walk.clone();
        free.sort_unstable();
        free.dedup();
        let mut pieces = Vec::new();
        for _ in 0..=random.index(2) {
            if free.is_empty() {
                break;
            }
            let first = free.swap_remove(random.index(free.len()));
            let mut bar = vec![first];
            let beside = step(first, random);
            if let Some(k) = free.iter().position(|cell| *cell == beside) {
                bar.push(free.swap_remove(k));
            }
            pieces.push(bar);
        }
        let mut block = Vec::new();
        for x in 0..size[0] {
            for y in 0..size[1] {
                block.extend((0..size[2]).map(|z| [x, y, z]));
            }
        }
        block.retain(|cell| !walk.contains(cell));
        pieces.push(block);
        Self { pieces }
    }

    /// Returns each piece as a solid.
    ///
    /// # Panics
    /// Never, because pieces of cubes are valid solids.
    pub fn solids(&self) -> Vec<Solid> {
        let cube = |cell: &Cell| {
            let low = DVec3::from(cell.map(f64::from));
            ConvexPolyhedron::cuboid(low, low + 1.0).expect("a cube")
        };
        let piece = |cells: &Vec<Cell>| {
            let cubes: Vec<ConvexPolyhedron> = cells.iter().map(cube).collect();
            Solid::from_pieces(&cubes).expect("closed pieces")
        };
        self.pieces.iter().map(piece).collect()
    }

    /// Checks whether two pieces, the first one displaced, overlap by more than a length.
    pub fn enter(&self, [a, b]: [usize; 2], by: DVec3, depth: f64) -> bool {
        self.pieces[a].iter().any(|p| {
            let p = DVec3::from(p.map(f64::from)) + by;
            let enters =
                |q: &Cell| (DVec3::from(q.map(f64::from)) - p).abs().max_element() < 1.0 - depth;
            self.pieces[b].iter().any(enters)
        })
    }

    /// Returns the smallest number of moves after which some pieces have left the others; `None` if that is
    /// impossible.
    pub fn level(&self) -> Option<Freedom> {
        let all: Vec<usize> = (0..self.pieces.len()).collect();
        self.level_among(&all, usize::MAX)
    }

    /// Checks whether the pieces can be separated completely, piece by piece and group by group.
    pub fn can_separate(&self) -> bool {
        let mut groups = vec![(0..self.pieces.len()).collect::<Vec<_>>()];
        while let Some(group) = groups.pop() {
            if group.len() < 2 {
                continue;
            }
            // Any move that is possible with the removed group is possible without it.
            let Some(Freedom { group: gone, .. }) = self.level_among(&group, usize::MAX) else {
                return false;
            };
            let (out, rest) = group.iter().partition(|&&k| gone >> k & 1 == 1);
            groups.extend([out, rest]);
        }
        true
    }

    /// Returns the smallest number of moves, at most `most`, after which some of the pieces `among` have left
    /// the others; `None` if that is impossible.
    pub fn level_among(&self, among: &[usize], most: usize) -> Option<Freedom> {
        let count = among.len();
        if count < 2 {
            return None;
        }
        let far = self.extent();
        let start = vec![[0; 3]; count];
        let (mut seen, mut queue) = (HashSet::from([start.clone()]), VecDeque::from([(start, 0)]));
        while let Some((at, moves)) = queue.pop_front() {
            if moves == most {
                continue;
            }
            // The last piece stays.
            for group in 1..(1_u32 << (count - 1)) {
                for (axis, sign) in (0..3).flat_map(|axis| [(axis, 1), (axis, -1)]) {
                    let mut to = at.clone();
                    for steps in 1.. {
                        for (k, place) in to.iter_mut().enumerate() {
                            place[axis] += if group >> k & 1 == 1 { sign } else { 0 };
                        }
                        if self.hits(among, &to, group) {
                            break;
                        }
                        if steps > 2 * far {
                            let own = (0..count).filter(|k| group >> k & 1 == 1);
                            let group = own.map(|k| 1 << among[k]).sum();
                            return Some(Freedom { moves: moves + 1, group });
                        }
                        if seen.insert(to.clone()) {
                            queue.push_back((to.clone(), moves + 1));
                        }
                    }
                }
            }
        }
        None
    }

    /// Returns the extent of all pieces.
    fn extent(&self) -> i32 {
        let all = || self.pieces.iter().flatten().flatten();
        all().max().unwrap_or(&0) - all().min().unwrap_or(&0) + 1
    }

    /// Checks whether a piece of the group has a common cell with a piece outside of it.
    fn hits(&self, among: &[usize], at: &[Cell], group: u32) -> bool {
        let cells = |inside: bool| {
            let own = (0..among.len()).filter(move |k| (group >> k & 1 == 1) == inside);
            own.flat_map(move |k| {
                let cells = &self.pieces[among[k]];
                cells.iter().map(move |c| [0, 1, 2].map(|axis| c[axis] + at[k][axis]))
            })
        };
        let outside: HashSet<Cell> = cells(false).collect();
        cells(true).any(|cell| outside.contains(&cell))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells_in_bar(from: Cell, to: Cell) -> Vec<Cell> {
        let mut cells = Vec::new();
        for x in from[0]..to[0] {
            for y in from[1]..to[1] {
                cells.extend((from[2]..to[2]).map(|z| [x, y, z]));
            }
        }
        cells
    }

    #[test]
    fn closed_forms() {
        let beside = Cubes {
            pieces: vec![cells_in_bar([0, 0, 0], [1, 1, 1]), cells_in_bar([1, 0, 0], [2, 1, 1])],
        };
        assert_eq!(beside.level(), Some(Freedom { moves: 1, group: 1 }));
        // A key in a slot moves along it, then up.
        let mut slot = cells_in_bar([0, 0, 0], [7, 3, 3]);
        let hollow = |c: &Cell| {
            let inside = (1..6).contains(&c[0]) && c[1] == 1;
            inside && (c[2] == 1 || (c[2] == 2 && c[0] >= 4))
        };
        slot.retain(|c| !hollow(c));
        let key = Cubes { pieces: vec![cells_in_bar([1, 1, 1], [3, 2, 2]), slot.clone()] };
        assert_eq!(key.level(), Some(Freedom { moves: 2, group: 1 }));
        assert!(key.can_separate());
        // The key is longer than the opening.
        let stuck = Cubes { pieces: vec![cells_in_bar([1, 1, 1], [4, 2, 2]), slot] };
        assert_eq!(stuck.level(), None);
        assert!(!stuck.can_separate());
    }
}
