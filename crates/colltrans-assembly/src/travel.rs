//! Free travel of a part, or of a group that moves as one body, along a direction against all others.
//!
//! A tree returns the other parts in the order in which their boxes are reached. The best distance so far limits each
//! query and ends the traversal once the next box lies beyond it.
//!
//! If overlaps are ignored, overlapping parts are the expensive ones, because all crossings at the start must be
//! skipped. Therefore facets that stopped the part immediately along another direction are tested first
//! (`Witnesses`). Once a part stops it within `Bodies::noise`, no further overlapping parts are tested. Which of
//! them stops it first then depends only on the last digits of the file.

use colltrans::solid::{StartOverlap, Workspace};
use glam::DVec3;
use rayon::prelude::*;

use crate::bodies::{Bodies, FreeTravel, Stop};
use crate::error::AssemblyError;
use crate::watch::{Stage, Watch};
use crate::witness::Witnesses;

/// The free travel (*room*) of a part or group along a direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PartTravel {
    /// Nothing blocks it.
    Free,
    /// A part blocks it.
    Blocked {
        /// Index of the part of the group that is stopped.
        part: usize,
        /// Index of the part that blocks it.
        by: usize,
        /// The travel and the contact.
        stop: Stop,
    },
    /// It overlaps another part at the start.
    Overlapping {
        /// Index of the part of the group.
        part: usize,
        /// Index of the overlapped part.
        by: usize,
    },
}

impl PartTravel {
    /// Returns `free`, `blocked` or `overlapping`.
    pub const fn outcome_name(&self) -> &'static str {
        match self {
            Self::Free => "free",
            Self::Blocked { .. } => "blocked",
            Self::Overlapping { .. } => "overlapping",
        }
    }

    /// Returns the proven safe travel: infinite if free, 0 if overlapping.
    pub const fn safe_distance(&self) -> f64 {
        match self {
            Self::Free => f64::INFINITY,
            Self::Blocked { stop, .. } => stop.distance(),
            Self::Overlapping { .. } => 0.0,
        }
    }

    /// Returns the travel of the bodies with their tolerance or gap applied. It decides which contact is first.
    pub const fn displaced_distance(&self) -> f64 {
        match self {
            Self::Blocked { stop, .. } => stop.shrunk_translation.value,
            _ => self.safe_distance(),
        }
    }

    /// Checks whether nothing blocks the part.
    pub const fn is_free(&self) -> bool {
        matches!(self, Self::Free)
    }

    /// Returns the part that blocks or overlaps, or `None` if the part is free.
    pub const fn blocker(&self) -> Option<usize> {
        match self {
            Self::Free => None,
            Self::Blocked { by, .. } | Self::Overlapping { by, .. } => Some(*by),
        }
    }
}

/// Computes the free travel of a group that moves as one body along a direction, against the parts in the mask
/// `others`.
///
/// Of several contacts at one distance, the result names the first part of the group and the lowest index of the
/// others. With [`StartOverlap::Ignore`], of several overlapping parts that stop a part within four times
/// the negligible length of [`Fit`](crate::Fit), the result names one, with its distance.
pub fn travel_of_group(
    bodies: &Bodies,
    group: &[usize],
    others: &[bool],
    d: DVec3,
    start: StartOverlap,
    workspace: &mut Workspace,
) -> PartTravel {
    room_using(bodies, group, others, d, start, workspace, &mut Witnesses::default())
}

fn room_using(
    bodies: &Bodies,
    group: &[usize],
    others: &[bool],
    d: DVec3,
    start: StartOverlap,
    workspace: &mut Workspace,
    witnesses: &mut Witnesses,
) -> PartTravel {
    let mut best = PartTravel::Free;
    for &part in group {
        let ahead = bodies.parts_ahead(part, d);
        if start == StartOverlap::Ignore && best.displaced_distance() > bodies.noise() {
            // Parts farther away cannot overlap.
            let near = ahead.iter().take_while(|x| x.0 <= bodies.noise()).map(|x| x.1);
            let mut near = near.filter(|&by| others[by] && !group.contains(&by));
            let noise = bodies.noise();
            let known = near.find_map(|by| {
                let stop = witnesses.find_stop(bodies, [part, by], d, noise, start)?;
                Some(PartTravel::Blocked { part, by, stop })
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
            // Of equal distances, only contacts that the result would name instead are accepted.
            let before = match best {
                PartTravel::Blocked { part: p, by: b, stop } if (part, by) < (p, b) => {
                    Some(stop.shrunk_translation.value.next_up())
                }
                PartTravel::Blocked { stop, .. } => Some(stop.shrunk_translation.value),
                _ => None,
            };
            match bodies.free_travel([part, by], d, before, start, workspace) {
                FreeTravel::Free => (),
                FreeTravel::Overlapping => return PartTravel::Overlapping { part, by },
                FreeTravel::Blocked(stop) => {
                    if overlapping && stop.shrunk_translation.value <= bodies.noise() {
                        witnesses.store([part, by], &stop);
                    }
                    let nearer = match best {
                        PartTravel::Blocked { part: p, by: b, stop: s } => {
                            (stop.shrunk_translation.value, part, by)
                                < (s.shrunk_translation.value, p, b)
                        }
                        _ => true,
                    };
                    if nearer {
                        best = PartTravel::Blocked { part, by, stop };
                    }
                }
            }
        }
    }
    best
}

/// Number of directions that one task processes for a part.
const CHUNK: usize = 64;

/// Computes the free travel of every part (rows) along every direction, against all others.
///
/// # Errors
/// Returns an error if the run is cancelled.
pub fn travels_of_parts(
    bodies: &Bodies,
    directions: &[DVec3],
    start: StartOverlap,
    watch: Watch,
) -> Result<Vec<Vec<PartTravel>>, AssemblyError> {
    let all = vec![true; bodies.len()];
    let tally = watch.start_stage(Stage::Rooms, bodies.len() * directions.len().div_ceil(CHUNK));
    let row = |part: usize| -> Result<Vec<PartTravel>, AssemblyError> {
        let blocks: Result<Vec<Vec<PartTravel>>, AssemblyError> = directions
            .par_chunks(CHUNK)
            .map_init(Workspace::default, |workspace, chunk| {
                // The witnesses belong to a chunk, so that results do not depend on the number of threads.
                let mut witnesses = Witnesses::default();
                let mut room = |d: &DVec3| {
                    room_using(bodies, &[part], &all, *d, start, workspace, &mut witnesses)
                };
                let rooms = chunk.iter().map(&mut room).collect();
                tally.finish_item().map(|()| rooms)
            })
            .collect();
        Ok(blocks?.concat())
    };
    (0..bodies.len()).into_par_iter().map(row).collect()
}
