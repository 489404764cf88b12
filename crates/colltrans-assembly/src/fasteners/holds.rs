//! Parts that fasteners hold.
//!
//! A shank *passes through* a part where sections of the part across the axis surround it: facets that face the axis
//! within [`REACH`] of the radius, over at least [`MIN_COVER`] of the angles. A screw *holds* the parts that its shank
//! passes through if there are at least two and one of them has its thread: a nut, or else the part nearest to the tip
//! whose hole is no wider than the metric size. The head, or the nut, clamps the others. A dowel *locates* the parts
//! that it fits tightly; it stays in the one that contains most of it. Roles other than `thread` between a fastener
//! and a part contradict this, and so do ignored contacts: then the pair is left out.

use std::collections::BTreeMap;

use glam::DVec3;

use super::profile::rows_about;
use super::{Fastener, FastenerKind, Fasteners, millimetres_per_unit};
use crate::bodies::Bodies;
use crate::digits::short_number;
use crate::error::AssemblyError;
use crate::roles::Role;

/// Number of rows along a shank.
const ROWS: usize = 64;
/// Maximum distance of a surrounding facet from the axis, in radii of the shank.
const REACH: f64 = 1.6;
/// Minimum share of the angles at which a part surrounds a shank.
const MIN_COVER: f64 = 0.75;
/// Maximum radius of a hole with a thread or a fit, in radii of the shank or of its metric size.
const TIGHT: f64 = 1.02;

/// A part that a shank passes through.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Passed {
    part: usize,
    /// Range along the axis over which the part surrounds the shank.
    range: [f64; 2],
    is_tight: bool,
}

/// The parts that a screw or a dowel connects.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Hold {
    /// Index of the fastener.
    pub fastener: usize,
    /// Indices of the parts that it passes through, in increasing order.
    pub parts: Vec<usize>,
    /// The part with the thread of a screw, or the part in which a dowel stays.
    pub seat: usize,
    /// Distance by which a screw moves until its thread has left that part; 0 for a dowel.
    pub engaged: f64,
}

impl Hold {
    /// Returns the pairs of which the first part leaves before or together with the second: a screw before the parts
    /// that it holds, and the parts that a dowel locates before the dowel.
    pub fn order_pairs(&self, fasteners: &Fasteners) -> Vec<[usize; 2]> {
        let is_screw = fasteners.get(self.fastener).is_some_and(|f| f.kind == FastenerKind::Screw);
        let pairs = self
            .parts
            .iter()
            .filter(|part| self.parts.len() > 1 && (is_screw || **part != self.seat));
        pairs
            .map(|&part| if is_screw { [self.fastener, part] } else { [part, self.fastener] })
            .collect()
    }
}

/// Finds the parts that each screw and each dowel connects.
///
/// # Errors
/// [`AssemblyError::TooMany`] if too many boxes of parts intersect.
pub(super) fn find_holds(
    bodies: &Bodies,
    fasteners: &Fasteners,
) -> Result<Vec<Hold>, AssemblyError> {
    let connects = |part: usize| {
        fasteners
            .get(part)
            .is_some_and(|f| matches!(f.kind, FastenerKind::Screw | FastenerKind::Dowel))
    };
    if !fasteners.recognised().any(|(part, _)| connects(part)) {
        return Ok(Vec::new());
    }
    let mut passed: BTreeMap<usize, Vec<Passed>> = BTreeMap::new();
    for [a, b] in bodies.neighbouring_pairs(0.0)? {
        for [own, other] in [[a, b], [b, a]] {
            let Some(fastener) = fasteners.get(own).filter(|_| connects(own) && !connects(other))
            else {
                continue;
            };
            if is_connection(bodies, own, other) {
                passed.entry(own).or_default().extend(passed_part(bodies, fastener, other));
            }
        }
    }
    let hold = |(own, passed): (usize, Vec<Passed>)| {
        let fastener = fasteners.get(own)?;
        let is_nut =
            |p: &&Passed| fasteners.get(p.part).is_some_and(|f| f.kind == FastenerKind::Nut);
        let tight = passed.iter().filter(|p| p.is_tight);
        let seat = if fastener.kind == FastenerKind::Screw {
            let lowest = tight.min_by(|a, b| a.range[0].total_cmp(&b.range[0]));
            passed.iter().find(is_nut).or(lowest)?
        } else {
            let length = |p: &Passed| p.range[1] - p.range[0];
            let size = |p: &Passed| bodies.bounds(p.part).side_lengths().element_product();
            tight
                .max_by(|a, b| length(a).total_cmp(&length(b)).then(size(a).total_cmp(&size(b))))?
        };
        let is_screw = fastener.kind == FastenerKind::Screw;
        let mut parts: Vec<usize> =
            passed.iter().filter(|p| is_screw || p.is_tight).map(|p| p.part).collect();
        parts.sort_unstable();
        let engaged = if is_screw { seat.range[1] - fastener.range[0] } else { 0.0 };
        Some(Hold { fastener: own, parts, seat: seat.part, engaged })
    };
    Ok(passed.into_iter().filter_map(hold).collect())
}

