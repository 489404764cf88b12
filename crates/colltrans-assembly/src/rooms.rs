//! How far one part, or a rigid group, can move in one direction against all others, and what stops
//! it.
//!
//! The others come in the order in which their boxes are met, from a tree; the best so far is handed
//! on, and ends the walk once the next box lies beyond it.
//!
//! Where overlaps are ignored, parts that overlap are the costly ones: all of what crosses now has to
//! be passed over. So facets that stopped the part at once along another direction are asked first
//! (`Witnesses`), and once something stops it within `Bodies::noise`, no more of those that it
//! overlaps are asked: which of them stops it "at once" is a matter of the files' last digits.

use colltrans::solid::{StartOverlap, Workspace};
use glam::DVec3;
use rayon::prelude::*;

use crate::bodies::{Bodies, Room, Stop};
use crate::error::AssemblyError;
use crate::watch::{Stage, Watch};
use crate::witness::Witnesses;

/// The room (free travel) of a part, or of a group, in one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PartRoom {
    /// Nothing is in the way.
    Free,
    /// Something is.
    Blocked {
        /// Which part of the group is stopped.
        part: usize,
        /// By which part.
        by: usize,
        /// How far, and where.
        stop: Stop,
    },
    /// It overlaps something where it is.
    Overlapping {
        /// Which part of the group.
        part: usize,
        /// With which part.
        by: usize,
    },
}

impl PartRoom {
    /// A word: free, blocked or overlapping.
    pub const fn outcome(&self) -> &'static str {
        match self {
            Self::Free => "free",
            Self::Blocked { .. } => "blocked",
            Self::Overlapping { .. } => "overlapping",
        }
    }

    /// How far it is safe to move: infinite if free, 0 if overlapping.
    pub const fn distance(&self) -> f64 {
        match self {
            Self::Free => f64::INFINITY,
            Self::Blocked { stop, .. } => stop.distance(),
            Self::Overlapping { .. } => 0.0,
        }
    }

    /// How far the bodies go that were shrunk, or are to be kept apart: what decides who comes first.
    pub const fn displaced_distance(&self) -> f64 {
        match self {
            Self::Blocked { stop, .. } => stop.displaced.value,
            _ => self.distance(),
        }
    }

    /// Whether nothing is in the way.
    pub const fn is_free(&self) -> bool {
        matches!(self, Self::Free)
    }

    /// The part that is in the way.
    pub const fn by(&self) -> Option<usize> {
        match self {
            Self::Free => None,
            Self::Blocked { by, .. } | Self::Overlapping { by, .. } => Some(*by),
        }
    }
}

/// The room of a group of parts that move as one, against `others` (all that are `true`).
///
/// Of several stops at one distance the first part of the group, and the lowest number of the
/// others, is named. With [`StartOverlap::Ignore`], of those parts that a part overlaps and that stop
/// it within four times [`Fit::negligible`](crate::Fit), one is named, with its distance.
pub fn room_of(
    bodies: &Bodies,
    group: &[usize],
    others: &[bool],
    d: DVec3,
    start: StartOverlap,
    workspace: &mut Workspace,
) -> PartRoom {
    room_with(bodies, group, others, d, start, workspace, &mut Witnesses::default())
}

fn room_with(
    bodies: &Bodies,
    group: &[usize],
    others: &[bool],
    d: DVec3,
    start: StartOverlap,
    workspace: &mut Workspace,
    witnesses: &mut Witnesses,
) -> PartRoom {
    let mut best = PartRoom::Free;
    for &part in group {
        let ahead = bodies.ahead(part, d);
        if start == StartOverlap::Ignore && best.displaced_distance() > bodies.noise() {
            // What is farther away cannot overlap.
            let near = ahead.iter().take_while(|x| x.0 <= bodies.noise()).map(|x| x.1);
            let mut near = near.filter(|&by| others[by] && !group.contains(&by));
            let noise = bodies.noise();
            let known = near.find_map(|by| {
                let stop = witnesses.stop(bodies, [part, by], d, noise, start)?;
                Some(PartRoom::Blocked { part, by, stop })
            });
            best = known.unwrap_or(best);
        }
        for (bound, by) in ahead {
            if bound > best.displaced_distance() {
                break;
            }
            let overlapping = bodies.overlaps(part, by);
            let at_once =
                start == StartOverlap::Ignore && best.displaced_distance() <= bodies.noise();
            if !others[by] || group.contains(&by) || (overlapping && at_once) {
                continue;
            }
            // Of equal distances only those are let through that would be named instead.
            let before = match best {
                PartRoom::Blocked { part: p, by: b, stop } if (part, by) < (p, b) => {
                    Some(stop.displaced.value.next_up())
                }
                PartRoom::Blocked { stop, .. } => Some(stop.displaced.value),
                _ => None,
            };
            match bodies.room([part, by], d, before, start, workspace) {
                Room::Free => (),
                Room::Overlapping => return PartRoom::Overlapping { part, by },
                Room::Blocked(stop) => {
                    if overlapping && stop.displaced.value <= bodies.noise() {
                        witnesses.keep([part, by], &stop);
                    }
                    let nearer = match best {
                        PartRoom::Blocked { part: p, by: b, stop: s } => {
                            (stop.displaced.value, part, by) < (s.displaced.value, p, b)
                        }
                        _ => true,
                    };
                    if nearer {
                        best = PartRoom::Blocked { part, by, stop };
                    }
                }
            }
        }
    }
    best
}

/// Directions that are asked of a part one after another.
const CHUNK: usize = 64;

/// The rooms of every part in every direction (rows: parts), against all others.
///
/// # Errors
/// Cancelled.
pub fn rooms(
    bodies: &Bodies,
    directions: &[DVec3],
    start: StartOverlap,
    watch: Watch,
) -> Result<Vec<Vec<PartRoom>>, AssemblyError> {
    let all = vec![true; bodies.len()];
    let tally = watch.stage(Stage::Rooms, bodies.len() * directions.len().div_ceil(CHUNK));
    let row = |part: usize| -> Result<Vec<PartRoom>, AssemblyError> {
        let blocks: Result<Vec<Vec<PartRoom>>, AssemblyError> = directions
            .par_chunks(CHUNK)
            .map_init(Workspace::default, |workspace, chunk| {
                // They belong to a chunk: so the answer is the same on any number of threads.
                let mut witnesses = Witnesses::default();
                let mut room = |d: &DVec3| {
                    room_with(bodies, &[part], &all, *d, start, workspace, &mut witnesses)
                };
                let rooms = chunk.iter().map(&mut room).collect();
                tally.step().map(|()| rooms)
            })
            .collect();
        Ok(blocks?.concat())
    };
    (0..bodies.len()).into_par_iter().map(row).collect()
}