/// Checks whether no role and no ignored contact contradicts a connection of two parts.
fn is_connection(bodies: &Bodies, a: usize, b: usize) -> bool {
    let assembly = bodies.assembly();
    let role = assembly.pair_fit(a, b).and_then(|fit| fit.role);
    role.is_none_or(|role| role == Role::Thread) && assembly.ignored_contacts(a, b).is_none()
}

/// Returns where a part surrounds the shank of a fastener; `None` if it does not.
fn passed_part(bodies: &Bodies, fastener: &Fastener, part: usize) -> Option<Passed> {
    let radius = fastener.diameter / 2.0;
    let scale = millimetres_per_unit(bodies.assembly());
    let fit = fastener.metric.map_or(radius, |size| radius.max(size / scale / 2.0));
    let [low, high] = fastener.range;
    let range = [low, high - fastener.head_height];
    let solid = bodies.assembly().parts()[part].solid();
    let rows = rows_about(solid, fastener.axis, range, (ROWS, REACH * radius));
    let around: Vec<usize> = (0..ROWS)
        .filter(|&k| rows[k].hole.cover >= MIN_COVER && rows[k].hole.median > 0.0)
        .collect();
    let (&first, &last) = (around.first()?, around.last()?);
    let step = (range[1] - range[0]) / ROWS as f64;
    let rough = [range[0] + first as f64 * step, range[0] + (last + 1) as f64 * step];
    // The ends of the hole are vertices near these rows.
    let [point, axis] = fastener.axis;
    let mut ends = rough.map(|z| (z, step / 2.0));
    for p in solid.vertices() {
        let z = (*p - point).dot(axis);
        let is_near = (*p - point - axis * z).length() <= REACH * radius;
        for (end, rough) in ends.iter_mut().zip(rough).filter(|_| is_near) {
            if (z - rough).abs() <= end.1 {
                *end = (z, (z - rough).abs());
            }
        }
    }
    let least = around.iter().map(|&k| rows[k].hole.median).fold(f64::INFINITY, f64::min);
    Some(Passed { part, range: ends.map(|end| end.0), is_tight: least <= TIGHT * fit })
}

/// The turns by which a screw or a nut leaves a thread that is not modelled.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Unscrewing {
    /// Distance until the thread has left the hole, in the unit of the files.
    pub length: f64,
    /// Pitch, in the unit of the files: of the model, or the coarse pitch of the metric size.
    pub pitch: f64,
    /// Nominal diameter in millimetres of the metric size whose pitch this is; `None` for the pitch of the model.
    pub standard: Option<f64>,
}

impl Unscrewing {
    /// Returns the turns of a screw or nut that leaves along a direction; `None` if it is no screw or nut, if no other
    /// part that `is_present` has its thread, or if the pitch is unknown.
    pub(crate) fn of_part(
        fasteners: &Fasteners,
        part: usize,
        direction: DVec3,
        is_present: impl Fn(usize) -> bool,
    ) -> Option<Self> {
        let hold = fasteners.holds().iter().find(|hold| {
            [(hold.fastener, hold.seat), (hold.seat, hold.fastener)]
                .iter()
                .any(|&(own, other)| own == part && is_present(other))
        })?;
        let screw = fasteners.get(hold.fastener).filter(|f| f.kind == FastenerKind::Screw)?;
        fasteners.get(part)?;
        // A screw leaves towards its head, a nut towards the tip.
        let sense = if part == hold.fastener { 1.0 } else { -1.0 };
        if sense * direction.dot(screw.axis[1]) < 0.99 || hold.engaged <= 0.0 {
            return None;
        }
        let (pitch, standard) = match screw.pitch {
            Some(pitch) => (pitch.abs(), None),
            None => (screw.standard_pitch?, Some(screw.metric?)),
        };
        Some(Self { length: hold.engaged, pitch, standard })
    }

    /// Returns the number of turns.
    pub fn turns(&self) -> f64 {
        self.length / self.pitch
    }

    /// Returns the description with lengths of four digits.
    pub fn words(&self) -> String {
        self.describe(short_number)
    }

    /// Returns a description: `unscrewed by 16, 12.8 turns of 1.25, standard pitch of M8`. `length` formats a length.
    pub fn describe(&self, length: impl Fn(f64) -> String) -> String {
        let why = match self.standard {
            Some(size) => format!("standard pitch of M{size}"),
            None => "pitch of the model".to_owned(),
        };
        let [way, pitch] = [self.length, self.pitch].map(length);
        format!("unscrewed by {way}, {:.1} turns of {pitch}, {why}", self.turns())
    }
}
